"""A surrogate from Python, in five lines:

import flexsurr

wing = flexsurr.load_surrogate("results/runs/<run_id>/weights.npz")
response = wing.simulate(initial={"eta_1": 5.0}, duration_s=10.0)
response.plot("response.png")
"""

import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, cast, get_args

import numpy as np
import pandas as pd
from pydantic import TypeAdapter

from flexsurr.beam import find_equilibrium, loaded, reduced_order
from flexsurr.config.load import Load
from flexsurr.config.study import Integrator, Variant
from flexsurr.evaluation.accuracy import tip_error
from flexsurr.evaluation.cases import Case, reference_solution, tip_motion
from flexsurr.simulation import Ensemble, Trajectory, simulate, simulate_ensemble
from flexsurr.simulation.ensemble import Observe
from flexsurr.simulation.rhs import Array, Model
from flexsurr.surrogates import Hamiltonian, compiled
from flexsurr.training import saved_surrogate
from flexsurr.training.saved_surrogate import SavedSurrogate

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ANY_STIFFNESS = Integrator(method="scipy_lsoda", rtol=1e-8, atol=1e-10)
"""Changes by itself between a smooth method and a stiff one; nothing has to be compiled."""


COMPILED_STIFF = Integrator(method="radau_iia_5", rtol=1e-6, atol=1e-9)
"""Takes any surrogate, and is compiled: what ensembles are stepped by where nothing else is asked for."""

REFERENCE = Integrator(method="radau_iia_5", rtol=1e-9, atol=1e-12)
"""By which the model that a surrogate stands for is stepped where errors are asked for."""

Kept = Literal["final", "states", "tip", "final_tip", "tip_error"]
"""What is kept of each trajectory: (d,), (m, d), (m, 3) [m], (3,) [m] or a number [%]."""

AnyLoad = Load | Mapping[str, Any]


class OutOfRange(UserWarning):
    """A simulation has left the range in which its surrogate was trained."""


@dataclass(frozen=True, eq=False)
class Response:
    """A simulation of a surrogate, as far as it came.

    `tip` (m, 3) [m] is the position of the tip in the clamp's frame before it is turned, `twist` (m,) [rad]
    that of the tip against the clamp, `nodes` (m, N + 1, 3) [m] are the ends of the elements from the clamp
    on; all are None for data that came from no structure. `energy` (m,) [J] is the model's own, without the
    work of the load, or None where it has none.
    """

    name: str
    trajectory: Trajectory
    tip: Array | None
    twist: Array | None
    energy: Array | None
    nodes: Array | None = None

    def called(self, name: str) -> "Response":
        """The same under another name, which tables and figures show."""
        return replace(self, name=name)

    @property
    def t(self) -> Array:
        """Times [s], (m,)."""
        return self.trajectory.t

    @property
    def x(self) -> Array:
        """States (m, d) in their units."""
        return self.trajectory.x

    def table(self) -> pd.DataFrame:
        """A row for each time: t_s, the states, tip_x_m, tip_y_m, tip_z_m, tip_twist_rad and energy_J."""
        columns: dict[str, Array] = {"t_s": self.t}
        columns |= dict(zip(self.trajectory.state_names, self.x.T, strict=True))
        if self.tip is not None and self.twist is not None:
            columns |= dict(zip(("tip_x_m", "tip_y_m", "tip_z_m"), self.tip.T, strict=True))
            columns["tip_twist_rad"] = self.twist
        if self.energy is not None:
            columns["energy_J"] = self.energy
        return pd.DataFrame(columns)

    def plot(self, path: str | Path | None = None) -> "Figure":
        """Tip, or states where there is no tip, over time; written to `path` (.png, .svg, .pdf) if given."""
        from flexsurr.report.response_figures import response_plot  # here, for matplotlib takes a second

        figure = response_plot(self.table(), self.name)
        if path is not None:
            figure.savefig(path)
        return figure


class LoadedSurrogate:
    """A surrogate that can be simulated; `saved` is what its file holds."""

    def __init__(self, saved: SavedSurrogate) -> None:
        self.saved = saved
        self._model = compiled(saved.surrogate)

    @property
    def state_names(self) -> tuple[str, ...]:
        """Of the d states."""
        return self._model.state_names

    @property
    def state_units(self) -> tuple[str, ...]:
        """Of the d states."""
        return self._model.state_units

    def __str__(self) -> str:
        """What it is, what it stands for, its states and where it was trained: a few lines."""
        saved = self.saved
        lines = [
            f"{saved.run_id}: {saved.surrogate.architecture}, {saved.surrogate.parameter_count} parameters",
            f"study {saved.study}, variant {saved.variant}",
        ]
        if saved.basis is not None:
            structure = saved.basis.structure
            lines.append(
                f"stands for {structure.name}: {structure.length_m:g} m, {structure.elements} elements, "
                f"{', '.join(structure.ordered_joints)}; {saved.basis.normalisation} modes at "
                f"{', '.join(f'{omega:.4g}' for omega in saved.basis.omega_rad_s)} rad/s"
            )
            lines.append("outputs tip position [m], tip twist [rad]")
        lines.append("trained with")
        width = max(map(len, self.state_names))
        lines += [
            f"  {name:<{width}}  {low:>10.4g} to {high:<10.4g} {unit}"
            for name, low, high, unit in zip(
                self.state_names, saved.low, saved.high, self.state_units, strict=True
            )
        ]
        return "\n".join(lines)

    def simulate(
        self,
        *,
        duration_s: float,
        initial: Mapping[str, float] | Sequence[float] | Array | None = None,
        load: Load | Mapping[str, Any] | None = None,
        step_s: float = 0.01,
        integrator: Integrator = ANY_STIFFNESS,
    ) -> Response:
        """The response over `duration_s`, sampled about every `step_s`.

        initial: every state, or some by their names and the others as at rest; by default at rest.
        load: one of `flexsurr.config.load`, or its keys as in config/studies, such as {"kind": "tip_force",
        "force_N": 10.0, "history": {"kind": "sine", "frequency_rad_s": 50.0}}. A history's file lies where
        its path leads from the current folder.

        Warns with `OutOfRange` where a state leaves the training range, once. A simulation that fails ends
        its response: see `trajectory.completed` and `trajectory.reason`. Raises ValueError for a state
        that there is not, and for a load that the structure cannot feel.
        """
        surrogate = self.saved.surrogate
        energy = surrogate.energy if isinstance(surrogate, Hamiltonian) else None
        times = _times(duration_s, step_s)
        response = self._response(self._model, self.saved.run_id, energy, times, initial, load, integrator)
        left = self.saved.outside(response.x)
        if left:
            warnings.warn(left, OutOfRange, stacklevel=2)
        return response

    def reference(
        self,
        *,
        duration_s: float,
        initial: Mapping[str, float] | Sequence[float] | Array | None = None,
        load: Load | Mapping[str, Any] | None = None,
        step_s: float = 0.01,
        integrator: Integrator = ANY_STIFFNESS,
    ) -> Response:
        """The response of the reduced-order model that the surrogate stands for, as `simulate` has it.

        Raises ValueError where it stands for none, too.
        """
        basis = self.saved.basis
        if basis is None:
            raise ValueError(f"reference: {self.saved.run_id} stands for no structure")
        variant: Variant = "as_printed" if self.saved.variant == "as_printed" else "hamiltonian"
        model = reduced_order(basis, variant, "compiled")
        times = _times(duration_s, step_s)
        return self._response(model, "reduced order", model.energy, times, initial, load, integrator)

    def simulate_ensemble(
        self,
        *,
        initial: Array,
        duration_s: float,
        keep: Kept = "final",
        load: AnyLoad | list[AnyLoad | None] | None = None,
        step_s: float = 0.01,
        integrator: Integrator = COMPILED_STIFF,
        threads: int | None = None,
        device: str | None = None,
    ) -> Ensemble:
        """Responses from each of the states `initial` (n, d) over `duration_s`, on all cores.

        keep: of each response its `final` state or all `states`, the position of the tip at the end
        (`final_tip`) or over time (`tip`), or `tip_error`, its largest error in percent of the largest
        displacement of the reduced-order model that the surrogate stands for, which is simulated too;
        infinite where the response ends early. It is `kept` of what is returned; states and tips over time
        are sampled about every `step_s`, and not a number from where a response has ended.
        load: as in `simulate`, one for all or one for each.
        integrator: a fixed step, {rk4, dop853_fixed}, steps small surrogates 64 at a time, and is the
        fastest by far; it must be short enough for the fastest motion.
        threads: by default as many as there are cores. Results are the same with any number.
        device: "cuda" or "cpu", where torch steps them; for fixed steps without loads.

        Warns with `OutOfRange` where a state leaves the training range, once. Raises ValueError as
        `simulate` does.
        """
        if keep not in get_args(Kept):
            raise ValueError(f"keep: {keep!r} is not allowed; allowed: {', '.join(get_args(Kept))}")
        if keep not in ("final", "states") and self.saved.basis is None:
            raise ValueError(f"keep: {self.saved.run_id} stands for no structure that has a tip")
        x0 = np.asarray(initial, dtype=np.float64)
        if x0.ndim != 2 or x0.shape[1] != len(self.state_names) or not np.isfinite(x0).all():
            raise ValueError(
                f"initial: rows of {len(self.state_names)} finite numbers are needed, one for each of "
                f"{', '.join(self.state_names)}"
            )
        t = _times(duration_s, duration_s if keep.startswith("final") else step_s)
        models: Model | list[Model]
        if isinstance(load, list):
            models = [self._under(self._model, each) for each in load]
        else:
            models = self._under(self._model, load)
        observe = self._observing(keep, t, x0, models)
        left: list[str] = []

        def note(numbers: slice, x: Array) -> Array:
            left.extend(filter(None, map(self.saved.outside, x)))
            return observe(numbers, x)

        if device is None:
            found = simulate_ensemble(models, t, x0, integrator, observe=note, threads=threads)
        elif load is None:
            from flexsurr.training.on_device import simulate_on_device  # here, for it imports torch

            found = simulate_on_device(self.saved.surrogate, t, x0, integrator, device, note)
        else:
            raise ValueError("device: torch knows no loads; leave device or load out")
        if left:
            warnings.warn(f"{len(left)} of {len(x0)} responses, {left[0]}", OutOfRange, stacklevel=2)
        return found

    def _observing(self, keep: Kept, t: Array, x0: Array, models: Model | list[Model]) -> Observe:
        """What makes of states (k, m, d) what is kept of them."""

        def tips(numbers: slice, x: Array) -> Array:
            # one after another, for the joints of all at once would take more memory than their states
            return np.stack([np.asarray(self.saved.tip(states)) for states in x])

        observers: dict[Kept, Observe] = {
            "final": lambda numbers, x: x[:, -1],
            "states": lambda numbers, x: x,
            "tip": tips,
            "final_tip": lambda numbers, x: tips(numbers, x[:, -1:])[:, 0],
        }
        return observers.get(keep) or self._tip_errors(t, x0, models)

    def _tip_errors(self, t: Array, x0: Array, models: Model | list[Model]) -> Observe:
        """What makes of states (k, m, d) the largest error of each tip, in percent of the largest motion."""
        assert self.saved.basis is not None
        basis, variant = self.saved.basis, cast("Variant", self.saved.variant)
        exact = reduced_order(basis, variant, "compiled")

        def errors(numbers: slice, x: Array) -> Array:
            found = np.full(len(x), np.inf)
            for k in np.flatnonzero(np.isfinite(x[:, -1]).all(axis=1)):
                number = numbers.start + int(k)
                model = models[number] if isinstance(models, list) else models
                case = Case(number, x0[number], getattr(model, "load", None))
                reference = reference_solution(basis, variant, case, t, REFERENCE)
                found[k] = tip_error(reference, tip_motion(exact, x[k])).whole_percent
            return found

        return errors

    def _response(
        self,
        model: Model,
        name: str,
        energy: Callable[[Array], Array] | None,
        t: Array,
        initial: Mapping[str, float] | Sequence[float] | Array | None,
        load: Load | Mapping[str, Any] | None,
        integrator: Integrator,
    ) -> Response:
        trajectory = simulate(self._under(model, load), t, self._state(initial), integrator)
        x, saved = trajectory.x, self.saved
        own = None if energy is None else energy(x)
        return Response(name, trajectory, saved.tip(x), saved.twist(x), own, saved.nodes(x))

    def _under(self, model: Model, load: Load | Mapping[str, Any] | None) -> Model:
        if load is None:
            return model
        if self.saved.basis is None:
            raise ValueError(f"load: {self.saved.run_id} stands for no structure that could feel one")
        checked: Load = TypeAdapter(Load).validate_python(load)
        checked.check(self.saved.basis.structure)
        return loaded(model, self.saved.basis, checked.with_tables(Path()), "compiled")

    def _state(self, initial: Mapping[str, float] | Sequence[float] | Array | None) -> Array:
        d = len(self.state_names)
        if initial is not None and not isinstance(initial, Mapping):
            state = np.asarray(initial, dtype=np.float64)
            if state.shape != (d,):
                raise ValueError(
                    f"initial: {d} numbers are needed, one for each of {', '.join(self.state_names)}"
                )
            return state
        state = np.zeros(d)
        if self.saved.basis is not None:
            state[: d // 2] = find_equilibrium(self.saved.basis)
        for name, value in (initial or {}).items():
            if name not in self.state_names:
                raise ValueError(f"initial: {name!r} is no state; allowed: {', '.join(self.state_names)}")
            state[self.state_names.index(name)] = value
        return state


def _times(duration_s: float, step_s: float) -> Array:
    """0, step, …, duration [s]. ValueError unless both are more than 0."""
    if not (duration_s > 0.0 and step_s > 0.0):
        raise ValueError(f"duration_s, step_s: {duration_s}, {step_s} are not allowed; allowed: more than 0")
    return np.linspace(0.0, duration_s, max(round(duration_s / step_s), 1) + 1)


def animate(responses: Sequence[Response], path: str | Path, title: str = "") -> None:
    """Write the responses side by side, moving, to `path`: a .gif, or a .html that needs no network.

    The first, the reference, stands grey behind each of the others. All have the same times. Raises
    ValueError for responses that came from no structure, and for another ending.
    """
    from flexsurr.report.animation import save_animation  # here, for matplotlib takes a second

    motions: dict[str, Array] = {}
    for response in responses:
        if response.nodes is None:
            raise ValueError(f"{response.name} stands for no structure that could be seen to move")
        motions[response.name] = response.nodes
    longest = max((response.t for response in responses), key=len, default=np.zeros(0))
    save_animation(motions, longest, title, Path(path))


def load_surrogate(path: str | Path) -> LoadedSurrogate:
    """The surrogate that training wrote to `path`.

    Raises SurrogateFileError for a damaged or foreign file, OSError where there is none.
    """
    return LoadedSurrogate(saved_surrogate.load_surrogate(path))
