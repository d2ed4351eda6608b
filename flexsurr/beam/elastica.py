"""The exact tip of an inextensible cantilever under a dead transverse tip force, by elliptic integrals."""

import math

LARGEST_LOAD = 100.0
"""F L²/EI up to which the closed form is evaluated: the tip's slope nears a right angle."""


def elastica_tip(bending_stiffness: float, length: float, tip_force: float) -> tuple[float, float]:
    """(x, z) [m] of the tip for EI [N m²], L [m] and a force [N] along +z (negative: along −z).

    With κ² = F/EI the moment's balance gives θ′² = 2 κ² (sin θ₀ − sin θ), θ₀ the slope of the tip. Set
    sin θ = 2 m cos² u − 1 with m = (1 + sin θ₀)/2, so that u runs from 0 at the tip to δ at the clamp:

        κ L = ∫₀^δ (1 − m cos² u)^(−½) du,     κ z = ∫₀^δ sin θ (1 − m cos² u)^(−½) du,     κ x = √(2 sin θ₀)

    (R. Frisch-Fay, Flexible Bars, 1962, chapter 2.) The first integral is F(ψ | m), tan ψ = tan δ / √(1 − m).
    ValueError for a stiffness or length that is not positive, or for F L²/EI beyond 100.
    """
    if not (bending_stiffness > 0.0 and length > 0.0):
        raise ValueError(f"stiffness and length must be positive: {bending_stiffness}, {length}")
    scale = math.sqrt(abs(tip_force) / bending_stiffness)
    if not (scale * length) ** 2 <= LARGEST_LOAD:
        raise ValueError(f"tip_force: {tip_force} N is beyond F L²/EI = {LARGEST_LOAD:g}")
    if tip_force == 0.0:
        return length, 0.0

    # here, for they take a third of a second that nothing else of the beam needs
    from scipy.integrate import quad
    from scipy.optimize import brentq
    from scipy.special import ellipkinc

    def clamp(rise: float) -> float:
        """δ for sin θ₀ = rise."""
        return math.asin(math.sqrt(rise / (1.0 + rise)))

    def arc(rise: float) -> float:
        psi = math.atan(math.tan(clamp(rise)) * math.sqrt(2.0 / (1.0 - rise)))
        return float(ellipkinc(psi, 0.5 * (1.0 + rise)))

    # `rise` is near (κ L)²/2 for small loads, hence the bracket; xtol would spoil its relative accuracy.
    rise = brentq(lambda r: arc(r) - scale * length, 1e-300, 1.0 - 1e-15, xtol=1e-300, rtol=1e-15)

    def height(u: float) -> float:
        sine = rise - (1.0 + rise) * math.sin(u) ** 2
        ratio: float = sine / math.sqrt(0.5 * (1.0 - sine))
        return ratio

    z = quad(height, 0.0, clamp(rise), epsabs=0.0, epsrel=1e-10)[0] / scale
    return math.sqrt(2.0 * rise) / scale, math.copysign(z, tip_force)
