"""Residuals of a port-Hamiltonian network and their derivatives by its weights, in closed form and compiled.

Everything is in scaled states. Both kinds of residual are made of M(q) v and of

    f(q, v) = ½ ∂/∂q (vᵀ M v) − K q − C v

inverse: at the measured rates, M v − p and f − ṗ; linear in M, K and C.
forward: at the model's own rates v = M⁻¹ p, v − q̇ and f − ṗ: the errors of the field itself. Their
derivatives are those of M v and of f at fixed v, with δv = −M⁻¹ δ(M v).

The inputs s are the coordinates, or if `even` their packed products, as in `NetworkPortHamiltonian`.
"""

import numpy as np
from numba import njit

from flexsurr.simulation.rhs import FLOATING_POINT
from flexsurr.surrogates.activations import curvature, slope, value

OPTIONS = {"fastmath": FLOATING_POINT, "error_model": "numpy"}


@njit(**OPTIONS)
def _factor(parameters, first, r):
    """The lower triangular matrix packed at `first`."""
    matrix = np.zeros((r, r))
    for i in range(r):
        for j in range(i + 1):
            matrix[i, j] = parameters[first + i * (i + 1) // 2 + j]
    return matrix


@njit(**OPTIONS)
def _invert(matrix, inverse):
    """Inverse of a small positive definite matrix by Gauss–Jordan, which overwrites it."""
    r = len(matrix)
    for i in range(r):
        for j in range(r):
            inverse[i, j] = 1.0 if i == j else 0.0
    for k in range(r):
        pivot = 1.0 / matrix[k, k]
        for j in range(r):
            matrix[k, j] *= pivot
            inverse[k, j] *= pivot
        for i in range(r):
            if i != k:
                ratio = matrix[i, k]
                for j in range(r):
                    matrix[i, j] -= ratio * matrix[k, j]
                    inverse[i, j] -= ratio * inverse[k, j]


@njit(**OPTIONS)
def _accumulate(
    parameters,
    r,
    n,
    inputs,
    along,
    q,
    v,
    u,
    of_mass,
    of_forces,
    lt_mass,
    turned,
    springs,
    dampers,
    neurons,
    row,
    scale,
):
    """Write scale ∂(of_mass · M v + of_forces · f)/∂θ at fixed v into `row`.

    u = Lᵀ v; lt_mass = Lᵀ of_mass; turned[j, m] = Σ_a ∂_j L_am v_a; `neurons`: σ, σ′, σ″ (3, n); `along`
    is the tangent of the `inputs` in the direction of_forces.
    """
    entries = r * (r + 1) // 2
    biases = inputs.size * n
    readout = biases + n
    constant = readout + entries * n
    for k in range(n):
        tangent = 0.0
        for i in range(inputs.size):
            tangent += along[i] * parameters[i * n + k]
        of_value = 0.0
        of_slope = 0.0
        value_k = neurons[0, k]
        slope_k = neurons[1, k] * tangent
        e = 0
        for b in range(r):
            for m in range(b + 1):
                alpha = lt_mass[m]
                for j in range(r):
                    alpha += of_forces[j] * turned[j, m]
                alpha = of_mass[b] * u[m] + v[b] * alpha
                h = v[b] * u[m]
                place = readout + e * n + k
                row[place] = scale * (alpha * value_k + h * slope_k)
                of_value += alpha * parameters[place]
                of_slope += h * parameters[place]
                row[constant + e] = scale * alpha
                e += 1
        argument = scale * (of_value * neurons[1, k] + of_slope * neurons[2, k] * tangent)
        direct = scale * of_slope * neurons[1, k]
        row[biases + k] = argument
        for i in range(inputs.size):
            row[i * n + k] = argument * inputs[i] + direct * along[i]
    e = constant + entries
    for b in range(r):
        for m in range(b + 1):
            on_q = 0.0
            on_v = 0.0
            spring = 0.0
            damper = 0.0
            for i in range(r):
                on_q += springs[i, m] * q[i]
                on_v += dampers[i, m] * v[i]
                spring += springs[i, m] * of_forces[i]
                damper += dampers[i, m] * of_forces[i]
            row[e] = -scale * (of_forces[b] * on_q + q[b] * spring)
            row[e + entries] = -scale * (of_forces[b] * on_v + v[b] * damper)
            e += 1


@njit(cache=True, **OPTIONS)
def residuals_and_jacobian(activation, even, n, parameters, floor, x, y, roots, forward, residuals, jacobian):
    """Rows √w_i r_i into `residuals` (m · 2r,), their derivatives into `jacobian` (m · 2r or 0, parameters).

    `x`, `y` (m, 2r): scaled states and rates; `floor` (r, r) is F; `roots` (2r,) holds √w_i; `forward` says
    which residuals. Sample by sample; with no rows in `jacobian` it is left alone.
    """
    d = x.shape[1]
    r = d // 2
    entries = r * (r + 1) // 2
    count = entries if even else r
    biases = count * n
    readout = biases + n
    constant = readout + entries * n
    springs = _factor(parameters, constant + entries, r)
    dampers = _factor(parameters, constant + 2 * entries, r)
    neurons = np.empty((3, n))
    inputs = np.empty(count)
    by_q = np.zeros((r, count))  # ∂s/∂q_j
    along = np.empty(count)
    factor = np.zeros((r, r))
    slopes = np.zeros((r, r, r))  # ∂L/∂q_j, j first
    mass = np.empty((r, r))
    inverse = np.empty((r, r))
    v, u, momentum = np.empty(r), np.empty(r), np.empty(r)
    turned = np.empty((r, r))
    by_rates = np.empty((r, r))  # ∂f_j/∂v_i
    of_mass, of_forces, lt_mass = np.zeros(r), np.zeros(r), np.empty(r)
    for s in range(len(x)):
        q = x[s, :r]
        for i in range(r):
            if even:
                for j in range(i + 1):
                    e = i * (i + 1) // 2 + j
                    inputs[e] = q[i] * q[j]
                    by_q[i, e] = q[j]
                    by_q[j, e] = 2.0 * q[i] if i == j else q[i]
            else:
                inputs[i] = q[i]
                by_q[i, i] = 1.0
        for k in range(n):
            z = parameters[biases + k]
            for i in range(count):
                z += parameters[i * n + k] * inputs[i]
            neurons[0, k] = value(activation, z)
            neurons[1, k] = slope(activation, z)
            neurons[2, k] = curvature(activation, z)
        for a in range(r):
            for m in range(a + 1):
                e = a * (a + 1) // 2 + m
                total = parameters[constant + e]
                for k in range(n):
                    total += parameters[readout + e * n + k] * neurons[0, k]
                factor[a, m] = total
                for j in range(r):
                    slopes[j, a, m] = 0.0
                for i in range(count):
                    total = 0.0
                    for k in range(n):
                        total += parameters[readout + e * n + k] * neurons[1, k] * parameters[i * n + k]
                    for j in range(r):
                        slopes[j, a, m] += by_q[j, i] * total
        for i in range(r):
            for j in range(r):
                total = floor[i, j]
                for m in range(r):
                    total += factor[i, m] * factor[j, m]
                mass[i, j] = total
        for i in range(r):
            v[i] = y[s, i]
        if forward:
            for i in range(r):
                for j in range(r):
                    by_rates[i, j] = mass[i, j]
            _invert(by_rates, inverse)
            for i in range(r):
                v[i] = 0.0
                for j in range(r):
                    v[i] += inverse[i, j] * x[s, r + j]
        for m in range(r):
            u[m] = 0.0
            for a in range(r):
                u[m] += factor[a, m] * v[a]
            for j in range(r):
                turned[j, m] = 0.0
                for a in range(r):
                    turned[j, m] += slopes[j, a, m] * v[a]
        for i in range(r):
            momentum[i] = 0.0
            force = 0.0
            for j in range(r):
                momentum[i] += mass[i, j] * v[j]
                force += turned[i, j] * u[j]
                for m in range(r):
                    force -= springs[i, m] * springs[j, m] * q[j] + dampers[i, m] * dampers[j, m] * v[j]
            first = v[i] - y[s, i] if forward else momentum[i] - x[s, r + i]
            residuals[s * d + i] = roots[i] * first
            residuals[s * d + r + i] = roots[r + i] * (force - y[s, r + i])
        if len(jacobian) == 0:
            continue
        if forward:
            for j in range(r):
                for i in range(r):
                    total = 0.0
                    for m in range(r):
                        total += slopes[j, i, m] * u[m] + factor[i, m] * turned[j, m]
                        total -= dampers[i, m] * dampers[j, m]
                    by_rates[j, i] = total
        for i in range(d):
            for j in range(r):
                of_mass[j] = 0.0
                of_forces[j] = 0.0
            if i >= r:
                of_forces[i - r] = 1.0
            if forward:
                for j in range(r):
                    if i < r:
                        of_mass[j] = -inverse[i, j]
                    else:
                        for k in range(r):
                            of_mass[j] -= by_rates[i - r, k] * inverse[k, j]
            elif i < r:
                of_mass[i] = 1.0
            for m in range(r):
                lt_mass[m] = 0.0
                for a in range(r):
                    lt_mass[m] += factor[a, m] * of_mass[a]
            for k in range(count):
                along[k] = by_q[i - r, k] if i >= r else 0.0
            _accumulate(
                parameters, r, n, inputs, along, q, v, u,
                of_mass, of_forces, lt_mass, turned, springs, dampers, neurons, jacobian[s * d + i], roots[i],
            )  # fmt: skip
