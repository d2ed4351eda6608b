"""Changes of a configuration's files."""

from pathlib import Path

import yaml


def change(root: Path, file: str, keys: str, value: object) -> None:
    """Set the value at dotted `keys` of a YAML file; numbers are places in lists."""
    content = yaml.safe_load((root / file).read_text())
    inner = content
    *path, last = [int(key) if key.isdigit() else key for key in keys.split(".")]
    for key in path:
        inner = inner.setdefault(key, {}) if isinstance(inner, dict) else inner[key]
    inner[last] = value
    (root / file).write_text(yaml.safe_dump(content))
