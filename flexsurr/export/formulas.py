"""The scaled field and energy of each surrogate, and the outputs of a learned map, as expressions."""

from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from flexsurr.export.expressions import Value, activation, concat, constant, solve, take
from flexsurr.export.from_program import outputs_of
from flexsurr.simulation.rhs import Array
from flexsurr.surrogates import (
    HNN,
    MLP,
    DissipativeHNN,
    EvenHNN,
    LearnedMap,
    NetworkMap,
    NetworkPortHamiltonian,
    PolynomialHamiltonian,
    PolynomialMap,
    PolynomialPortHamiltonian,
    PortHamiltonian,
    Surrogate,
)
from flexsurr.surrogates.monomials import Exponents, differentiate
from flexsurr.surrogates.packed import rows_and_columns


class NotExported(ValueError):
    """A surrogate that has no form outside of Python; the message says why."""


def scaled_field(surrogate: Surrogate, x: Value) -> tuple[Value, Value | None]:
    """The scaled rates (2r,) and the scaled energy, up to a constant, at scaled states `x` (2r,).

    The energy is None where the surrogate has none, or it is a torch module's. Raises NotExported for a
    torch module that does what a program cannot.
    """
    if isinstance(surrogate, MLP):
        return _mlp(surrogate, x), None
    if isinstance(surrogate, HNN):
        energy, gradient = _scalar_network(surrogate, 0, x)
        return _symplectic(gradient), energy
    if isinstance(surrogate, DissipativeHNN):
        energy, gradient = _scalar_network(surrogate, 0, x)
        _, dissipation = _scalar_network(surrogate, 1, x)
        return _symplectic(gradient) + dissipation, energy
    if isinstance(surrogate, EvenHNN):
        return _even_network(surrogate, x)
    if isinstance(surrogate, PolynomialHamiltonian):
        return _polynomial(surrogate, x)
    if isinstance(surrogate, PortHamiltonian):
        return _port_hamiltonian(surrogate, x)
    if surrogate.architecture == "torch":
        # no import of its class: torch takes seconds to import, and no other surrogate needs it
        own = cast(Any, surrogate)
        if own.program is None:
            raise NotExported(f"{own.source.network} runs in torch alone: {own.exported}")
        return outputs_of(own.program, x), None
    raise NotExported(f"there are no expressions of the architecture {surrogate.architecture}")


def monomials(exponents: Exponents, x: Value) -> Value:
    """The monomials (count, d) at `x` (d,), shape (count,): degree by degree, each from one below it."""
    closed = {(0,) * exponents.shape[1]}
    for row in map(tuple, exponents.tolist()):
        while row not in closed:
            closed.add(row)
            row = _parent(row)[0]
    by_degree = sorted(closed, key=lambda row: (sum(row), row))
    place = {row: k for k, row in enumerate(by_degree)}
    levels, first = [constant([1.0])], 0
    for degree in range(1, int(exponents.sum(axis=1).max(initial=0)) + 1):
        parents = [_parent(row) for row in by_degree if sum(row) == degree]
        below = [place[row] - first for row, _ in parents]
        first += levels[-1].size
        levels.append(take(levels[-1], below) * take(x, [variable for _, variable in parents]))
    return take(concat(levels), [place[row] for row in map(tuple, exponents.tolist())])


def _parent(row: tuple[int, ...]) -> tuple[tuple[int, ...], int]:
    """A monomial over its last variable, and that variable."""
    variable = max(j for j, power in enumerate(row) if power)
    return (*row[:variable], row[variable] - 1, *row[variable + 1 :]), variable


def _symplectic(gradient: Value) -> Value:
    r = gradient.size // 2
    return concat([gradient[r:], -gradient[:r]])


def _mlp(surrogate: MLP, x: Value) -> Value:
    sigma, _ = activation(surrogate.activation)
    *layers, weights_out, biases_out = surrogate.arrays()
    for weights, biases in zip(layers[::2], layers[1::2], strict=True):
        x = sigma(x @ weights + biases)
    return x @ weights_out + biases_out


def _scalar_network(surrogate: HNN | DissipativeHNN, number: int, x: Value) -> tuple[Value, Value]:
    """The scalar and its gradient, as `ScalarNetworks` has them."""
    sigma, sigma_slope = activation(surrogate.activation)
    *layers, readout = surrogate.network_arrays(number)
    slopes: list[Value] = []
    z = x @ layers[0] + layers[1]
    for weights, biases in zip(layers[2::2], layers[3::2], strict=True):
        slopes.append(sigma_slope(z))
        z = sigma(z) @ weights + biases
    gradient = (sigma_slope(z) * readout) @ layers[-2].T
    for weights, before in zip(layers[-4::-2], reversed(slopes), strict=True):
        gradient = (gradient * before) @ weights.T
    return sigma(z) @ readout, gradient


def _even_network(surrogate: EvenHNN, x: Value) -> tuple[Value, Value]:
    sigma, sigma_slope = activation(surrogate.activation)
    weights, biases, readout = surrogate.arrays()
    r = x.size // 2
    rows, columns = rows_and_columns(r)
    halves = x[:r], x[r:]
    z = concat([take(half, rows) * take(half, columns) for half in halves]) @ weights + biases
    by_products = (sigma_slope(z) * readout) @ weights.T
    parts = by_products[: len(rows)], by_products[len(rows) :]
    gradient = concat([_by_factors(part, half) for part, half in zip(parts, halves, strict=True)])
    return _symplectic(gradient), sigma(z) @ readout


def _by_factors(by_products: Value, x: Value) -> Value:
    """Derivatives by `x` (r,) of what has these derivatives by the packed products x_i x_j."""
    result: Value = (take(by_products, _packed_places(x.size)) * (1.0 + np.eye(x.size))) @ x
    return result


def _polynomial(surrogate: PolynomialHamiltonian, x: Value) -> tuple[Value, Value]:
    lower, tensor = differentiate(surrogate.exponents)
    gradient = monomials(lower, x) @ (tensor @ surrogate.parameters).T
    return _symplectic(gradient), monomials(surrogate.exponents, x) @ surrogate.parameters


def _port_hamiltonian(surrogate: PortHamiltonian, x: Value) -> tuple[Value, Value]:
    """The field with ½ ∂/∂q (q̇ᵀ M q̇), by the adjoint of M at constant q̇, in place of all of ∂M/∂q."""
    r = surrogate.pairs
    q, p = x[:r], x[r:]
    if isinstance(surrogate, NetworkPortHamiltonian):
        mass, gyroscopic = _network_mass(surrogate, q)
    elif isinstance(surrogate, PolynomialPortHamiltonian):
        mass, gyroscopic = _polynomial_mass(surrogate, q)
    else:
        raise NotExported(f"there are no expressions of the mass matrix of {type(surrogate).__name__}")
    rates = solve(mass, p)
    springs = q @ surrogate.scaled_stiffness
    forces = gyroscopic(rates) - springs - rates @ surrogate.scaled_damping
    energy = 0.5 * (p * rates).sum() + 0.5 * (q * springs).sum()
    if surrogate.potential is not None:
        lower, coefficients = surrogate.potential.gradient_terms
        forces = forces - monomials(lower, q) @ coefficients
        energy = energy + monomials(surrogate.potential.exponents, q) @ surrogate.potential.coefficients
    return concat([rates, forces]), energy


def _network_mass(surrogate: NetworkPortHamiltonian, q: Value) -> tuple[Value, Any]:
    r = surrogate.pairs
    rows, columns = rows_and_columns(r)
    sigma, sigma_slope = activation(surrogate.activation)
    weights, biases, readout, own, *_ = surrogate.arrays()
    inputs = take(q, rows) * take(q, columns) if surrogate.even else q
    z = inputs @ weights + biases
    packed = own + sigma(z) @ readout.T
    # the triangle by its places in the packed entries, 0 after them
    places = np.full((r, r), len(rows))
    places[rows, columns] = np.arange(len(rows))
    factor = take(concat([packed, [0.0]]), places)

    def gyroscopic(rates: Value) -> Value:
        # Σ q̇_i (Lᵀ q̇)_j ∂L_ij/∂q, or of the entries Σ ½ q̇_i q̇_j ∂E_ij/∂q
        if surrogate.factored:
            of_entries = take(rates, rows) * take(rates @ factor, columns)
        else:
            of_entries = _halves_of_squares(rates)
        by_inputs: Value = ((of_entries @ readout) * sigma_slope(z)) @ weights.T
        return _by_factors(by_inputs, q) if surrogate.even else by_inputs

    found = factor @ factor.T if surrogate.factored else take(packed, _packed_places(r))
    return take(constant(surrogate.floor), _packed_places(r)) + found, gyroscopic


def _halves_of_squares(rates: Value) -> Value:
    """What each packed entry of a symmetric matrix S is multiplied by in ½ q̇ᵀ S q̇."""
    rows, columns = rows_and_columns(rates.size)
    result: Value = take(rates, rows) * take(rates, columns) * np.where(rows == columns, 0.5, 1.0)
    return result


def _polynomial_mass(surrogate: PolynomialPortHamiltonian, q: Value) -> tuple[Value, Any]:
    r, exponents, entries = surrogate.pairs, surrogate.exponents, surrogate.packed_size
    coefficients = surrogate.parameters[: -2 * entries].reshape(entries, -1)
    lower, places, powers = _lowered(exponents)

    def gyroscopic(rates: Value) -> Value:
        weights = _halves_of_squares(rates) @ coefficients
        return (take(monomials(lower, q), places) * powers) @ weights

    packed = monomials(exponents, q) @ coefficients.T
    return take(packed, _packed_places(r)), gyroscopic


def _lowered(exponents: Exponents) -> tuple[Exponents, NDArray[np.int64], Array]:
    """∂(monomial m)/∂q_k is powers[k, m] times the monomial places[k, m] of the first."""
    lower, tensor = differentiate(exponents)  # (d, lower, count), one entry at most for each k and m
    return lower, np.abs(tensor).argmax(axis=1), tensor.sum(axis=1)


def _packed_places(r: int) -> NDArray[np.int64]:
    """The packed entry of each of (r, r)."""
    i, j = np.indices((r, r))
    high, low = np.maximum(i, j), np.minimum(i, j)
    return np.asarray(high * (high + 1) // 2 + low, dtype=np.int64)


def outputs_of_map(learned: LearnedMap, u: Value) -> Value:
    """The outputs (k,) at inputs `u` (n,), both in their units. Raises NotExported for a foreign map."""
    scaled = (u - learned.inputs.origin) * (1.0 / learned.inputs.half)
    if isinstance(learned, PolynomialMap):
        return monomials(learned.exponents, scaled) @ learned.coefficients
    if isinstance(learned, NetworkMap):
        return _network(learned, scaled)
    raise NotExported(f"there are no expressions of a map of the kind {learned.kind}")


def _network(learned: NetworkMap, scaled: Value) -> Value:
    sigma, _ = activation(learned.activation)
    weights, biases, weights_out, biases_out = learned.layers()
    if learned.products:
        first, second = np.array(learned.products).T
        scaled = concat([scaled, take(scaled, first) * take(scaled, second)])
    outputs: Value = sigma(scaled @ weights + biases) @ weights_out + biases_out
    return outputs * learned.outputs.half + learned.outputs.origin
