"""Gradients of a network's scalars, and the derivatives of those by the weights."""

from numba import njit

from flexsurr.surrogates.layers import back, offset
from flexsurr.training.forward_pass import OPTIONS, VECTORS, ends, starts


@njit(**OPTIONS)
def scalar_gradient(kernel, parameters, network, work):
    """Gradient of the scalar of number `network` by the inputs; returns its offset in `work`.

    From what `propagate` left; the next call overwrites it.
    """
    widths = kernel.widths
    last = len(widths) - 1
    block, layer, adjoint, _ = ends(widths, *starts(kernel, network, parameters, work))
    for k in range(offset(widths[last])):
        work[adjoint + k] = parameters[layer + k]
    for level in range(last, 0, -1):
        n = offset(widths[level - 1])
        m = offset(widths[level])
        slopes = block + m + m
        arguments = slopes + m + m
        for k in range(m):
            work[arguments + k] = work[adjoint + k] * work[slopes + k]
        layer -= n * m + m
        back(parameters, layer, n, m, work, arguments, adjoint)
        block -= VECTORS * n
    return adjoint


@njit(**OPTIONS)
def accumulate_slope(kernel, parameters, network, gradient, work):
    """Add ∂(u · ∇ scalar)/∂θ of the scalar of number `network` to `gradient`.

    u is its inputs' tangents in `work`.

    u · ∇ is the rate at which the scalar changes along u: one tangent sweep forwards, then one ordinary
    sweep back. Values, slopes and curvatures stay as `propagate` left them.
    """
    widths = kernel.widths
    last = len(widths) - 1
    layer, block = starts(kernel, network, parameters, work)
    _, _, of_values, of_tangents = ends(widths, layer, block)
    for level in range(1, last + 1):
        n = offset(widths[level - 1])
        m = offset(widths[level])
        tangents_in = block + n
        block += VECTORS * n
        tangents = block + m
        slopes = tangents + m
        curvatures = slopes + m
        arguments = curvatures + m
        for k in range(m):
            work[tangents + k] = 0.0
        for j in range(n):
            tangent = work[tangents_in + j]
            row = layer + j * m
            for k in range(m):
                work[tangents + k] += tangent * parameters[row + k]
        for k in range(m):
            work[arguments + k] = work[curvatures + k] * work[tangents + k]
            work[tangents + k] *= work[slopes + k]
        layer += n * m + m
    m = offset(widths[last])
    for k in range(m):
        gradient[layer + k] += work[block + m + k]
        work[of_values + k] = 0.0
        work[of_tangents + k] = parameters[layer + k]
    for level in range(last, 0, -1):
        n = offset(widths[level - 1])
        m = offset(widths[level])
        tangents = block + m
        slopes = tangents + m
        arguments = slopes + m + m
        # the adjoints of σ's argument and of that argument's tangent take the places of both
        for k in range(m):
            work[arguments + k] = (
                work[of_values + k] * work[slopes + k] + work[of_tangents + k] * work[arguments + k]
            )
            work[tangents + k] = work[of_tangents + k] * work[slopes + k]
        block -= VECTORS * n
        biases = layer - m
        layer = biases - n * m
        for k in range(m):
            gradient[biases + k] += work[arguments + k]
        for j in range(n):
            a = work[block + j]
            tangent = work[block + n + j]
            row = layer + j * m
            for k in range(m):
                gradient[row + k] += a * work[arguments + k] + tangent * work[tangents + k]
        if level > 1:
            back(parameters, layer, n, m, work, arguments, of_values)
            back(parameters, layer, n, m, work, tangents, of_tangents)
