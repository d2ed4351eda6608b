"""Every model of a study in each of its implementations, ready to be simulated."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal, get_args

from flexsurr.beam import Implementation, ModalBasis, reduced_order
from flexsurr.config.study import Variant
from flexsurr.evaluation.cases import Case, under
from flexsurr.simulation.rhs import Array, CompiledModel, Model
from flexsurr.surrogates import LearnedLoad, LearnedMap, Network, compiled

Form = Literal["described", "numpy", "compiled", "torch"]
"""How a model is computed: as the reference models are, or by torch's autograd."""


@dataclass(frozen=True)
class Candidate:
    """A model in one implementation, under the name that tables and figures show.

    `own_energy` is the model's own Hamiltonian (k, 2r) -> (k,) [J], or None where it has none. With a
    `learned_load` (η -> Q) a load of a case acts through that instead of the kinematics; its shape must be
    the one that was learned.
    """

    model: str
    implementation: Form
    field: Model
    own_energy: Any = None
    learned_load: LearnedMap | None = None

    def under(self, basis: ModalBasis, case: Case) -> Model:
        """The field with the load of the case; beside flexsurr's own in torch the load is in NumPy."""
        if self.learned_load is not None and case.load is not None:
            histories = tuple(part.history for part in case.load.parts)
            return LearnedLoad(self.field, self.learned_load, histories)
        if self.implementation == "torch":
            return under(self.field, basis, case, "compiled" if self.steppable else "numpy")
        return under(self.field, basis, case, self.implementation)

    @property
    def steppable(self) -> bool:
        """Whether compiled integrators can step it."""
        return isinstance(self.field, CompiledModel)

    def energy(self, x: Array) -> Array | None:
        """The model's own energy (k,) [J] at states x (k, 2r)."""
        return None if self.own_energy is None else self.own_energy(x)


def fastest(surrogate: Any) -> Form:
    """The implementation by which compiled integrators step a surrogate: torch where it has no program."""
    return "torch" if is_users(surrogate) and surrogate.program is None else "compiled"


def is_users(surrogate: Any) -> bool:
    """Whether it is a torch module of the user's own."""
    return bool(surrogate.architecture == "torch")


def candidates(
    basis: ModalBasis, variant: Variant, surrogates: Mapping[str, Any], with_torch: bool = False
) -> list[Candidate]:
    """The reduced model described, numpy and compiled; each surrogate numpy, compiled and, on request, torch.

    `surrogates` maps an architecture's name to its fitted surrogate. Only networks have a torch form; those
    of the user's own have that and, where torch can export them, the compiled one.
    """
    found = []
    for implementation in get_args(Implementation):
        rom = reduced_order(basis, variant, implementation)
        found.append(Candidate("rom", implementation, rom, rom.energy))
    return [*found, *surrogate_candidates(surrogates, with_torch)]


def surrogate_candidates(surrogates: Mapping[str, Any], with_torch: bool = False) -> list[Candidate]:
    """Each surrogate numpy, compiled and, on request, torch, as `candidates` has them."""
    found = []
    for name, surrogate in surrogates.items():
        own_energy = getattr(surrogate, "energy", None)
        if not is_users(surrogate):
            found.append(Candidate(name, "numpy", surrogate, own_energy))
        found.append(Candidate(name, fastest(surrogate), compiled(surrogate), own_energy))
        if with_torch and is_users(surrogate) and fastest(surrogate) == "compiled":
            found.append(Candidate(name, "torch", surrogate, own_energy))
        if with_torch and isinstance(surrogate, Network):
            # torch takes seconds to import, and nothing else here needs it
            from flexsurr.training import torch_model

            found.append(Candidate(name, "torch", torch_model(surrogate), own_energy))
    return found


def with_learned_loads(name: str, surrogate: Any, loads: Mapping[str, LearnedMap]) -> list[Candidate]:
    """One surrogate in its fastest form, under each learned load instead of the exact one: no kinematics.

    `loads` maps what is added to the surrogate's `name` to generalised forces.
    """
    field, own_energy = compiled(surrogate), getattr(surrogate, "energy", None)
    return [
        Candidate(f"{name}_{added}", fastest(surrogate), field, own_energy, learned)
        for added, learned in loads.items()
    ]
