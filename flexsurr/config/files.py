"""A study of a user's own data: files with trajectories, and which of their columns is what."""

from collections.abc import Iterator
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from flexsurr.config.schema import Record
from flexsurr.config.study import DEFAULT, Count, Integrator, Learning, Share, SplitBy

FILES = "files"

Word = Annotated[str, Field(min_length=1)]


class StateColumn(Record):
    """A state: its `column`, its `unit`, and the column of its time `derivative` [unit/s] if there is one.

    `name` is what results call it; the column's name where none is given.
    """

    column: Word
    unit: Word
    derivative: Word | None = None
    name: Word | None = None

    @property
    def called(self) -> str:
        """Its name in results."""
        return self.name or self.column


class ForceColumn(Record):
    """An input: a generalised force, in the unit of the momentum that it acts on per second."""

    column: Word
    unit: Word


class Pair(Record):
    """A generalised coordinate q and its momentum p, and the recorded `force` that acts on p, if any.

    The surrogate learns ẋ = f(x), where ṗ is f and the force together.
    """

    q: StateColumn
    p: StateColumn
    force: ForceColumn | None = None


class Columns(Record):
    """Which column of a table, or array of an NPZ archive, is what.

    `t` is the time [s]. `trajectory` says which trajectory a row is of; without it each file is one.
    The states are `pairs` (q, p), which every architecture takes, or any `states`, which an MLP takes.
    """

    t: Word = "t"
    trajectory: Word | None = None
    pairs: tuple[Pair, ...] = ()
    states: tuple[StateColumn, ...] = ()

    @model_validator(mode="after")
    def _one_kind_of_states(self) -> Self:
        if bool(self.pairs) == bool(self.states):
            raise ValueError("the states are given by pairs of q and p, or else by states")
        return self

    @model_validator(mode="after")
    def _each_name_once(self) -> Self:
        for what, names in (("columns", list(self.named)), ("names of states", list(self.state_names))):
            twice = sorted({name for name in names if names.count(name) > 1})
            if twice:
                raise ValueError(f"{what}: {', '.join(twice)} more than once")
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
    """The Savitzky–Golay filter: polynomials of `order` through the nearest `window` samples of a trajectory.

    Their slopes are the derivatives that the files lack. With `smooth_states` their values are the states.
    """

    kind: Literal["savitzky_golay"] = "savitzky_golay"
    window: Annotated[int, Field(ge=3)] = 15
    order: Annotated[int, Field(ge=1)] = 3
    smooth_states: bool = True

    @model_validator(mode="after")
    def _the_window_determines_the_polynomial(self) -> Self:
        if self.window % 2 == 0 or self.window <= self.order:
            raise ValueError(f"window: {self.window} is not allowed; allowed: odd, more than order")
        return self


class Rollouts(Record):
    """Surrogates that start where a held-out trajectory starts, and follow it to its end.

    They are judged by the first `trajectories` of them; figures show the first `drawn`, and each is timed
    `repeats` times. `integrator` steps them.
    """

    trajectories: Count = 20
    drawn: Count = 3
    repeats: Count = 5
    integrator: Integrator = Integrator(method="dop853", rtol=1e-8, atol=1e-10)


class FilesStudy(Learning):
    """A study of trajectories in `files`: names or patterns, below the folder that holds the Snakefile.

    There is no structure and no reference model. Without a `filter` the data are taken as they are, except
    that derivatives which the files lack are estimated by its defaults. Whole trajectories are held out of
    training, or single samples of every trajectory (`split_by`).
    """

    source: Literal["files"]
    files: Annotated[tuple[Word, ...], Field(min_length=1)]
    columns: Columns
    filter: Filter | None = None
    split_by: SplitBy = "trajectory"
    training_fraction: Share = 0.8
    rollouts: Rollouts = Rollouts()

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
