"""The tables of ISO 2533."""

import pytest

from flexsurr.aerodynamics.standard_atmosphere import density, speed_of_sound, temperature, viscosity


@pytest.mark.parametrize(
    ("altitude", "kelvin", "kg_m3", "m_s"),
    [
        (0.0, 288.150, 1.22500, 340.294),
        (5000.0, 255.650, 0.736116, 320.529),
        (10000.0, 223.150, 0.412707, 299.463),
        (11000.0, 216.650, 0.363918, 295.069),
        (15000.0, 216.650, 0.193674, 295.069),
    ],
)
def test_tabulated_values(altitude, kelvin, kg_m3, m_s):
    assert temperature(altitude) == pytest.approx(kelvin, rel=1e-6)
    assert density(altitude) == pytest.approx(kg_m3, rel=5e-6)
    assert speed_of_sound(altitude) == pytest.approx(m_s, rel=2e-6)


def test_viscosity_at_sea_level():
    assert viscosity(0.0) == pytest.approx(1.7894e-5, rel=1e-4)
