"""Surrogates with random weights."""

import numpy as np

from flexsurr.surrogates import HNN, MLP, DissipativeHNN, Network, PolynomialHamiltonian, Scaling
from flexsurr.surrogates.monomials import Exponents, monomials_to_degree

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


HAMILTONIANS = {
    "one layer": network(HNN, 2, (9,), "softplus"),
    "two layers": network(HNN, 2, (7, 5), "half_log"),
    "three pairs": network(HNN, 6, (11,), "tanh"),
    "polynomial": polynomial(4, 5),
    "mechanical": polynomial(2, 7, "mechanical"),
    "even": polynomial(2, 8, "even"),
}
NETWORKS = {"hnn": HNN, "mlp": MLP, "dissipative_hnn": DissipativeHNN}
