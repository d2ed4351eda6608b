"""The simulations that time and measure models: initial states, loads, and their tight solutions."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np

from flexsurr.beam import (
    BeamModel,
    Implementation,
    Load,
    ModalBasis,
    draw_initial_conditions,
    find_equilibrium,
    loaded,
    reduced_order,
)
from flexsurr.beam.loads import load_ends_s
from flexsurr.config.study import EvaluationSettings, Integrator, Study, Variant
from flexsurr.simulation import simulate
from flexsurr.simulation.rhs import Array, Model

Response = Literal["free", "forced", "sustained"]
"""Free; from rest under the study's load until a random time; the same as long as the load may act."""

# A trajectory is drawn from its number. Training uses the numbers from 0; these lie out of reach, and
# apart, so that a model is not scored by the responses that selected it.
FIRST_SELECTION_CASE = 1_000_000
FIRST_EVALUATION_CASE = 2_000_000


_STANDSTILL = 1e-13  # a motion of less, beside the beam's length, is rounding

DRAWN_EVERY_S = 0.002
"""Longest step between samples that draw a smooth curve; the study's is for measuring errors."""


@dataclass(frozen=True)
class Case:
    """One simulation: its number, initial state x0 (2r,), and load (None: free response)."""

    number: int
    x0: Array
    load: Load | None = None

    @property
    def free_from_s(self) -> float:
        """Time [s] from which no load acts."""
        return 0.0 if self.load is None else load_ends_s(self.load)


@dataclass(frozen=True)
class ReferenceSolution:
    """A tight solution: times t (m,), states x (m, 2r), `motion` (m, k) of the tip and its largest size.

    `energy` (m,) [J] is the exact Hamiltonian along it.
    """

    case: Case
    t: Array
    x: Array
    motion: Array
    energy: Array
    peak: float


def tip_motion(model: BeamModel, x: Array) -> Array:
    """What is seen of the tip at states x (m, 2r): its position (m, 3) [m], or its twist (m, 1) [rad].

    The twist stands for it where the model only twists: the tip stays where it is then.
    """
    if model.projection.only_twists:
        return np.unwrap(model.twist(x))[:, None]
    return model.tip(x)


def free_cases(basis: ModalBasis, study: Study, first: int, count: int) -> list[Case]:
    """Free responses from random initial states, numbers `first` to `first + count − 1`."""
    states = draw_initial_conditions(basis, study.dataset.initial_conditions, study.seed, first, count)
    return [Case(number=k, x0=np.array(x0)) for k, x0 in enumerate(states, start=first)]


def forced_cases(basis: ModalBasis, study: Study, first: int, count: int) -> list[Case]:
    """Responses from rest to the study's load, which ends at a random time in (start, longest_load_s]."""
    settings = study.evaluation
    longest_s, start_s = settings.longest_load_s, settings.load.start_s
    at_rest = rest_state(basis)
    cases = []
    for number in range(first, first + count):
        drawn = np.random.default_rng([study.seed, number]).random()
        load = excitation(settings, longest_s - drawn * (longest_s - start_s))
        cases.append(Case(number=number, x0=at_rest, load=load))
    return cases


def evaluation_cases(basis: ModalBasis, study: Study, response: Response) -> list[Case]:
    """The simulations of one response of the study, the same for every model and variant.

    A sustained response is one simulation.
    """
    if response == "sustained":
        load = excitation(study.evaluation, study.evaluation.longest_load_s)
        return [Case(number=FIRST_EVALUATION_CASE, x0=rest_state(basis), load=load)]
    draw = free_cases if response == "free" else forced_cases
    return draw(basis, study, FIRST_EVALUATION_CASE, study.evaluation.simulations)


def excitation(settings: EvaluationSettings, until_s: float) -> Load:
    """The study's load, which ends at `until_s` [s] at the latest."""
    return settings.load.until(until_s)


def rest_state(basis: ModalBasis, load: Load | None = None, at_s: float | None = None) -> Array:
    """The state (2r,) of the reduced model at rest under gravity and `load`, as `find_equilibrium` has it."""
    eta = find_equilibrium(basis, load, at_s)
    return np.concatenate([eta, np.zeros_like(eta)])


def energy_above_rest(basis: ModalBasis, variant: Variant, x: Array) -> Array:
    """The exact energy H (...,) [J] of states x (..., 2r), less the least, that of rest under gravity.

    Without gravity rest is the undeformed shape, where H is 0.
    """
    model = reduced_order(basis, variant, "compiled")
    return np.asarray(model.energy(x) - model.energy(rest_state(basis)))


def sample_times(duration_s: float, step_s: float) -> Array:
    """0, step, …, duration [s], both ends included."""
    return np.linspace(0.0, duration_s, max(round(duration_s / step_s), 1) + 1)


def under(model: Model, basis: ModalBasis, case: Case, implementation: Implementation) -> Model:
    """The model with the load of the case: the paper's augmented structure (Fig. 11), or itself."""
    return model if case.load is None else loaded(model, basis, case.load, implementation)


def reference_solution(
    basis: ModalBasis, variant: Variant, case: Case, t: Array, integrator: Integrator
) -> ReferenceSolution:
    """The reduced-order model of `variant`, integrated tightly by the study's `reference_integrator`.

    Raises ArithmeticError if the reference itself does not reach the end, or does not move: then nothing can
    be measured.
    """
    model = reduced_order(basis, variant, "compiled")
    trajectory = simulate(under(model, basis, case, "compiled"), t, case.x0, integrator)
    if not trajectory.completed:
        raise ArithmeticError(f"reference {variant}, simulation {case.number}: {trajectory.reason}")
    at_rest = rest_state(basis)
    motion = tip_motion(model, trajectory.x)
    peak = float(np.linalg.norm(motion - tip_motion(model, at_rest[None]), axis=1).max())
    if not peak > _STANDSTILL * basis.structure.length_m:
        cause = "the load moves none of the modes" if case.load else "it starts at rest"
        raise ArithmeticError(
            f"reference {variant}, simulation {case.number}: does not move, and errors are relative to its "
            f"motion ({cause})"
        )
    energy = energy_above_rest(basis, variant, trajectory.x)
    return ReferenceSolution(case=case, t=t, x=trajectory.x, motion=motion, energy=energy, peak=peak)


def reference_solutions(
    basis: ModalBasis, variant: Variant, cases: list[Case], t: Array, integrator: Integrator
) -> Iterator[ReferenceSolution]:
    """One tight solution per case."""
    return (reference_solution(basis, variant, case, t, integrator) for case in cases)
