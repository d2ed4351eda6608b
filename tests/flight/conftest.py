"""The airliner that the tests of its flight share."""

from pathlib import Path

import pytest

from flexsurr.config.aircraft import load_aircraft
from flexsurr.flight import free_modes, stick_model

GNBA = Path(__file__).resolve().parents[2] / "config/aircraft/gnba.yaml"


@pytest.fixture(scope="session")
def gnba():
    return load_aircraft(GNBA)


@pytest.fixture(scope="session")
def gnba_modes(gnba):
    return free_modes(stick_model(gnba), 8)
