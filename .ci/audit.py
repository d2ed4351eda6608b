"""Hold pinned packages against a file of known advisories; nothing is fetched.

The file is a zip archive, or a folder, of advisories in the OSV format, one JSON document each. OSV's own
export of those of PyPI, all.zip, is one.
"""

import argparse
import json
import re
import sys
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from packaging.utils import canonicalize_name
from packaging.version import InvalidVersion, Version


def main() -> int:
    """The exit code: 0 where nothing is known, 1 where something is, or where nothing could be looked up."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--advisories", type=Path, required=True, metavar="PATH", help="the archive or folder"
    )
    parser.add_argument("requirements", type=Path, help="name==version, a line each")
    given = parser.parse_args()
    if not given.advisories.exists():
        print(
            f"{given.advisories}: no such file, so nothing was audited. Give the advisories of PyPI in the "
            "OSV format: make audit ADVISORIES=<all.zip>",
            file=sys.stderr,
        )
        return 1
    packages = pinned(given.requirements.read_text(encoding="utf-8"))
    try:
        found = [line for advisory in advisories(given.advisories) for line in matches(advisory, packages)]
    except (zipfile.BadZipFile, ValueError) as error:
        print(f"{given.advisories}: no advisories in the OSV format ({error})", file=sys.stderr)
        return 1
    print(*sorted(found), sep="\n", end="\n" if found else "")
    print(f"{len(packages)} packages, {len(found)} known advisories", file=sys.stderr)
    return 1 if found else 0


def pinned(text: str) -> dict[str, Version]:
    """Versions by name, from lines name==version."""
    found = re.findall(r"^([\w.-]+)==([^\s;#]+)", text, re.MULTILINE)
    return {canonicalize_name(name): Version(version) for name, version in found}


def advisories(path: Path) -> Iterator[dict[str, Any]]:
    """Every advisory below `path`. Raises BadZipFile or ValueError for what is none."""
    if path.is_dir():
        for file in sorted(path.rglob("*.json")):
            yield json.loads(file.read_bytes())
        return
    with zipfile.ZipFile(path) as archive:
        for name in archive.namelist():
            if name.endswith(".json"):
                yield json.loads(archive.read(name))


def matches(advisory: dict[str, Any], packages: dict[str, Version]) -> Iterator[str]:
    """A line for each of `packages` that `advisory` concerns."""
    if "withdrawn" in advisory:
        return
    for entry in advisory.get("affected", ()):
        package = entry.get("package", {})
        name = canonicalize_name(package.get("name", ""))
        version = packages.get(name)
        if package.get("ecosystem") == "PyPI" and version is not None and affected(version, entry):
            names = " ".join([advisory["id"], *advisory.get("aliases", ())])
            yield f"{name} {version}: {names}: {advisory.get('summary', 'no summary')}"


def affected(version: Version, entry: dict[str, Any]) -> bool:
    """Whether `version` is among those that an advisory lists, or within one of its ranges."""
    if any(_version(listed) == version for listed in entry.get("versions", ())):
        return True
    ranges = (each for each in entry.get("ranges", ()) if each["type"] == "ECOSYSTEM")
    return any(_within(version, each["events"]) for each in ranges)


def _within(version: Version, events: list[dict[str, str]]) -> bool:
    inside = False
    steps = [(_version(text), kind) for event in events for kind, text in event.items()]
    for limit, kind in sorted((limit, kind) for limit, kind in steps if limit is not None):
        match kind:
            case "introduced" if version >= limit:
                inside = True
            case "fixed" if version >= limit:
                inside = False
            case "last_affected" if version > limit:
                inside = False
    return inside


def _version(text: str) -> Version | None:
    try:
        return Version(text)
    except InvalidVersion:
        return None


if __name__ == "__main__":
    sys.exit(main())
