"""Models of every kind to export, each with what it must give."""

import sys
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache, partial
from pathlib import Path

import numpy as np

from flexsurr.aerodynamics.features import ALPHA, BETA, COEFFICIENTS, FEATURES, MACH
from flexsurr.beam import reduce, tip_position, tip_twist
from flexsurr.cli.export import UNITS
from flexsurr.config.aircraft import load_aircraft
from flexsurr.config.along_span import AlongSpan
from flexsurr.config.structure import Structure
from flexsurr.config.study import Reduction
from flexsurr.export import ExportedModel, Quantity, exported_aircraft, exported_map, exported_surrogate
from flexsurr.export.expressions import argument
from flexsurr.export.from_program import outputs_of
from flexsurr.flight import free_modes, stick_model
from flexsurr.flight.equations_of_motion import ALTITUDE_M, VELOCITY_IN_X
from flexsurr.flight.model import FlightModel, features
from flexsurr.surrogates import (
    ACTIVATIONS,
    HNN,
    MLP,
    DissipativeHNN,
    FeatureScaling,
    Intervals,
    NetworkMap,
    PolynomialMap,
    PortHamiltonian,
)
from flexsurr.surrogates.monomials import monomials_to_degree
from flexsurr.surrogates.potential import Potential
from flexsurr.surrogates.torch_module import field
from flexsurr.surrogates.torch_program import program_of
from flexsurr.training.saved_surrogate import SavedSurrogate

sys.path += [str(Path(__file__).parents[1] / folder) for folder in ("surrogates", "training")]

import torch
from own_models import Energy, EnergyAndDissipation, Lagrangian, MessagePassing, Plain
from random_surrogates import (
    HAMILTONIANS,
    PORT_HAMILTONIANS,
    network,
    port_polynomial,
)
from torch import nn

SAMPLES = 20
GNBA = Path(__file__).resolve().parents[2] / "config/aircraft/gnba.yaml"
CONTROLS = (-0.02, 0.01, 0.03, -0.04, 0.05, 0.02)
WING = Structure(
    name="wing",
    length_m=2.0,
    elements=5,
    joints=("in_plane", "out_of_plane", "torsion"),
    mass_per_length_kg_m=0.2,
    bending_stiffness_out_of_plane_N_m2=50.0,
    bending_stiffness_in_plane_N_m2=500.0,
    torsional_stiffness_N_m2=20.0,
    torsional_inertia_per_length_kg_m=1e-3,
    centre_of_gravity_offset_m=0.02,
)
WINGS = {
    "wing_in_sequence": WING.model_copy(update={"joint_rotation": "sequence"}),
    "wing_bent": WING.model_copy(
        update={
            "along_span": AlongSpan(stations_m=(0.0, 2.0), axis_psi_deg=(20.0, 50.0), axis_phi_deg=(0.0, 9.0))
        }
    ),
}


@dataclass(frozen=True)
class Case:
    """A model; states x (m, d) and inputs u (m, n); and the rates and outputs that it stands for.

    `cancelling` is how many times the sizes of an output's terms are the output's own: rounding grows by it.
    """

    model: ExportedModel
    x: np.ndarray
    u: np.ndarray
    rates: np.ndarray
    outputs: np.ndarray
    cancelling: float = 1.0


def of_surrogate(name, surrogate, structure: Structure | None = None, span: float = 1.0) -> Case:
    """A surrogate at states within `span` of its scale, under generalised forces where it takes any."""
    generator = np.random.default_rng(1)
    d = len(surrogate.state_names)
    reduction = Reduction(modes=d // 2, normalisation="mass")
    basis = reduce(structure, reduction) if structure is not None else None
    scale = span * surrogate.scaling.states(d)
    saved = SavedSurrogate(surrogate, "tests", "hamiltonian", name, -scale, scale, basis)
    model = exported_surrogate(saved)
    x = scale * generator.uniform(-1.0, 1.0, (SAMPLES, d))
    u = generator.uniform(-1.0, 1.0, (SAMPLES, len(model.inputs)))
    u *= surrogate.scaling.rates(d)[d - u.shape[1] :]
    rates = np.array([surrogate.derivative(0.0, row) for row in x])
    rates[:, d - u.shape[1] :] += u
    outputs = []
    if basis is not None:
        joints = x[:, : d // 2] @ basis.modes.T
        outputs += [tip_position(basis.structure, joints), tip_twist(basis.structure, joints)[:, None]]
    if any(quantity.name.startswith("energy") for quantity in model.outputs):
        outputs.append(surrogate.energy(x)[:, None])
    return Case(model, x, u, rates, np.hstack(outputs) if outputs else np.empty((SAMPLES, 0)))


def of_map(name, learned) -> Case:
    """A learned map."""
    low, high = learned.inputs.low, learned.inputs.high
    u = np.random.default_rng(2).uniform(low, high, (SAMPLES, len(low)))
    nothing = np.empty((SAMPLES, 0))
    units = [[UNITS.get(of, "") for of in names] for names in (learned.inputs.names, learned.output_names)]
    return Case(exported_map(learned, name, None, *units), nothing, u, nothing, learned(u))


def of_cancelling_terms(name) -> Case:
    """A network as training leaves it: squares of its inputs, by differences of neurons nearly alike."""
    n, width, sigma = 3, 1e-2, np.tanh
    inner = np.hstack([width * np.eye(n), np.zeros((n, 1)), -width * np.eye(n)])
    readout = np.concatenate([np.ones(n), [-2.0 * n], np.ones(n)]) / width**2
    parameters = np.concatenate([inner.ravel(), np.ones(2 * n + 1), readout, np.zeros(1)])
    inputs = Intervals(("a", "b", "c"), -np.ones(n), np.ones(n))
    outputs = Intervals(("square",), -np.ones(1), np.ones(1))
    plain = of_map(name, NetworkMap(inputs, outputs, 2 * n + 1, "tanh", parameters))
    terms = np.abs(sigma(plain.u @ inner + 1.0) * readout).sum(axis=1)
    return replace(plain, cancelling=float(np.max(terms) / np.max(np.abs(plain.outputs))))


def of_aircraft(name, learned: PolynomialMap) -> Case:
    """The airliner in flight, in turns and at any deformation, on both sides of the tropopause."""
    generator = np.random.default_rng(6)
    modes = free_modes(stick_model(load_aircraft(GNBA)), 8)
    model = FlightModel(modes, learned.compiled(), chosen=(1, 2, 5, 7), controls=CONTROLS, thrust_N=5e4)
    x = generator.normal(size=(SAMPLES, len(model.state_names)))
    x[:, ALTITUDE_M] = np.linspace(5e3, 15e3, SAMPLES)
    x[:, VELOCITY_IN_X] = [200.0, 5.0, 20.0] + 10.0 * generator.normal(size=(SAMPLES, 3))
    u = np.tile((*CONTROLS, 5e4), (SAMPLES, 1))
    rates = np.array([model.derivative(0.0, row) for row in x])
    onsets = features(model, np.zeros(SAMPLES), x)
    speed = np.linalg.norm(x[:, VELOCITY_IN_X], axis=1)
    outputs = np.column_stack([speed, onsets[:, [MACH, ALPHA, BETA]], learned(onsets)])
    return Case(exported_aircraft(model, x[0], learned, name), x, u, rates, outputs)


def of_module(name, module: nn.Module, states: int) -> Case:
    """A torch module, by its program."""
    module = module.double().requires_grad_(False).eval()
    x = argument("x", states)
    quantities = tuple(Quantity(f"x_{k}", "", "state") for k in range(states))
    none = argument("none", 0)
    model = ExportedModel(
        name,
        (name,),
        quantities,
        (),
        (),
        x,
        argument("u", 0),
        outputs_of(program_of(module, states), x),
        none,
        0.1,
    )
    at = np.random.default_rng(3).normal(size=(SAMPLES, states))
    rates = field(module, torch.from_numpy(at)).detach().numpy()
    nothing = np.empty((SAMPLES, 0))
    return Case(model, at, nothing, rates, nothing)


class Elementwise(nn.Module):
    """Rates of every function number by number, of one linear map."""

    def __init__(self, states):
        super().__init__()
        self.linear = nn.Linear(states, states)
        self.mixed = nn.Parameter(torch.randn(len(ELEMENTWISE)))

    def forward(self, x):
        z = self.linear(x)
        return sum(weight * function(z) for weight, function in zip(self.mixed, ELEMENTWISE, strict=True))


ELEMENTWISE = (
    torch.tanh, torch.sigmoid, torch.sin, torch.cos, torch.atan, torch.exp, torch.relu, torch.abs,
    torch.expm1, torch.reciprocal, torch.square, nn.functional.softplus,
    nn.functional.gelu, nn.functional.elu, nn.functional.leaky_relu, nn.functional.hardtanh,
)  # fmt: skip


def _unpaired() -> MLP:
    """Three states, each with a scale and an origin of its own."""
    names = {"state_names": ("a", "b", "c"), "state_units": ("m", "", 's "x" \\')}
    scaling = FeatureScaling((2.0, 0.1, 30.0), (1.0, 5.0, 0.2), (-1.0, 0.3, 7.0), (0.1, 0.2, -4.0))
    parameters = np.random.default_rng(4).normal(size=3 * 5 + 5 + 5 * 4 + 4 + 4 * 3 + 3)
    return MLP(parameters, scaling, **names, hidden=(5, 4), activation="elu")


def _of_features() -> HNN:
    """A gradient whose scaling is not canonical."""
    scaling = FeatureScaling((2.0, 0.1), (1.0, 5.0), (-1.0, 0.3), (0.1, 0.2))
    return replace(network(HNN, 2, (6,), "tanh"), scaling=scaling)


HEAVY = ("even", "network", "even entries")


def _heavy(surrogate: PortHamiltonian) -> PortHamiltonian:
    """The same with a potential beside it."""
    exponents = monomials_to_degree(surrogate.pairs, 4)
    coefficients = np.random.default_rng(3).normal(size=len(exponents))
    return replace(surrogate, potential=Potential(exponents, coefficients))


OF_WING = {
    "wing": port_polynomial(6, 4, even=True),
    "wing_mlp": network(MLP, 6, (8,), "tanh"),
    "wing_dissipative": network(DissipativeHNN, 6, (5, 4), "softplus"),
}
SURROGATES = {
    **{f"hamiltonian {name}": surrogate for name, surrogate in HAMILTONIANS.items()},
    **{f"port {name}": surrogate for name, surrogate in PORT_HAMILTONIANS.items()},
    **{f"port {name} with a potential": _heavy(PORT_HAMILTONIANS[name]) for name in HEAVY},
    **{f"hnn {name}": network(HNN, 2, (6, 5), name) for name in ACTIVATIONS},
    "mlp": network(MLP, 2, (6, 5), "atan"),
    "dissipative": network(DissipativeHNN, 4, (6,), "silu"),
    "unpaired": _unpaired(),
    "features": _of_features(),
}
MODULES = (Plain, Energy, EnergyAndDissipation, Lagrangian, MessagePassing, Elementwise)


def _module(form: type[nn.Module], states: int) -> Case:
    torch.manual_seed(0)
    return of_module(form.__name__, form(states), states)


def _makers() -> dict[str, Callable[[], Case]]:
    makers: dict[str, Callable[[], Case]] = {}
    for name, surrogate in OF_WING.items():
        makers[name] = partial(of_surrogate, name, surrogate, WING)
    for name, wing in WINGS.items():
        makers[name] = partial(of_surrogate, name, OF_WING["wing_mlp"], wing)
    for name, surrogate in SURROGATES.items():
        makers[name] = partial(of_surrogate, name, surrogate)
    of_eight_modes = network(MLP, 16, (8,), "tanh")
    makers["eight_modes"] = partial(of_surrogate, "eight_modes", of_eight_modes, WING, span=0.05)
    for name, learned in maps().items():
        makers[name] = partial(of_map, name, learned)
    makers["aerodynamics"] = partial(of_map, "aerodynamics", aerodynamics())
    makers["cancelling"] = partial(of_cancelling_terms, "cancelling")
    makers["aircraft"] = partial(of_aircraft, "aircraft", aerodynamics())
    for form in MODULES:
        makers[form.__name__] = partial(_module, form, 4)
    return {name.replace(" ", "_"): maker for name, maker in makers.items()}


@cache
def case(name: str) -> Case:
    """The case of this name, one of `NAMES`."""
    return _MAKERS[name]()


def aerodynamics() -> PolynomialMap:
    """An airliner's aerodynamics of first order, of the usual signs and sizes: it has a trim."""
    half = np.array([0.3, 6000.0, 0.2, 0.2, *[0.01] * 3, *[0.3] * 6, *[5.0] * 6, *[0.1] * 6])
    middle = np.array([0.6, 9000.0, *[0.0] * 23])
    slopes = {
        "C_L": {"alpha": 6.0, "i_t": 0.9, "delta_e_left": 0.2, "delta_e_right": 0.2},
        "C_D": {"alpha": 0.2, "mach": 0.01},
        "C_Y": {"beta": -0.8, "delta_r": 0.2},
        "C_m": {"alpha": -1.5, "i_t": -3.5, "q_over_V": -40.0, "delta_e_left": -0.8, "delta_e_right": -0.8},
        "C_l": {"beta": -0.1, "p_over_V": -7.0, "delta_a_left": 0.1, "delta_a_right": -0.1},
        "C_n": {"beta": 0.15, "r_over_V": -3.0, "delta_r": -0.1},
        "C_phi_1": {"alpha": 1e-4, "eta_dot_1_over_V": -1e-6},
        "C_phi_3": {"delta_a_left": 1e-5, "eta_2": -1e-7},
    }
    coefficients = np.zeros((1 + len(FEATURES), len(COEFFICIENTS)))
    coefficients[0, :4] = 0.2, 0.022, 0.0, 0.05
    for output, by in slopes.items():
        for feature, slope in by.items():
            place = FEATURES.index(feature)
            coefficients[1 + place, COEFFICIENTS.index(output)] = slope * half[place]
    exponents = np.concatenate([np.zeros((1, 25), dtype=np.int64), np.eye(25, dtype=np.int64)])
    return PolynomialMap(
        Intervals(FEATURES, middle - half, middle + half), COEFFICIENTS, exponents, coefficients
    )


def maps():
    generator = np.random.default_rng(5)
    low = generator.uniform(-2.0, 3.0, 6)
    inputs = Intervals(tuple(f"u{k}" for k in range(6)), low, low + generator.uniform(0.1, 3.0, 6))
    outputs = Intervals(("C_L", "C_D"), np.array([-1.0, 0.0]), np.array([2.0, 0.3]))
    products = ((0, 0), (1, 4), (5, 2))
    parameters = generator.normal(size=9 * 7 + 7 + 7 * 2 + 2)
    exponents = np.concatenate([np.zeros((1, 6), dtype=np.int64), monomials_to_degree(6, 3)])
    coefficients = generator.normal(size=(len(exponents), 2))
    return {
        "map network": NetworkMap(inputs, outputs, 7, "softplus", parameters, products),
        "map polynomial": PolynomialMap(inputs, ("C_L", "C_D"), exponents, coefficients),
    }


_MAKERS = _makers()
NAMES = tuple(_MAKERS)
