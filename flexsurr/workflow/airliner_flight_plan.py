"""The jobs that fly the airliner: as `airliner_plan`, exactly the values that they depend on."""

from typing import Any

from flexsurr.config.airliner import Airliner


def flight_job(airliner: Airliner) -> dict[str, Any]:
    """Aircraft, flights, and the lattice and the limits as the network's samples had them."""
    dataset = airliner.sweep.dataset
    return {
        "aircraft": airliner.aircraft.model_dump(mode="json"),
        "flight": airliner.flight.model_dump(mode="json"),
        "limits": airliner.limits.model_dump(mode="json"),
        "panels": dataset.panels.model_dump(mode="json"),
        "boundary_condition": dataset.boundary_condition,
    }
