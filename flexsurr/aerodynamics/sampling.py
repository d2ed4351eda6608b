"""Random features to sample the aerodynamics at, independent of how they are cut into shards.

And an aerodynamics to first order in the modal coordinates and velocities, to be sampled in its place.
"""

from typing import Literal

import numpy as np

from flexsurr.aerodynamics.features import FEATURES, FIRST_ETA
from flexsurr.config.aerodynamics import FeatureLimits
from flexsurr.simulation.mapping import CompiledMapping
from flexsurr.simulation.rhs import Array


def feature_intervals(limits: FeatureLimits) -> tuple[Array, Array]:
    """The least and the largest value (25,) of each feature, in the features' own units."""
    values = [
        getattr(limits, name) for name in FeatureLimits.model_fields if name not in ("eta", "eta_dot_over_V")
    ]
    degrees = [name.endswith("_deg") for name in FeatureLimits.model_fields][: len(values)]
    pairs = np.array([(limit.low, limit.high) for limit in (*values, *limits.eta, *limits.eta_dot_over_V)])
    pairs[: len(values)][degrees] = np.radians(pairs[: len(values)][degrees])
    return np.ascontiguousarray(pairs[:, 0]), np.ascontiguousarray(pairs[:, 1])


def draw_features(
    low: Array,
    high: Array,
    *,
    seed: int,
    first: int,
    count: int,
    sampling: Literal["pseudo_random", "sobol"] = "pseudo_random",
) -> Array:
    """Samples `first` to `first + count − 1` (count, 25) of the sequence that `seed` begins.

    pseudo_random: uniform, each sample with a generator of its own. sobol: a scrambled Sobol sequence,
    which fills the space more evenly; best where the number of all samples is a power of two.
    """
    if sampling == "sobol":
        from scipy.stats.qmc import Sobol  # here, for scipy.stats takes a second to import

        sequence = Sobol(len(FEATURES), scramble=True, rng=np.random.default_rng(seed))
        if first:
            sequence.fast_forward(first)
        # Sobol's own warning about powers of two looks at one shard, not at the sequence
        unit = np.concatenate([sequence.random(1) for _ in range(count)])
    else:
        generators = (np.random.default_rng([seed, number]) for number in range(first, first + count))
        unit = np.stack([generator.uniform(size=len(FEATURES)) for generator in generators])
    samples: Array = low + (high - low) * unit
    return samples


_MODAL_STEP = 1e-3


def linear_in_modes(form: CompiledMapping, u: Array) -> Array:
    """Coefficients (m, 12) at features `u` (m, 25), linearised about the undeformed airframe at rest.

    c(r, 0) + ∂c/∂m m, with m the modal coordinates and velocities and r the other features. The derivative
    along m is a central difference, whose error is 1e-6 of the third order in m.
    """
    rigid, ahead, behind = (np.array(u) for _ in range(3))
    rigid[:, FIRST_ETA:] = 0.0
    ahead[:, FIRST_ETA:] *= _MODAL_STEP
    behind[:, FIRST_ETA:] *= -_MODAL_STEP
    return np.asarray(form(rigid) + (form(ahead) - form(behind)) / (2.0 * _MODAL_STEP))
