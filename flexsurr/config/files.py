"""A study of a user's own data: files with trajectories, and which of their columns is what."""

from collections.abc import Iterator
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from flexsurr.config.schema import Record, check_once
from flexsurr.config.study import DEFAULT, Count, Integrator, Learning, Share, SplitBy

FILES = "files"

Word = Annotated[str, Field(min_length=1)]


class StateColumn(Record):
    """A state, and where it stands."""

    column: Word
    """The column's name."""
    unit: Word
    """Its unit, as results show it."""
    derivative: Word | None = None
    """The column of its time derivative, in that unit per second. None: estimated by the filter. For every
    state or for none.
    """
    name: Word | None = None
    """What results call the state. None: as the column."""

    @property
    def called(self) -> str:
        """Its name in results."""
        return self.name or self.column


class ForceColumn(Record):
    """An input: a generalised force."""

    column: Word
    """The column's name."""
    unit: Word
    """Its unit: that of the momentum per second."""


class Pair(Record):
    """A generalised coordinate q and its momentum p."""

    q: StateColumn
    """The generalised coordinate."""
    p: StateColumn
    """Its momentum."""
    force: ForceColumn | None = None
    """The recorded force that acts on the momentum, positive where it adds to ṗ. The surrogate learns ẋ =
    f(x), where ṗ is f and the force together.
    """


class Columns(Record):
    """Which column of a table, or array of an NPZ archive, is what."""

    t: Word = "t"
    """The time [s]."""
    trajectory: Word | None = None
    """Says which trajectory a row is of. None: each file is one."""
    pairs: tuple[Pair, ...] = ()
    """The states as coordinates and their momenta, which every architecture takes."""
    states: tuple[StateColumn, ...] = ()
    """Or any states, which only an mlp takes. One of the two is given."""

    @model_validator(mode="after")
    def _one_kind_of_states(self) -> Self:
        if bool(self.pairs) == bool(self.states):
            raise ValueError(
                f"pairs, states: {len(self.pairs)} and {len(self.states)} are not allowed; allowed: pairs of "
                "q and p, or else states"
            )
        return self

    @model_validator(mode="after")
    def _each_name_once(self) -> Self:
        for what, names in (("columns", list(self.named)), ("names of states", list(self.state_names))):
            check_once(names, f"{what}: ")
        return self

    @model_validator(mode="after")
    def _all_derivatives_or_none(self) -> Self:
        missing = [state.called for state in self.ordered if state.derivative is None]
        if self.have_derivatives and missing:
            raise ValueError(
                f"derivative: missing for {', '.join(missing)}; allowed: for every state, or for none"
            )
        return self

    @property
    def ordered(self) -> tuple[StateColumn, ...]:
        """The states in the order of every dataset: all q, then all p."""
        return self.states or (*(pair.q for pair in self.pairs), *(pair.p for pair in self.pairs))

    @property
    def state_names(self) -> tuple[str, ...]:
        """What results call the states."""
        return tuple(state.called for state in self.ordered)

    @property
    def state_units(self) -> tuple[str, ...]:
        """Units of the states."""
        return tuple(state.unit for state in self.ordered)

    @property
    def have_derivatives(self) -> bool:
        """Whether the files hold the derivatives of the states."""
        return any(state.derivative is not None for state in self.ordered)

    @property
    def have_forces(self) -> bool:
        """Whether a force acts on any of the momenta."""
        return any(pair.force is not None for pair in self.pairs)

    @property
    def input_names(self) -> tuple[str, ...]:
        """What datasets call the forces: one for each pair, if there is any."""
        return tuple(f"force_on_{pair.p.called}" for pair in self.pairs) if self.have_forces else ()

    @property
    def input_units(self) -> tuple[str, ...]:
        """Units of the forces; those of pairs that none acts on follow from the momentum's."""
        units = (pair.force.unit if pair.force else f"({pair.p.unit})/s" for pair in self.pairs)
        return tuple(units) if self.have_forces else ()

    @property
    def named(self) -> Iterator[str]:
        """Every column that must be there."""
        yield self.t
        if self.trajectory is not None:
            yield self.trajectory
        for state in self.ordered:
            yield state.column
            if state.derivative is not None:
                yield state.derivative
        yield from (pair.force.column for pair in self.pairs if pair.force is not None)


class Filter(Record):
    """The Savitzky–Golay filter: polynomials through the nearest samples of a trajectory."""

    kind: Literal["savitzky_golay"] = "savitzky_golay"
    """Savitzky and Golay's."""
    window: Annotated[int, Field(ge=3)] = 15
    """Samples that a polynomial goes through: odd, more than `order`."""
    order: Annotated[int, Field(ge=1)] = 3
    """Degree of the polynomials."""
    smooth_states: bool = True
    """Whether the polynomials' values replace the states; their slopes are the derivatives that the files
    lack either way.
    """

    @model_validator(mode="after")
    def _the_window_determines_the_polynomial(self) -> Self:
        if self.window % 2 == 0 or self.window <= self.order:
            raise ValueError(f"window: {self.window} is not allowed; allowed: odd, more than order")
        return self


class Rollouts(Record):
    """Surrogates that start where a held-out trajectory starts, and follow it to its end."""

    trajectories: Count = 20
    """How many held-out trajectories are followed from their start."""
    drawn: Count = 3
    """How many of them figures show."""
    repeats: Count = 5
    """How often each of them is timed; the median counts."""
    integrator: Integrator = Integrator(method="dop853", rtol=1e-8, atol=1e-10)
    """By which surrogates are stepped."""


class FilesStudy(Learning):
    """A study of trajectories in files of yours: there is no structure and no reference model."""

    source: Literal["files"]
    """Where its data come from: files of yours."""
    files: Annotated[tuple[Word, ...], Field(min_length=1)]
    """Names, or patterns such as data/*.csv, below the folder that holds the Snakefile: CSV, Parquet or NPZ.
    """
    columns: Columns
    """What is what in them."""
    filter: Filter | None = None
    """By which the data are smoothed. None: they are taken as they are, except that derivatives which the
    files lack are estimated by its defaults.
    """
    split_by: SplitBy = "trajectory"
    """What is held out of training: whole trajectories, or single samples of every trajectory."""
    training_fraction: Share = 0.8
    """Share that trains; the rest validates."""
    rollouts: Rollouts = Rollouts()
    """How surrogates are scored."""

    @property
    def variants(self) -> tuple[str, ...]:
        """What stands where other studies have the variants of their reference model: one, the files."""
        return (FILES,)

    def dataset_of(self, sweep: str) -> str:
        """The name of the dataset that a sweep trains on: there is one."""
        return DEFAULT

    @property
    def filter_in_use(self) -> Filter | None:
        """The filter that the data go through, if any."""
        return self.filter or (None if self.columns.have_derivatives else Filter())
