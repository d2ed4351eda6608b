"""The airliner that the tests of its flight share."""

from pathlib import Path

import numpy as np
import pytest

from flexsurr.aerodynamics.mach_grid import fixed_machs
from flexsurr.aerodynamics.quadratic import quadratic
from flexsurr.config.aerodynamics import PanelCounts
from flexsurr.config.aircraft import load_aircraft
from flexsurr.flight import free_modes, stick_model
from flexsurr.flight.airliner import flexible_airframe
from flexsurr.flight.linear_aerodynamics import derivatives, linear_aerodynamics

GNBA = Path(__file__).resolve().parents[2] / "config/aircraft/gnba.yaml"


@pytest.fixture(scope="session")
def gnba():
    return load_aircraft(GNBA)


@pytest.fixture(scope="session")
def gnba_modes(gnba):
    return free_modes(stick_model(gnba), 8)


@pytest.fixture(scope="session")
def gnba_derivatives(gnba_modes):
    """Derivatives of a coarse lattice about cruise, as an aerodynamics."""
    coarse = PanelCounts(wing=(10, 4), horizontal_tail=(4, 4), vertical_tail=(4, 4))
    lattice = quadratic(flexible_airframe(gnba_modes, coarse), fixed_machs([0.7]))
    about = np.zeros(25)
    about[:3] = 0.7, 10000.0, 0.05
    return linear_aerodynamics(about, lattice(about), derivatives(lattice, about))
