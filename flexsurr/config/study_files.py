"""The files that say what a study is, and those that they name, read with errors that name the file."""

from collections.abc import Mapping, Sequence
from pathlib import Path, PurePosixPath
from typing import Any, NoReturn, TypeVar

from pydantic import BaseModel

from flexsurr.config.along_span import with_table
from flexsurr.config.errors import ConfigurationError
from flexsurr.config.own_network import OwnNetwork, check_source, read_source, sha256
from flexsurr.config.reading import Source, build, read_yaml
from flexsurr.config.structure import Structure


def structure_values(path: Path, shown: str) -> dict[str, Any]:
    """What the file at `path` says, called `shown` in errors, and the CSV file that it names.

    Raises ConfigurationError for a file that is missing or cannot be read.
    """
    return with_table(read_yaml(path, shown), path.parent, str(PurePosixPath(shown).parent))


def read_structure(path: str | Path) -> Structure:
    """The structure in the file at `path`. Raises ConfigurationError with a line for each mistake."""
    return build(Structure, [Source(str(path), structure_values(Path(path), str(path)))])


STUDIES = "config/studies"

RecordT = TypeVar("RecordT", bound=BaseModel)


class StudyFiles:
    """The study `name` below the folder `root`: its file, what that is based on, and what is laid on top.

    `settings` are the files of an invocation, whose `overrides` replace values of the study. Raises
    ConfigurationError if there is no such study.
    """

    def __init__(self, root: Path, name: str, settings: Sequence[Source]) -> None:
        self.root, self.name = root, name
        file = f"{STUDIES}/{name}.yaml"
        if not (root / file).is_file():
            where, allowed = holder(settings, ("studies",)), known_studies(root)
            raise ConfigurationError([f"{where}: studies: {name!r} is unknown; allowed: {allowed}"])
        self.sources = self._layers(file)
        for source in settings:
            values = source.values.get("overrides")
            if isinstance(values, Mapping) and isinstance(values.get(name), Mapping):
                self.sources.append(Source(source.file, values[name], ("overrides", name)))
        self.problems: list[str] = []

    def value(self, key: str, default: Any) -> Any:
        """The value of a key of the study, before anything is checked."""
        found = [source.values[key] for source in self.sources if key in source.values]
        return found[-1] if found else default

    def record(self, record: type[RecordT]) -> RecordT:
        """What the study's own files say. Raises ConfigurationError with every problem found."""
        return build(record, self.sources)

    def named(self, record: type[RecordT], path: str, *key: str) -> RecordT:
        """What the file `path` says, which the study names under `key`.

        Problems are kept until `check`: the record is of no use before.
        """
        try:
            if not (self.root / path).is_file():
                self.refuse(f"{path!r} is no file; allowed: a YAML file", *key)
            read = structure_values if record is Structure else read_yaml
            return build(record, [Source(path, read(self.root / path, path))])
        except ConfigurationError as error:
            self.problems += error.problems
            return record.model_construct()

    def hash_of(self, network: OwnNetwork, key: str) -> str:
        """The hash of the file of a network that `key` names; whether its class is there is kept as above."""
        try:
            source = read_source(self.root, network)
            check_source(network, source)
            return sha256(source)
        except ValueError as error:
            self.problems.append(f"{key}: {error}")
            return ""

    def check(self) -> None:
        """Raise ConfigurationError if a file that the study names has a problem."""
        if self.problems:
            raise ConfigurationError(self.problems)

    def refuse(self, problem: str, *key: str) -> NoReturn:
        """Raise ConfigurationError for the value of `key`, in the name of the file that gives it."""
        raise ConfigurationError([f"{holder(self.sources, key)}: {'.'.join(key)}: {problem}"])

    def _layers(self, file: str) -> list[Source]:
        """The file of a study, on top of the one of the study that it is `based_on`, if any."""
        values = dict(read_yaml(self.root / file, file))
        base = values.pop("based_on", None)
        if base is None:
            return [Source(file, values)]
        below = f"{STUDIES}/{base}.yaml"
        if not (self.root / below).is_file() or below == file:
            raise ConfigurationError(
                [f"{file}: based_on: {base!r} is no other study; allowed: {known_studies(self.root)}"]
            )
        under = read_yaml(self.root / below, below)
        if "based_on" in under:
            raise ConfigurationError(
                [f"{file}: based_on: {base!r} is based on another itself; allowed: a study that is not"]
            )
        return [Source(below, under), Source(file, values)]


def holder(sources: Sequence[Source], key: Sequence[str]) -> str:
    """The last file that gives the value of `key`."""
    for source in reversed(sources):
        values: Any = source.values
        for step in key:
            values = values.get(step) if isinstance(values, Mapping) else None
        if values is not None:
            return source.file
    return sources[0].file


def known_studies(root: Path) -> str:
    """The names of the studies that there are, as an error shows them."""
    return ", ".join(sorted(path.stem for path in (root / STUDIES).glob("*.yaml")))
