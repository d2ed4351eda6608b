"""The jobs that fly the airliner: as `airliner_plan`, exactly the values that they depend on."""

from typing import Any

from flexsurr.config.sources import ResolvedSampleStudy


def flight_job(airliner: ResolvedSampleStudy) -> dict[str, Any]:
    """Aircraft, flights, and the lattice and the limits as the network's samples had them."""
    dataset = airliner.study.dataset
    return {
        "aircraft": airliner.aircraft.model_dump(mode="json"),
        "flight": airliner.study.flight.model_dump(mode="json"),
        "limits": airliner.limits.model_dump(mode="json"),
        "panels": dataset.panels.model_dump(mode="json"),
        "boundary_condition": dataset.boundary_condition,
    }
