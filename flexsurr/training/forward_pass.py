"""What a network's neurons are at one sample, and where it lies in the workspace.

The workspace holds, for each network, a block of five vectors for the inputs and for each layer (values,
tangents, slopes, curvatures, adjoints of σ's arguments), then two vectors of adjoints of the widest layer's
length. Offsets into it are unsigned for the reason given in `flexsurr.surrogates.layers`.
"""

import numpy as np
from numba import njit

from flexsurr.simulation.rhs import FLOATING_POINT, Array
from flexsurr.surrogates.activations import curvature, slope, value
from flexsurr.surrogates.layers import forward, offset

VECTORS = np.uint64(5)  # in a block
# without reference counts: nothing here allocates, and they would cost as much as a small network
OPTIONS = {"fastmath": FLOATING_POINT, "error_model": "numpy", "_nrt": False}


def workspace(widths: tuple[int, ...], networks: int) -> Array:
    """Room for one sample in each of `networks` of these widths, inputs first."""
    return np.zeros(networks * (int(VECTORS) * sum(widths) + 2 * max(widths)))


@njit(**OPTIONS)
def propagate(kernel, parameters, x, work):
    """Value, slope and curvature of every neuron at the scaled state `x` (2r,)."""
    activation = kernel.activation
    widths = kernel.widths
    for network in range(kernel.networks):
        layer, block = starts(kernel, network, parameters, work)
        for j in range(x.size):
            work[block + offset(j)] = x[j]
        for level in range(1, len(widths)):
            n = offset(widths[level - 1])
            m = offset(widths[level])
            inputs = block
            block += VECTORS * n
            slopes = block + m + m
            curvatures = slopes + m
            forward(parameters, layer, n, m, work, inputs, block)
            for k in range(m):
                z = work[block + k]
                work[block + k] = value(activation, z)
                work[slopes + k] = slope(activation, z)
                work[curvatures + k] = curvature(activation, z)
            layer += n * m + m


@njit(**OPTIONS)
def starts(kernel, network, parameters, work):
    """Offsets of the first parameter and of the workspace of one of the kernel's networks."""
    networks = kernel.networks
    return offset(network * (parameters.size // networks)), offset(network * (work.size // networks))


@njit(**OPTIONS)
def ends(widths, layer, block):
    """Offsets of the last layer's block, of the readout's parameters and of the two adjoints.

    Of the network whose parameters begin at `layer` and whose workspace begins at `block`.
    """
    widest = offset(0)
    for level in range(1, len(widths)):
        n = offset(widths[level - 1])
        m = offset(widths[level])
        layer += n * m + m
        block += VECTORS * n
        widest = max(widest, n, m)
    adjoint = block + VECTORS * offset(widths[len(widths) - 1])
    return block, layer, adjoint, adjoint + widest
