"""Port-Hamiltonian surrogate whose mass matrix is F + E(q) or F + L(q) L(q)ᵀ, E or L from a network."""

from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from numba import njit

from flexsurr.simulation.jacobian import implements_jacobian
from flexsurr.simulation.linear_solvers import invert_packed, solve_packed
from flexsurr.simulation.rhs import Array, implements_rhs
from flexsurr.surrogates.activations import ActivationFunction, activation_function, curvature, slope, value
from flexsurr.surrogates.layers import (
    Dense,
    Shapes,
    forward,
    layer_shapes,
    offset,
    read,
    size_of,
    views,
    write_products,
)
from flexsurr.surrogates.mirrored_mass import Images, mirrored_kernel
from flexsurr.surrogates.packed import OPTIONS, lower, pack, packed_size, rows_and_columns, symmetric
from flexsurr.surrogates.port_hamiltonian import PortHamiltonian, jacobian_of_motion, springs_and_dampers


@dataclass(frozen=True, eq=False)
class NetworkPortHamiltonian(PortHamiltonian):
    """Λ + Σ_k R_k σ(w_k · s + b_k) is L, lower triangular, or E, symmetric; Ĉ and K̂ are constant products.

    The inputs s are the coordinates q̂, or if `even` their packed products: then M(−q) = M(q), as it is for a
    structure that is its own mirror image. `floor` is the packed F, positive definite and not trained. If
    `factored`, M = F + L Lᵀ is positive definite everywhere and H ≥ 0. Otherwise M = F + E, which is far more
    accurate, for the entries of a mass matrix are smoother functions of q than those of its factor; but
    nothing binds it to be positive definite where it was not trained. `parameters`: weights (inputs, n),
    biases (n,), R (entries, n), Λ (entries,), the factors of K̂ and Ĉ.

    With `mirrors` (k, r), planes of symmetry by the signs of the coordinates, the n neurons are n / 2ᵏ with
    all of their images beside them, as `Images.of_neurons` makes them, and M has those symmetries.
    """

    floor: Array
    even: bool
    hidden: tuple[int, ...]
    activation: str
    factored: bool = True
    mirrors: Array | None = field(default=None, kw_only=True)

    def __post_init__(self) -> None:
        if len(self.hidden) != 1 or self.hidden[0] < 1:
            raise ValueError(f"a port-Hamiltonian network takes one hidden layer, not {self.hidden}")
        activation_function(self.activation)  # refuses what is none
        if self.floor.shape != (self.packed_size,):
            raise ValueError(f"the floor of M has {self.packed_size} entries, not shape {self.floor.shape}")
        if np.min(np.linalg.eigvalsh(symmetric(self.floor, self.pairs))) <= 0.0:
            raise ValueError("the floor of M must be positive definite")
        super().__post_init__()

    @classmethod
    def shapes(cls, pairs: int, neurons: int, even: bool) -> Shapes:
        """Shapes of the arrays in `parameters`, in their order."""
        entries = packed_size(pairs)
        layer = layer_shapes((entries if even else pairs, neurons))
        return [*layer, (entries, neurons), (entries,), (entries,), (entries,)]

    @property
    def parameter_count(self) -> int:
        """Weights, biases and constant entries."""
        return size_of(self.shapes(self.pairs, self.hidden[0], self.even))

    @property
    def sigma(self) -> ActivationFunction:
        """The activation function."""
        return activation_function(self.activation)

    def arrays(self) -> list[Array]:
        """Views of the parameters in their shapes."""
        return views(self.parameters, self.shapes(self.pairs, self.hidden[0], self.even))

    @property
    def scaled_stiffness(self) -> Array:
        """K̂ (r, r)."""
        factor = lower(self.arrays()[4], self.pairs)
        return factor @ factor.T

    @property
    def scaled_damping(self) -> Array:
        """Ĉ (r, r)."""
        factor = lower(self.arrays()[5], self.pairs)
        return factor @ factor.T

    def inputs(self, q: Array) -> tuple[Array, Array]:
        """The inputs s (..., i) and their derivatives by q̂_j (..., j, i)."""
        if not self.even:
            return q, np.broadcast_to(np.eye(self.pairs), (*q.shape, self.pairs))
        rows, columns = np.tril_indices(self.pairs)
        identity = np.eye(self.pairs)
        by_q = q[..., None, rows] * identity[:, columns] + q[..., None, columns] * identity[:, rows]
        return q[..., rows] * q[..., columns], by_q

    def _network(self, q: Array) -> tuple[Array, Array]:
        """L or E (..., r, r), and its derivatives by q̂_k (..., r, r, r), k first."""
        weights, biases, readout, constant, *_ = self.arrays()
        inputs, turned = self.inputs(q)
        dense = Dense(self.sigma, (weights, biases), readout.T, constant)
        derivatives = turned @ np.swapaxes(dense.jacobian(inputs), -1, -2)
        unpacked = lower if self.factored else symmetric
        return unpacked(dense(inputs), self.pairs), unpacked(derivatives, self.pairs)

    def scaled_mass(self, q: Array) -> Array:
        """M̂ at scaled coordinates, (..., r) -> (..., r, r)."""
        found, _ = self._network(q)
        if self.factored:
            found = found @ np.swapaxes(found, -1, -2)
        return symmetric(self.floor, self.pairs) + found

    def scaled_mass_derivatives(self, q: Array) -> Array:
        """∂M̂/∂q̂_k, (..., r) -> (..., r, r, r) with k first."""
        factor, derivatives = self._network(q)
        if not self.factored:
            return derivatives
        half = derivatives @ np.swapaxes(factor, -1, -2)[..., None, :, :]
        gradient: Array = half + np.swapaxes(half, -1, -2)
        return gradient

    def own_kernel(self) -> tuple[NamedTuple, int]:
        """One sweep through the neurons forwards and one back, and a small system."""
        _, of_q, of_p, of_rates = self.scales()
        weights, biases, readout, constant, *_ = self.arrays()
        # M = S (F + …) S with S = √(s_p / s_q̇), which a canonical scaling makes one number for each pair
        rows, columns = np.tril_indices(self.pairs)
        roots = np.sqrt(of_p / of_rates)
        of_entries = roots[rows] if self.factored else roots[rows] * roots[columns]
        of_inputs, _ = self.inputs(of_q)
        if self.mirrors is not None:
            return self._mirrored_kernel(self.mirrors, roots)
        layer = np.concatenate([(weights / of_inputs[:, None]).ravel(), biases])
        kernel = NetworkPortHamiltonianKernel(
            self.sigma.tag,
            layer,
            (readout * of_entries[:, None]).ravel(),
            constant * of_entries,
            pack(symmetric(self.floor, self.pairs) * np.outer(roots, roots)),
            np.ascontiguousarray(self.stiffness).ravel(),
            np.ascontiguousarray(self.damping).ravel(),
            self.even,
            self.factored,
        )
        r, n, entries = self.pairs, self.hidden[0], self.packed_size
        # of the right-hand side 3 (n + entries + r); its Jacobian needs more
        return kernel, (5 + r) * n + 4 * entries + r + 4 * r * r

    def _mirrored_kernel(self, mirrors: Array, roots: Array) -> tuple[NamedTuple, int]:
        """The same of neurons with their images, which are read together; `roots` (r,) are those of S."""
        images = Images.of(mirrors)
        weights, biases, readout, constant, *_ = self.arrays()
        h = self.hidden[0] // images.number
        _, of_q, *_ = self.scales()
        rows, columns = rows_and_columns(self.pairs)
        of_entries = roots[rows] * roots[columns]
        of_neurons = weights[:, :h] / of_q[:, None], biases[:h], readout[:, :h] * of_entries[:, None]
        constant = (constant + self.floor) * of_entries
        return mirrored_kernel(images, self.sigma.tag, of_neurons, constant, self.stiffness, self.damping)

    def settings(self) -> dict[str, Any]:
        """Hidden layer, activation, parity and what the network gives; the floor is saved as an array."""
        return {
            "hidden": list(self.hidden),
            "activation": self.activation,
            "even": self.even,
            "factored": self.factored,
        }

    def arrays_to_keep(self) -> dict[str, np.ndarray]:
        """Weights and floor, and mirrors if there are any."""
        kept = {**super().arrays_to_keep(), "floor": self.floor}
        return kept if self.mirrors is None else kept | {"mirrors": self.mirrors}


class NetworkPortHamiltonianKernel(NamedTuple):
    """`layer`: weights (inputs, n) and biases (n,); `readout` (entries, n); the rest packed or (r, r)."""

    activation: NamedTuple
    layer: Array
    readout: Array
    constant: Array
    floor: Array
    stiffness: Array
    damping: Array
    even: bool
    factored: bool


@njit(**OPTIONS)
def _write_inputs(even, x, r, work):
    """The inputs s at the start of `work`: q, or its packed products."""
    if even:
        write_products(x, offset(0), r, work, offset(0))
    else:
        for i in range(r):
            work[i] = x[i]


@njit(**OPTIONS)
def _write_mass(kernel, r, n, work, values, factor, matrix):
    """L or E at `factor`, of the n neurons' values, and the packed M at `matrix`."""
    readout, constant, floor, factored = kernel.readout, kernel.constant, kernel.floor, kernel.factored
    for e in range(offset(constant.size)):
        work[factor + e] = constant[e] + read(readout, e * n, work, values, n)
    e = offset(0)
    for i in range(r):
        row = factor + i * (i + offset(1)) // offset(2)
        for j in range(i + offset(1)):
            other = factor + j * (j + offset(1)) // offset(2)
            total = floor[e]
            if factored:
                for k in range(j + offset(1)):
                    total += work[row + k] * work[other + k]
            else:
                total += work[row + j]
            work[matrix + e] = total
            e += offset(1)


@implements_rhs(NetworkPortHamiltonianKernel, inline=False)
def _network_port_hamiltonian(kernel, t, x, dx, work):
    activation, layer, readout, constant, _, stiffness, damping, even, factored = kernel
    r = offset(x.size // 2)
    entries = offset(constant.size)
    n = offset(readout.size // constant.size)
    inputs = entries if even else r
    # work: s, then σ's arguments (later slopes), values, adjoints; L or E, M; q̇ and Lᵀ q̇; ∂/∂q
    z = inputs
    values = z + n
    adjoint = values + n
    factor = adjoint + n
    matrix = factor + entries
    rates = matrix + entries
    turned = rates + r
    _write_inputs(even, x, r, work)
    forward(layer, offset(0), inputs, n, work, offset(0), z)
    for k in range(n):
        work[values + k] = value(activation, work[z + k])
    for k in range(n):
        work[z + k] = slope(activation, work[z + k])
    _write_mass(kernel, r, n, work, values, factor, matrix)
    for i in range(r):
        work[rates + i] = x[r + i]
    solve_packed(work, np.int64(matrix), np.int64(rates), np.int64(r))
    for i in range(r):
        dx[i] = work[rates + i]
        work[turned + i] = 0.0
    e = factor
    for i in range(r):
        for j in range(i + offset(1)):
            work[turned + j] += work[e] * work[rates + i]
            e += offset(1)
    # ½ ∂/∂q (q̇ᵀ L Lᵀ q̇) = Σ q̇_i (Lᵀ q̇)_j ∂L_ij/∂q, or ½ ∂/∂q (q̇ᵀ E q̇) = Σ ½ q̇_i q̇_j ∂E_ij/∂q
    for k in range(n):
        work[adjoint + k] = 0.0
    e = offset(0)
    for i in range(r):
        for j in range(i + offset(1)):
            weight = work[rates + i] * work[(turned if factored else rates) + j]
            if not factored and i == j:
                weight *= 0.5
            row = e * n
            for k in range(n):
                work[adjoint + k] += weight * readout[row + k]
            e += offset(1)
    for k in range(n):
        work[adjoint + k] *= work[z + k]
    for i in range(r):
        dx[r + i] = 0.0
    e = offset(0)
    for i in range(r):
        for j in range(i + offset(1)):
            if even or i == j:
                row = (e if even else i) * n
                total = 0.0
                for k in range(n):
                    total += layer[row + k] * work[adjoint + k]
                if even:
                    dx[r + i] += total * x[j]
                    dx[r + j] += total * x[i]
                else:
                    dx[r + i] = total
            e += offset(1)
    springs_and_dampers(stiffness, damping, x, dx)


@implements_jacobian(NetworkPortHamiltonianKernel)
def _jacobian_of_network(kernel, t, x, dx, jac, work):
    activation, layer, readout, constant, _, stiffness, damping, even, factored = kernel
    r = offset(x.size // 2)
    entries = offset(constant.size)
    n = offset(readout.size // constant.size)
    inputs = entries if even else r
    # work: s, σ and its derivatives, adjoints of σ, ∂z/∂q_k; L or E, M; ∂L/∂q_k or
    # ∂E/∂q_k, Lᵀ q̇, (∂L/∂q_k)ᵀ q̇; M⁻¹, (∂M/∂q_k) q̇, curvature
    z = entries
    values = z + n
    slopes = values + n
    bends = slopes + n
    adjoint = bends + n
    by_q = adjoint + n
    factor = by_q + r * n
    matrix = factor + entries
    derivative = matrix + entries
    turned_rates = derivative + entries
    of_derivatives = turned_rates + r
    inverse = of_derivatives + r * r
    turned = inverse + r * r
    curved = turned + r * r
    _write_inputs(even, x, r, work)
    forward(layer, offset(0), inputs, n, work, offset(0), z)
    for k in range(n):
        work[values + k] = value(activation, work[z + k])
    for k in range(n):
        work[slopes + k] = slope(activation, work[z + k])
    for k in range(n):
        work[bends + k] = curvature(activation, work[z + k])
    for i in range(r * n):
        work[by_q + i] = 0.0
    e = offset(0)
    for i in range(r):
        for j in range(i + offset(1)):
            if even or i == j:
                row = (e if even else i) * n
                for k in range(n):
                    # of q_i q_j, by q_i and by q_j; of q_i alone
                    work[by_q + i * n + k] += layer[row + k] * (x[j] if even else 1.0)
                    if even:
                        work[by_q + j * n + k] += layer[row + k] * x[i]
            e += offset(1)
    _write_mass(kernel, r, n, work, values, factor, matrix)
    invert_packed(work, np.int64(matrix), np.int64(inverse), np.int64(r))
    for k in range(n):
        work[adjoint + k] = 0.0
    for i in range(r):
        work[turned_rates + i] = 0.0
    e = offset(0)
    for i in range(r):
        for j in range(i + offset(1)):
            work[turned_rates + j] += work[factor + e] * dx[i]
            e += offset(1)
    e = offset(0)
    for i in range(r):
        for j in range(i + offset(1)):
            weight = dx[i] * (work[turned_rates + j] if factored else dx[j])
            if not factored and i == j:
                weight *= 0.5
            for k in range(n):
                work[adjoint + k] += weight * readout[e * n + k]
            e += offset(1)
    # (∂M/∂q_m) q̇ = (∂L/∂q_m) Lᵀ q̇ + L (∂L/∂q_m)ᵀ q̇, or (∂E/∂q_m) q̇
    for m in range(r):
        for k in range(n):
            work[values + k] = work[slopes + k] * work[by_q + m * n + k]
        for e in range(entries):
            work[derivative + e] = read(readout, e * n, work, values, n)
        for i in range(r):
            work[of_derivatives + m * r + i] = 0.0
            work[turned + i * r + m] = 0.0
        e = offset(0)
        for i in range(r):
            for j in range(i + offset(1)):
                work[of_derivatives + m * r + j] += work[derivative + e] * dx[i]
                work[turned + i * r + m] += work[derivative + e] * (
                    work[turned_rates + j] if factored else dx[j]
                )
                if not factored and i != j:
                    work[turned + j * r + m] += work[derivative + e] * dx[i]
                e += offset(1)
        if factored:
            e = offset(0)
            for i in range(r):
                for j in range(i + offset(1)):
                    work[turned + i * r + m] += work[factor + e] * work[of_derivatives + m * r + j]
                    e += offset(1)
    # q̇ᵀ (∂²L/∂q_i ∂q_m) Lᵀ q̇ + (∂L/∂q_i)ᵀ q̇ · (∂L/∂q_m)ᵀ q̇, or ½ q̇ᵀ (∂²E/∂q_i ∂q_m) q̇
    e = offset(0)
    for m in range(r):
        for i in range(m + offset(1)):
            total = 0.0
            for k in range(n):
                bent = work[adjoint + k] * work[bends + k]
                total += bent * work[by_q + m * n + k] * work[by_q + i * n + k]
            if even:
                twice = 2.0 if i == m else 1.0
                for k in range(n):
                    total += twice * work[adjoint + k] * work[slopes + k] * layer[e * n + k]
            for j in range(r if factored else offset(0)):
                total += work[of_derivatives + m * r + j] * work[of_derivatives + i * r + j]
            work[curved + m * r + i] = total
            work[curved + i * r + m] = total
            e += offset(1)
    jacobian_of_motion(stiffness, damping, work, inverse, turned, curved, jac)
    return 0
