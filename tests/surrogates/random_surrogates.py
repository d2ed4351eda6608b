"""Surrogates with random weights."""

import math
from dataclasses import replace

import numpy as np

from flexsurr.surrogates import (
    HNN,
    MLP,
    DissipativeHNN,
    EvenHNN,
    Network,
    NetworkPortHamiltonian,
    PairScaling,
    PolynomialHamiltonian,
    PolynomialPortHamiltonian,
    Scaling,
)
from flexsurr.surrogates.mirrored_mass import Images
from flexsurr.surrogates.monomials import Exponents, monomials_to_degree
from flexsurr.surrogates.packed import pack, packed_size

SCALING = Scaling(q=0.6, p=6.0, energy=40.0)


def states(count: int) -> dict[str, tuple[str, ...]]:
    """Names and units of `count` states."""
    r = count // 2
    names = tuple(f"eta_{k}" for k in range(r)) + tuple(f"p_{k}" for k in range(r))
    return {"state_names": names, "state_units": ("1",) * r + ("kg m2/s",) * r}


def network(
    form: type[Network], count: int, hidden: tuple[int, ...], activation: str, seed: int = 0
) -> Network:
    """An MLP or HNN."""
    size = sum(int(np.prod(shape)) for shape in form.shapes(count, hidden))
    parameters = np.random.default_rng(seed).normal(size=size)
    return form(parameters, SCALING, **states(count), hidden=hidden, activation=activation)


def polynomial(count: int, degree: int, kind: str = "all", seed: int = 0) -> PolynomialHamiltonian:
    """A polynomial with all terms, or those of a mechanical system, or the even ones of those."""
    exponents: Exponents = monomials_to_degree(count, degree)
    in_q, in_p = exponents[:, : count // 2].sum(axis=1), exponents[:, count // 2 :].sum(axis=1)
    if kind != "all":
        kept = (in_p == 0) | (in_p == 2)
        exponents = exponents[kept & (in_q % 2 == 0)] if kind == "even" else exponents[kept]
    coefficients = np.random.default_rng(seed).normal(size=len(exponents))
    return PolynomialHamiltonian(coefficients, SCALING, **states(count), exponents=exponents)


def even_network(count: int, neurons: int, activation: str, seed: int = 0) -> EvenHNN:
    """A network of products."""
    size = sum(math.prod(shape) for shape in EvenHNN.shapes(count, neurons))
    parameters = np.random.default_rng(seed).normal(size=size)
    return EvenHNN(parameters, SCALING, **states(count), hidden=(neurons,), activation=activation)


HAMILTONIANS = {
    "one layer": network(HNN, 2, (9,), "softplus"),
    "two layers": network(HNN, 2, (7, 5), "half_log"),
    "three pairs": network(HNN, 6, (11,), "tanh"),
    "polynomial": polynomial(4, 5),
    "mechanical": polynomial(2, 7, "mechanical"),
    "even": polynomial(2, 8, "even"),
    "even network": even_network(2, 5, "half_log"),
    "even network of three pairs": even_network(6, 7, "softplus"),
}
PAIRS = PairScaling(q=(0.6, 2.0, 0.1), action=3.6, energy=40.0)


def pair_scaling(count: int) -> PairScaling:
    """Different scales for each of up to three pairs."""
    return replace(PAIRS, q=PAIRS.q[: count // 2])


def port_polynomial(
    count: int, degree: int, even: bool, seed: int = 0, spread: float = 0.02
) -> PolynomialPortHamiltonian:
    """M near the identity, K positive definite, C of rank r − 1 (one pair: positive)."""
    generator, r = np.random.default_rng(seed), count // 2
    exponents: Exponents = np.concatenate([np.zeros((1, r), dtype=np.int64), monomials_to_degree(r, degree)])
    exponents = exponents[exponents.sum(axis=1) % 2 == 0] if even else exponents
    mass = spread * generator.normal(size=(packed_size(r), len(exponents)))
    mass[:, 0] += pack(np.eye(r))
    springs = generator.normal(size=(r, r))
    dampers = pack(np.tril(generator.normal(size=(r, r))))
    dampers[-1] = 0.0 if r > 1 else 0.4
    parameters = np.concatenate([mass.ravel(), pack(springs @ springs.T), dampers])
    return PolynomialPortHamiltonian(parameters, pair_scaling(count), **states(count), exponents=exponents)


def port_network(
    count: int, neurons: int, activation: str, seed: int = 0, even: bool = False, factored: bool = True
) -> NetworkPortHamiltonian:
    """Any weights and a floor of a tenth of the identity and more; of entries small ones and all of it."""
    generator, r = np.random.default_rng(seed), count // 2
    size = sum(math.prod(shape) for shape in NetworkPortHamiltonian.shapes(r, neurons, even))
    floor = pack((0.1 if factored else 1.0) * np.eye(r) + 0.01)
    return NetworkPortHamiltonian(
        (0.5 if factored else 0.1) * generator.normal(size=size),
        pair_scaling(count),
        **states(count),
        floor=floor,
        even=even,
        hidden=(neurons,),
        activation=activation,
        factored=factored,
    )


PLANES = np.array([[1.0, -1.0, -1.0], [-1.0, 1.0, -1.0]])
"""Two planes of symmetry of three coordinates, as bending out of plane, in plane and torsion have them."""


def sparse_polynomial(seed: int = 0) -> PolynomialPortHamiltonian:
    """One of degree 8 with those planes, of whose monomials many are missing in all of M."""
    whole = port_polynomial(6, 8, even=False, seed=seed)
    flips = (PLANES < 0.0).astype(int)
    rows, columns = np.tril_indices(3)
    of_entries = (flips[:, rows] + flips[:, columns]) % 2
    fits = np.all((whole.exponents @ flips.T % 2)[None] == of_entries.T[:, None], axis=2)
    fits &= whole.exponents.max(axis=1) < 4
    size = fits.size
    parameters = np.concatenate([whole.parameters[:size] * fits.ravel(), whole.parameters[size:]])
    return replace(whole, parameters=parameters)


def mirrored_network(neurons: int, activation: str, seed: int = 0) -> NetworkPortHamiltonian:
    """So many neurons with their images in those planes."""
    generator, images = np.random.default_rng(seed), Images.of(PLANES)
    weights, biases, readout = images.of_neurons(
        generator.normal(size=(3, neurons)),
        generator.normal(size=neurons),
        0.05 * generator.normal(size=(neurons, 6)),
    )
    constants = np.where(images.of_entries == 0, 0.1 * generator.normal(size=6), 0.0)
    others = 0.1 * generator.normal(size=12)
    parts = weights, biases, readout.T, constants, others
    return NetworkPortHamiltonian(
        np.concatenate([part.ravel() for part in parts]),
        pair_scaling(6),
        **states(6),
        floor=pack(np.eye(3)),
        even=False,
        hidden=(4 * neurons,),
        activation=activation,
        factored=False,
        mirrors=PLANES,
    )


PORT_HAMILTONIANS = {
    "one pair": port_polynomial(2, 3, even=False),
    "one even pair": port_polynomial(2, 8, even=True),
    "even": port_polynomial(6, 4, even=True),
    "odd and even": port_polynomial(6, 3, even=False),
    "network of one pair": port_network(2, 5, "softplus"),
    "network": port_network(6, 7, "softplus"),
    "even network": port_network(6, 5, "softplus", even=True),
    "entries": port_network(6, 5, "softplus", factored=False),
    "even entries": port_network(6, 5, "softplus", even=True, factored=False),
    "sparse": sparse_polynomial(),
    "mirrored": mirrored_network(5, "atan"),
}
"""Networks of one activation, so that all have the machine code of one kernel."""

NETWORKS = {"hnn": HNN, "mlp": MLP, "dissipative_hnn": DissipativeHNN}
