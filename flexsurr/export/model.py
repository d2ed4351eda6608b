"""What is exported: names and units of all that goes in and comes out, and the functions between them."""

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from flexsurr import __version__
from flexsurr.beam import ModalBasis, find_equilibrium
from flexsurr.beam.chain import chain
from flexsurr.beam.rotation_vector import stumpff
from flexsurr.export.expressions import Value, argument, concat, constant, each
from flexsurr.export.formulas import NotExported, outputs_of_map, scaled_field
from flexsurr.simulation.rhs import Array
from flexsurr.surrogates import EvenHNN, Hamiltonian, LearnedMap, PolynomialHamiltonian, Surrogate
from flexsurr.surrogates.hnn import ScalarNetworks
from flexsurr.surrogates.scaling import origins, scaled_states
from flexsurr.training.saved_surrogate import MARGIN, SavedSurrogate

PHASE_STEP = 0.05
"""The recommended step times the fastest rate at the start [rad]."""


@dataclass(frozen=True)
class Quantity:
    """A state, an input or an output.

    `start` is its value at rest; a surrogate is to be believed from `low` to `high` where there are such.
    """

    name: str
    unit: str
    meaning: str
    start: float = 0.0
    low: float | None = None
    high: float | None = None


@dataclass(frozen=True, eq=False)
class ExportedModel:
    """ẋ = f(x, u) and y = g(x, u), or without states y = g(u) alone.

    `x` and `u` are the arguments of which `rates` (d,) and `results` (k,) are expressions. `step_s` is a step
    with which the classical Runge-Kutta method follows the model, from its fastest rate at the start.
    """

    name: str
    about: tuple[str, ...]
    states: tuple[Quantity, ...]
    inputs: tuple[Quantity, ...]
    outputs: tuple[Quantity, ...]
    x: Value
    u: Value
    rates: Value | None
    results: Value
    step_s: float = 0.0

    def __post_init__(self) -> None:
        names = [quantity.name for quantity in (*self.states, *self.inputs, *self.outputs)]
        twice = sorted({name for name in names if names.count(name) > 1})
        if twice:
            raise NotExported(f"the name {twice[0]} stands for two quantities")
        if not re.fullmatch(r"[A-Za-z][A-Za-z0-9_]*", self.name):
            raise NotExported(
                f"name: {self.name!r} is not allowed; allowed: letters, digits and _, a letter first"
            )


def exported_surrogate(saved: SavedSurrogate, name: str | None = None) -> ExportedModel:
    """A surrogate as its file holds it. Its inputs are generalised forces, which are added to ṗ.

    There are such where the states come in pairs (q, p). Outputs are position and twist of the tip where it
    stands for a structure, and the energy where it knows it. Raises NotExported where it has no form outside
    of Python.
    """
    surrogate, basis = saved.surrogate, saved.basis
    d = len(surrogate.state_names)
    r = d // 2
    paired = surrogate.paired or basis is not None
    x, u = argument("x", d), argument("u", r if paired else 0)
    x_from, dx_from = origins(surrogate.scaling, d)
    scaled = (x - x_from if x_from.any() else x) * (1.0 / surrogate.scaling.states(d))
    field, scaled_energy = scaled_field(surrogate, scaled)
    rates = field * surrogate.scaling.rates(d)
    rates = rates + dx_from if dx_from.any() else rates
    if paired:
        rates = concat([rates[:r], rates[r:] + u])
    outputs, results = [], []
    if basis is not None:
        position, twist = tip(basis, x[:r])
        outputs += [
            Quantity(f"tip_{axis}_m", "m", f"position of the tip along {axis} in the clamp's frame")
            for axis in "xyz"
        ]
        outputs.append(Quantity("tip_twist_rad", "rad", "twist of the tip against the clamp"))
        results += [position, twist]
    if scaled_energy is not None and isinstance(surrogate, Hamiltonian):
        at_origin = _scaled_energy_at_origin(surrogate)
        energy = scaled_energy - at_origin if at_origin else scaled_energy
        unit = "J" if basis is not None else f"({surrogate.state_units[0]}) ({surrogate.state_units[r]})/s"
        outputs.append(
            Quantity("energy_J" if basis is not None else "energy", unit, "the surrogate's own energy")
        )
        results.append(energy * surrogate.scaling.energy)
    start = np.zeros(d)
    if basis is not None:
        start[:r] = find_equilibrium(basis)
    return ExportedModel(
        name=_identifier(name, saved.run_id),
        about=(
            f"{saved.run_id}: {surrogate.architecture}, {surrogate.parameter_count} parameters.",
            f"Study {saved.study}, variant {saved.variant}"
            + (f"; stands for {basis.structure.name}." if basis is not None else "."),
            f"Written by flexsurr {__version__}.",
        ),
        states=tuple(
            Quantity(*named, "state", *numbers)
            for named, numbers in zip(
                zip(surrogate.state_names, surrogate.state_units, strict=True),
                zip(start.tolist(), saved.low.tolist(), saved.high.tolist(), strict=True),
                strict=True,
            )
        ),
        inputs=tuple(
            Quantity(f"force_{q}", f"({unit})/s", f"generalised force of {q}, added to the rate of {p}")
            for q, p, unit in zip(
                surrogate.state_names[:r],
                surrogate.state_names[r:],
                surrogate.state_units[r:],
                strict=False,
            )
        )
        if paired
        else (),
        outputs=tuple(outputs),
        x=x,
        u=u,
        rates=rates,
        results=concat(results) if results else argument("none", 0),
        step_s=recommended_step(lambda at: surrogate.derivative(0.0, at), start, saved.high - saved.low),
    )


def exported_map(
    learned: LearnedMap,
    run_id: str,
    name: str | None = None,
    input_units: Sequence[str] = (),
    output_units: Sequence[str] = (),
) -> ExportedModel:
    """A learned map y = g(u); units are unknown, "", where none are given."""
    intervals = learned.inputs
    u = argument("u", len(intervals.names))
    units = tuple(input_units) or ("",) * len(intervals.names)
    of_outputs = tuple(output_units) or ("",) * len(learned.output_names)
    return ExportedModel(
        name=_identifier(name, run_id),
        about=(
            f"{run_id}: {learned.kind} ({learned.form}), {learned.parameter_count} parameters.",
            f"Written by flexsurr {__version__}.",
        ),
        states=(),
        inputs=tuple(
            Quantity(of, unit, "input", 0.5 * (low + high), low, high)
            for of, unit, low, high in zip(
                intervals.names, units, intervals.low.tolist(), intervals.high.tolist(), strict=True
            )
        ),
        outputs=tuple(
            Quantity(of, unit, "output") for of, unit in zip(learned.output_names, of_outputs, strict=True)
        ),
        x=argument("x", 0),
        u=u,
        rates=None,
        results=outputs_of_map(learned, u),
    )


def recommended_step(rates: Callable[[Array], Array], start: Array, span: Array) -> float:
    """`PHASE_STEP` over the fastest rate of the linear motion about `start` (d,) [s], to one digit.

    Differences are a thousandth of `span` (d,) wide.
    """
    widths = 1e-3 * span
    columns = [
        (rates(start + shift) - rates(start - shift)) / (2.0 * width)
        for width, shift in zip(widths, np.diag(widths), strict=True)
    ]
    fastest = float(np.abs(np.linalg.eigvals(np.array(columns).T)).max())
    return float(f"{PHASE_STEP / fastest:.0e}") if fastest > 0.0 else 0.01


def allowed_range(quantity: Quantity) -> tuple[float, float] | None:
    """From where to where a quantity is taken at its word: its range and a margin, if it has one."""
    if quantity.low is None or quantity.high is None:
        return None
    margin = MARGIN * (quantity.high - quantity.low)
    return quantity.low - margin, quantity.high + margin


def _scaled_energy_at_origin(surrogate: Surrogate) -> float:
    origin = scaled_states(surrogate.scaling, np.zeros(len(surrogate.state_names)))
    if isinstance(surrogate, ScalarNetworks):
        return float(surrogate.scaled_scalar(origin, 0))
    if isinstance(surrogate, PolynomialHamiltonian | EvenHNN):
        return float(surrogate.scaled_energy(origin))
    return 0.0


def _identifier(name: str | None, run_id: str) -> str:
    return name if name is not None else re.sub(r"\W", "_", run_id, flags=re.ASCII)


ENTRIES = 9  # of a turn


def tip(basis: ModalBasis, eta: Value) -> tuple[Value, Value]:
    """Position (3,) [m] in the clamp's frame before it is turned, eq. 1, and twist () [rad].

    The expressions of `flexsurr.beam.tip_position` and `tip_twist`.
    """
    beam = chain(basis.structure)
    n = beam.elements
    modes = np.zeros((4 * n, eta.size))
    modes[beam.rows] = basis.modes
    joints = eta @ modes.T
    psi, theta, phi, stretch = (joints[k * n : (k + 1) * n] for k in range(4))
    entries = _of_vectors(phi, -theta, psi) if beam.by_vector else _of_sequences(psi, theta, phi)
    turns = concat(entries).reshape(ENTRIES, n).T
    frame = constant(beam.clamp)
    along = []
    for i in range(n):
        turn = turns[i].reshape(3, 3)
        # constants first with what varies: a product of two constants has no place in a batch
        frame = frame @ (turn if beam.turns is None else constant(beam.turns[i]) @ turn)
        along.append(frame @ beam.stretches[i])
    steps = concat(along).reshape(n, 3)
    up = beam.clamp[:, 2] @ (frame @ constant(beam.undeformed.T))
    return (stretch + np.linalg.norm(beam.spans, axis=1)) @ steps, each("atan2", up[1], up[2])


def _of_sequences(psi: Value, theta: Value, phi: Value) -> list[Value]:
    """R_z(ψ) R_y'(θ) R_x(φ) of all elements (n,), entry by entry."""
    cz, sz, cy, sy, cx, sx = (each(of, angle) for angle in (psi, theta, phi) for of in ("cos", "sin"))
    return [
        cz * cy, -sz * cx - cz * sy * sx, sz * sx - cz * sy * cx,
        sz * cy, cz * cx - sz * sy * sx, -cz * sx - sz * sy * cx,
        sy, cy * sx, cy * cx,
    ]  # fmt: skip


def _of_vectors(x: Value, y: Value, z: Value) -> list[Value]:
    """The rotations by the vectors (x, y, z) of all elements (n,), entry by entry: 1 + c₁ [u] + c₂ [u]²."""
    c1, c2, *_ = stumpff(x * x + y * y + z * z)
    return [
        1.0 - c2 * (y * y + z * z), c2 * x * y - c1 * z, c2 * x * z + c1 * y,
        c2 * x * y + c1 * z, 1.0 - c2 * (x * x + z * z), c2 * y * z - c1 * x,
        c2 * x * z - c1 * y, c2 * y * z + c1 * x, 1.0 - c2 * (x * x + y * y),
    ]  # fmt: skip
