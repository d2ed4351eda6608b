"""Time derivatives of sampled, possibly noisy states (Savitzky and Golay, Anal. Chem. 36, 1964, p. 1627)."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def savitzky_golay(t: Array, x: Array, window: int, order: int) -> tuple[Array, Array]:
    """Smoothed states and their derivatives, (m, d) each, of samples `x` (m, d) at times `t` (m,) [s].

    Around each sample a polynomial of `order` is fitted to `window` samples, the sample in their middle,
    towards the ends as near to it as can be; its value and slope there are the result. Where samples are
    evenly spaced this is `scipy.signal.savgol_filter` with its mode "interp"; here they need not be. Raises
    ValueError for fewer samples than the window.
    """
    if len(t) < window:
        raise ValueError(f"{len(t)} samples are fewer than the window of {window}")
    first = np.clip(np.arange(len(t)) - window // 2, 0, len(t) - window)
    nearby = first[:, None] + np.arange(window)
    away = t[nearby] - t[:, None]
    # in units of the window's length, so that the powers are of one size
    length = away[:, -1] - away[:, 0]
    powers = (away / length[:, None])[..., None] ** np.arange(order + 1)
    coefficients = np.linalg.pinv(powers)[:, :2] @ x[nearby]
    return coefficients[:, 0], coefficients[:, 1] / length[:, None]
