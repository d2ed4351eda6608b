"""Polynomial Hamiltonian: linear in its coefficients, the baseline to hold networks against."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from flexsurr.simulation.dimension import LANES
from flexsurr.simulation.jacobian import implements_jacobian
from flexsurr.simulation.rhs import Array, implements_rhs
from flexsurr.simulation.side_by_side import implements_rhs_of_block
from flexsurr.surrogates.layers import offset
from flexsurr.surrogates.monomials import Exponents, differentiate, evaluate_monomials, products
from flexsurr.surrogates.surrogate import Surrogate, symplectic

_LEAST = 3
"""Coefficients that Horner's scheme takes without a loop."""


@dataclass(frozen=True, eq=False)
class PolynomialHamiltonian(Surrogate):
    """q̇ = ∂H/∂p, ṗ = −∂H/∂q with H = Σ c_i q^α_i p^β_i of scaled states; `exponents` (count, 2r).

    Any set of monomials. Where there is one pair (q, p) and H = ½ p² w(q) + V(q), the compiled form
    is Horner's scheme, in q² if no odd power of q occurs; else a table of monomials.
    """

    exponents: Exponents

    architecture: ClassVar[str] = "polynomial"

    def __post_init__(self) -> None:
        shape = self.exponents.shape
        if len(shape) != 2 or shape[1] != len(self.state_names) or self.exponents.min(initial=0) < 0:
            raise ValueError(f"exponents must be whole numbers ≥ 0, a column for each state, not {shape}")
        super().__post_init__()

    @property
    def parameter_count(self) -> int:
        """One coefficient a monomial."""
        return len(self.exponents)

    @property
    def degree(self) -> int:
        """Highest total degree."""
        return int(self.exponents.sum(axis=1).max(initial=0))

    @cached_property
    def _gradient(self) -> tuple[Exponents, Array]:
        """The monomials of ∇Ĥ and their coefficients (2r, count)."""
        lower, tensor = differentiate(self.exponents)
        return lower, tensor @ self.parameters

    def scaled_energy(self, x: Array) -> Array:
        """Ĥ of scaled states, (..., 2r) -> (...); zero at the origin."""
        return evaluate_monomials(self.exponents, x) @ self.parameters

    def scaled_field(self, x: Array) -> Array:
        """Hamilton's equations of Ĥ."""
        lower, coefficients = self._gradient
        return symplectic(evaluate_monomials(lower, x) @ coefficients.T)

    def energy(self, x: Array) -> Array:
        """H(x) − H(0), (..., 2r) -> (...), in the product of the units of q and p per second."""
        return self.scaling.energy * self.scaled_energy(x / self.scaling.states(len(self.state_names)))

    def kernel(self) -> tuple[NamedTuple, int]:
        """Horner's scheme where it applies, else a table of monomials."""
        if self.exponents.shape[1] == 2 and set(self.exponents[:, 1].tolist()) <= {0, 2}:
            return self._oscillator(), 0
        lower, coefficients = self._gradient
        count = len(self.state_names)
        parents, variables = products(lower)
        unscaled = symplectic(coefficients.T).T * self.scaling.rates(count)[:, None]
        unscaled /= evaluate_monomials(lower, self.scaling.states(count))
        # of the right-hand side the monomials; its Jacobian needs their slopes too
        return PolynomialKernel(parents, variables, unscaled.ravel()), 2 * len(lower)

    def _oscillator(self) -> "OscillatorPolynomial":
        step = 1 if np.any(self.exponents[:, 0] % 2) else 2
        table = np.zeros((3, int(self.exponents[:, 0].max(initial=0)) // step + 1))
        of_q, of_p = self.scaling.states(2)
        for (i, j), coefficient in zip(self.exponents.tolist(), self.parameters.tolist(), strict=True):
            k = i // step
            c = coefficient * self.scaling.energy / of_q**i / of_p**j
            if j == 2:
                table[0, k] += 2.0 * c
            if k > 0:
                table[1 if j == 2 else 2, k - 1] += k * c
        used = max(int(np.flatnonzero(table.any(axis=0)).max(initial=0)) + 1, _LEAST)
        table = np.pad(table, [(0, 0), (0, max(used - table.shape[1], 0))])
        return OscillatorPolynomial(float(step), *(row[:used].copy() for row in table))

    def settings(self) -> dict[str, Any]:
        """Nothing: the exponents are saved as an array."""
        return {}

    def arrays_to_keep(self) -> dict[str, np.ndarray]:
        """Coefficients and exponents."""
        return {**super().arrays_to_keep(), "exponents": self.exponents}


class OscillatorPolynomial(NamedTuple):
    """H = ½ p² w(s) + V(s), s = q (`step` 1) or q² (`step` 2): coefficients, lowest first, (n ≥ 3,) each."""

    step: float
    w: Array
    half_dw_ds: Array
    dv_ds: Array


@implements_rhs(OscillatorPolynomial)
def _oscillator_polynomial(kernel, t, x, dx, work):
    step, w, half_dw_ds, dv_ds = kernel
    q, p = x[0], x[1]
    s = q if step == 1.0 else q * q
    ds_dq = 1.0 if step == 1.0 else 2.0 * q
    n = w.size
    inverse_mass, kinetic, potential = w[n - 1], half_dw_ds[n - 1], dv_ds[n - 1]
    for k in range(n - 2, 1, -1):
        inverse_mass = inverse_mass * s + w[k]
        kinetic = kinetic * s + half_dw_ds[k]
        potential = potential * s + dv_ds[k]
    # the lowest terms without a loop, which would cost as much as they
    inverse_mass = (inverse_mass * s + w[1]) * s + w[0]
    kinetic = (kinetic * s + half_dw_ds[1]) * s + half_dw_ds[0]
    potential = (potential * s + dv_ds[1]) * s + dv_ds[0]
    dx[0] = inverse_mass * p
    dx[1] = -ds_dq * (p * p * kinetic + potential)


@implements_jacobian(OscillatorPolynomial)
def _jacobian_of_oscillator(kernel, t, x, dx, jac, work):
    step, w, half_dw_ds, dv_ds = kernel
    q, p = x[0], x[1]
    s = q if step == 1.0 else q * q
    ds_dq = 1.0 if step == 1.0 else 2.0 * q
    # Horner's scheme for the three, and for the slopes of the last two
    inverse_mass = kinetic = potential = slope_of_kinetic = slope_of_potential = 0.0
    for k in range(w.size - 1, -1, -1):
        inverse_mass = inverse_mass * s + w[k]
        slope_of_kinetic = slope_of_kinetic * s + kinetic
        kinetic = kinetic * s + half_dw_ds[k]
        slope_of_potential = slope_of_potential * s + potential
        potential = potential * s + dv_ds[k]
    jac[0, 0] = 2.0 * p * kinetic * ds_dq
    jac[0, 1] = inverse_mass
    jac[1, 0] = -ds_dq * ds_dq * (p * p * slope_of_kinetic + slope_of_potential)
    if step != 1.0:
        jac[1, 0] -= 2.0 * (p * p * kinetic + potential)
    jac[1, 1] = -jac[0, 0]
    return 0


@implements_rhs_of_block(OscillatorPolynomial, rows=1)
def _block_of_oscillators(kernel, t, x, dx, work):
    step, w, half_dw_ds, dv_ds = kernel
    n = w.size
    w_0, w_1, w_2 = w[0], w[1], w[2]
    kinetic_0, kinetic_1, kinetic_2 = half_dw_ds[0], half_dw_ds[1], half_dw_ds[2]
    potential_0, potential_1, potential_2 = dv_ds[0], dv_ds[1], dv_ds[2]
    if n == _LEAST:
        # all of it in registers
        for b in range(LANES):
            q, p = x[b], x[LANES + b]
            s = q if step == 1.0 else q * q
            ds_dq = 1.0 if step == 1.0 else 2.0 * q
            kinetic = (kinetic_2 * s + kinetic_1) * s + kinetic_0
            potential = (potential_2 * s + potential_1) * s + potential_0
            dx[b] = ((w_2 * s + w_1) * s + w_0) * p
            dx[LANES + b] = -ds_dq * (p * p * kinetic + potential)
        return
    # the inverse mass and the potential in the places of their rates, the kinetic part in the scratch
    upper_w, upper_kinetic, upper_potential = w[n - 1], half_dw_ds[n - 1], dv_ds[n - 1]
    begun = n - 2
    if n % 2 == 0:  # two terms at a time, half the loads and stores, want an odd number
        upper_w = upper_kinetic = upper_potential = 0.0
        begun = n - 1
    lower_w, lower_kinetic, lower_potential = w[begun], half_dw_ds[begun], dv_ds[begun]
    for b in range(LANES):
        s = x[b] if step == 1.0 else x[b] * x[b]
        dx[b] = upper_w * s + lower_w
        work[b] = upper_kinetic * s + lower_kinetic
        dx[LANES + b] = upper_potential * s + lower_potential
    for k in range(begun - 1, _LEAST, -2):
        upper_w, lower_w = w[k], w[k - 1]
        upper_kinetic, lower_kinetic = half_dw_ds[k], half_dw_ds[k - 1]
        upper_potential, lower_potential = dv_ds[k], dv_ds[k - 1]
        for b in range(LANES):
            s = x[b] if step == 1.0 else x[b] * x[b]
            dx[b] = (dx[b] * s + upper_w) * s + lower_w
            work[b] = (work[b] * s + upper_kinetic) * s + lower_kinetic
            dx[LANES + b] = (dx[LANES + b] * s + upper_potential) * s + lower_potential
    for b in range(LANES):
        q, p = x[b], x[LANES + b]
        s = q if step == 1.0 else q * q
        ds_dq = 1.0 if step == 1.0 else 2.0 * q
        inverse_mass = ((dx[b] * s + w_2) * s + w_1) * s + w_0
        kinetic = ((work[b] * s + kinetic_2) * s + kinetic_1) * s + kinetic_0
        potential = ((dx[LANES + b] * s + potential_2) * s + potential_1) * s + potential_0
        dx[b] = inverse_mass * p
        dx[LANES + b] = -ds_dq * (p * p * kinetic + potential)


class PolynomialKernel(NamedTuple):
    """ẋ_i = Σ_k c_ik m_k, m_0 = 1 and m_k+1 = m_parent[k] x_variable[k]; `coefficients` row by row."""

    parents: NDArray[np.int64]
    variables: NDArray[np.int64]
    coefficients: Array


@implements_rhs(PolynomialKernel, inline=False)
def _polynomial(kernel, t, x, dx, work):
    parents, variables, coefficients = kernel
    work[0] = 1.0
    for k in range(parents.size):
        work[k + 1] = work[parents[k]] * x[variables[k]]
    count = offset(parents.size + 1)
    for i in range(x.size):
        row = offset(i) * count
        total = 0.0
        for k in range(count):
            total += coefficients[row + k] * work[k]
        dx[i] = total


@implements_jacobian(PolynomialKernel)
def _jacobian_of_polynomial(kernel, t, x, dx, jac, work):
    parents, variables, coefficients = kernel
    count = parents.size + 1
    work[0] = 1.0
    work[count] = 0.0  # slopes follow the monomials
    for k in range(parents.size):
        work[k + 1] = work[parents[k]] * x[variables[k]]
    for j in range(x.size):
        for k in range(parents.size):
            slope = work[count + parents[k]] * x[variables[k]]
            work[count + k + 1] = slope + work[parents[k]] if variables[k] == j else slope
        for i in range(x.size):
            row, first = offset(i * count), offset(count)
            total = 0.0
            for k in range(first):
                total += coefficients[row + k] * work[first + k]
            jac[i, j] = total
    return 0
