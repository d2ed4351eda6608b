"""Reading a YAML file of keys and values, with errors that name the file and the line."""

import re
from pathlib import Path
from typing import Any

import yaml

from flexsurr.config.errors import ConfigurationError


class _Strict(yaml.SafeLoader):
    """YAML's safe loader, except that what it would read otherwise than it looks is an error.

    That is a key given twice, of which the last would hold, and a number with a leading zero or a colon,
    which would be of base 8 or 60.
    """

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
        """The mapping of `node`; raises ConstructorError for a key that comes twice."""
        seen = set()
        for key_node, _ in node.value:
            if not isinstance(key_node, yaml.ScalarNode):
                continue
            key = (key_node.tag, key_node.value)
            if key in seen:
                raise yaml.constructor.ConstructorError(
                    problem=f"key {key_node.value!r} is given twice", problem_mark=key_node.start_mark
                )
            seen.add(key)
        return super().construct_mapping(node, deep)


def _decimal(loader: _Strict, node: yaml.ScalarNode) -> int | float:
    whole = node.value.partition(".")[0]
    if ":" in whole or re.match(r"[-+]?0[0-9_]", whole):
        raise yaml.constructor.ConstructorError(
            problem=f"{node.value} is no decimal number", problem_mark=node.start_mark
        )
    kind = node.tag.rpartition(":")[2]
    number: int | float = getattr(loader, f"construct_yaml_{kind}")(node)
    return number


for kind in ("int", "float"):
    _Strict.add_constructor(f"tag:yaml.org,2002:{kind}", _decimal)


def read_yaml(path: Path, shown: str | None = None) -> dict[str, Any]:
    """The keys and values of the YAML file at `path`, named `shown` in errors.

    Raises ConfigurationError if the file is missing, is not YAML, or holds something else than keys
    with values.
    """
    name = shown or str(path)
    try:
        text = path.read_text(encoding="utf-8")
    except FileNotFoundError:
        raise ConfigurationError([f"{name}: no such file (looked for {path.absolute()})"]) from None
    except IsADirectoryError:
        raise ConfigurationError([f"{name}: is a folder; a YAML file is needed"]) from None
    except UnicodeDecodeError as error:
        raise ConfigurationError([f"{name}: is not text in UTF-8 (byte {error.start})"]) from None
    try:
        # The loader is SafeLoader with one more check.
        content = yaml.load(text, Loader=_Strict)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark
        line = f", line {mark.line + 1}, column {mark.column + 1}" if mark else ""
        what = " ".join(part for part in (error.context, error.problem) if part)
        raise ConfigurationError([f"{name}{line}: is not YAML: {what}"]) from None
    except (yaml.YAMLError, ValueError) as error:
        raise ConfigurationError([f"{name}: is not YAML: {' '.join(str(error).split())}"]) from None
    if not isinstance(content, dict) or not all(isinstance(key, str) for key in content):
        raise ConfigurationError([f"{name}: holds {content!r:.60}; allowed: keys with values"])
    return content
