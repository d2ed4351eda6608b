"""The reference of every key that a configuration may hold, as Markdown, made from the records that check it.

What a key means is the docstring below its field; everything else follows from the field itself.
"""

import ast
import inspect
import re
import textwrap
from collections.abc import Iterator
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, NamedTuple, Union, get_args, get_origin

from annotated_types import Ge, Gt, Le, Lt, MaxLen, MinLen
from pydantic import BaseModel
from pydantic.fields import FieldInfo

from flexsurr.config.aerodynamics import FeatureLimits
from flexsurr.config.aircraft import Aircraft
from flexsurr.config.files import FilesStudy
from flexsurr.config.modes_study import ModesStudy
from flexsurr.config.sample_study import SampleStudy
from flexsurr.config.schema import Record
from flexsurr.config.settings import Settings
from flexsurr.config.structure import Structure
from flexsurr.config.study import Study
from flexsurr.config.sweep import OptionRange, Range, Sweep
from flexsurr.config.trial import FIELDS, MAPS, OPTIMISERS, Architecture

INTRODUCTION = """\
# Every key

Made by `make reference` from the records in `flexsurr/config` that check a configuration: edit those.

Units are in the names of the keys and in brackets: [N m²]. Of a structure x points along the undeformed span,
y to the left, z up; of an aircraft x aft from the nose, y to the right, z up. A key without a default must be
given; *none* is an empty value, or `null`. Numbers are finite, and a key that is not listed is an error.
Paths are relative to the folder that holds the Snakefile. `flexsurr check` says before anything runs whether
a configuration is right.
"""


class Page(NamedTuple):
    """A kind of file: which they are, what to know of them, and the records that they may hold."""

    files: str
    text: str
    records: tuple[type[Record], ...]


PAGES = (
    Page(
        "config/config.yaml",
        "The file to edit first. A file of the same shape is laid on top by `--configfile`, such as those in "
        "`config/presets`: a mapping is merged key by key, a list or a value is replaced.",
        (Settings,),
    ),
    Page(
        "config/studies/*.yaml",
        "Which keys there are depends on `source`; without it the data are simulated trajectories. A study "
        "that differs from another in a few values gives these alone, and the other's name as `based_on`.",
        (Study, SampleStudy, FilesStudy, ModesStudy),
    ),
    Page("config/structures/*.yaml", "", (Structure,)),
    Page(
        "config/sweeps/*.yaml",
        "A space joins the keys of an architecture with those of an optimiser, each with a list of values: "
        "`hidden: [[16], [32]]`, `activation: [half_log]`. Every combination is a trial; see "
        "[sweeps](sweeps.md).",
        (Sweep, Range, OptionRange, *FIELDS, *MAPS, *OPTIMISERS),
    ),
    Page("config/aircraft/*.yaml", "", (Aircraft,)),
    Page(
        "config/aircraft/*_limits.yaml",
        "The intervals that the samples of an aircraft's aerodynamics are drawn from.",
        (FeatureLimits,),
    ),
)


def reference() -> str:
    """The whole document. Raises LookupError for a field without a description."""
    parts = [INTRODUCTION]
    shown: set[type[Record]] = set()
    for page in PAGES:
        parts.append(f"## `{page.files}`\n")
        if page.text:
            parts.append(textwrap.fill(page.text, 110) + "\n")
        for record in page.records:
            for each in with_nested(record):
                if each not in shown:
                    shown.add(each)
                    parts.append(_section(each))
    return "\n".join(parts)


def with_nested(record: type[Record]) -> Iterator[type[Record]]:
    """`record` and every record below it, in the order of their keys; one may come several times."""
    yield record
    for field in record.model_fields.values():
        for nested in _records(field.annotation):
            yield from with_nested(nested)


def descriptions(record: type[Record]) -> dict[str, str]:
    """What each field of `record` means: the docstring below it, here or in the class it comes from."""
    found: dict[str, str] = {}
    for owner in reversed(record.__mro__):
        if not issubclass(owner, Record) or owner is Record:
            continue
        (definition,) = ast.parse(textwrap.dedent(inspect.getsource(owner))).body
        assert isinstance(definition, ast.ClassDef)
        below: dict[str, str] = {}
        name = ""
        for statement in definition.body:
            match statement:
                case ast.AnnAssign(target=ast.Name(id=name)):
                    below[name] = ""
                case ast.Expr(value=ast.Constant(value=str(text))) if name:
                    below[name] = " ".join(text.split())
                case _:
                    name = ""
        found.update(below)
    return {key: found.get(key, "") for key in record.model_fields}


def _section(record: type[Record]) -> str:
    meanings = descriptions(record)
    rows = []
    for key, field in record.model_fields.items():
        if not meanings[key]:
            raise LookupError(f"{record.__module__}.{record.__name__}: {key} has no docstring below it")
        allowed = _allowed(field.annotation, field.metadata)
        rows.append(f"| `{key}` | {meanings[key]} | {_default(field)} | {allowed} |")
    lines = [f"### {_title(record)}\n", inspect.cleandoc(record.__doc__ or "").split("\n\n")[0] + "\n"]
    if issubclass(record, Architecture):
        lines.append(f"Trained by {_words(record.optimisers)}.\n")
    return "\n".join([*lines, "| key | meaning | default | allowed |", "|---|---|---|---|", *rows, ""])


def _title(record: type[Record]) -> str:
    return re.sub(r"(?<=[a-z])(?=[A-Z][a-z])", " ", record.__name__).capitalize()


def _link(record: type[Record]) -> str:
    title = _title(record)
    return f"[{title}](#{title.lower().replace(' ', '-')})"


def _words(values: tuple[Any, ...]) -> str:
    return ", ".join(f"`{str(value).lower() if isinstance(value, bool) else value}`" for value in values)


def _default(field: FieldInfo) -> str:
    if field.is_required():
        return ""
    value = field.get_default(call_default_factory=True)
    if isinstance(value, Record) and not _given(value):
        return "its defaults"
    return "none" if value in (None, "", (), {}) else f"`{_written(value)}`"


def _given(record: BaseModel) -> dict[str, Any]:
    """The values of `record` that are not defaults."""
    values = {key: getattr(record, key) for key in record.model_fields_set}
    fields = type(record).model_fields
    return {key: values[key] for key in fields if key in values and values[key] != fields[key].default}


def _written(value: Any) -> str:
    """A value as a person writes it in YAML."""
    match value:
        case BaseModel():
            kind = {"kind": value.kind} if hasattr(value, "kind") else {}
            return _written(kind | _given(value))
        case dict():
            return "{" + ", ".join(f"{key}: {_written(each)}" for key, each in value.items()) + "}"
        case tuple():
            return "[" + ", ".join(map(_written, value)) + "]"
        case bool():
            return str(value).lower()
        case float() if "e" in str(value):  # YAML takes 1e-07 for a word
            mantissa, exponent = str(value).split("e")
            return f"{float(mantissa)}e{int(exponent):+d}"
    return str(value)


def _allowed(annotation: Any, metadata: Any = ()) -> str:
    """What may stand for a type, in a few words."""
    origin, inside = get_origin(annotation), get_args(annotation)
    if origin is Annotated:
        return _allowed(inside[0], [*inside[1:], *metadata])
    if origin in (Union, UnionType):
        several = " or ".join(_allowed(each, metadata) for each in inside if each is not NoneType)
        return several + (", or none" if NoneType in inside else "")
    if origin is Literal:
        return _words(inside)
    if origin is tuple:
        return _several(inside, metadata)
    if origin is dict:
        return f"names, each with {_allowed(inside[1])}"
    if isinstance(annotation, type) and issubclass(annotation, Record):
        return _link(annotation)
    words = {bool: "`true`, `false`", str: "text", int: "whole number", float: "number", Any: "any value"}
    return ", ".join([words[annotation], *_limits(metadata)])


def _several(inside: tuple[Any, ...], metadata: Any) -> str:
    """What may stand in a list."""
    if inside[-1] is not Ellipsis:
        same = len(set(map(str, inside))) == 1
        return f"list of {len(inside)}: {_allowed(inside[0]) if same else '; '.join(map(_allowed, inside))}"
    limits = list(_flat(metadata))
    least = next((each.min_length for each in limits if isinstance(each, MinLen)), 0)
    most = next((each.max_length for each in limits if isinstance(each, MaxLen)), None)
    count = "" if not least else f" of {least} or more"
    if most is not None:
        count = f" of {most}" if most == least else f" of {least} to {most}"
    return f"list{count}: {_allowed(inside[0])}"


def _flat(metadata: Any) -> Iterator[Any]:
    """`metadata` with that of the fields in it, which stand for limits inside an annotation."""
    for each in metadata:
        if isinstance(each, FieldInfo):
            yield from each.metadata
        else:
            yield each


def _limits(metadata: Any) -> Iterator[str]:
    for each in _flat(metadata):
        match each:
            case Gt(gt=limit):
                yield f"more than {limit:g}"
            case Ge(ge=limit):
                yield f"{limit:g} or more"
            case Lt(lt=limit):
                yield f"less than {limit:g}"
            case Le(le=limit):
                yield f"{limit:g} or less"
            case MinLen(min_length=1):
                yield "not empty"


def _records(annotation: Any) -> list[type[Record]]:
    """The records that a type mentions."""
    if isinstance(annotation, type) and issubclass(annotation, Record):
        return [annotation]
    return [found for part in get_args(annotation) for found in _records(part)]
