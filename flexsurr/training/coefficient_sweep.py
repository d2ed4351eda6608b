"""From the airliner's sweep to its trials, each with a name that is its content."""

import hashlib
import itertools
import json
from typing import Any

from pydantic import ValidationError

from flexsurr.config.coefficient_sweep import CoefficientSpace, CoefficientTrial
from flexsurr.training.sweep import DIGITS


def expand_coefficients(spaces: tuple[CoefficientSpace, ...]) -> list[CoefficientTrial]:
    """Every combination of every space, in their order, none twice.

    Raises ValueError naming the space whose combinations make no trial.
    """
    trials: dict[CoefficientTrial, None] = {}
    for number, space in enumerate(spaces, start=1):
        values: dict[str, Any] = space.model_dump(exclude_none=True)
        model = values.pop("model")
        for combination in itertools.product(*values.values()):
            try:
                trial = CoefficientTrial(model=model, **dict(zip(values, combination, strict=True)))
            except ValidationError as error:
                reasons = "; ".join(detail["msg"].removeprefix("Value error, ") for detail in error.errors())
                raise ValueError(f"spaces, number {number} (model: {model}): {reasons}") from None
            trials[trial] = None
    return list(trials)


def coefficient_run_id(trial: CoefficientTrial, configurations: dict[str, str]) -> str:
    """`airliner`, the model, and ten hex digits of the hash of the trial and the samples it is fitted to."""
    content = {"trial": trial.model_dump(mode="json"), "samples": configurations[trial.dataset]}
    canonical = json.dumps(content, sort_keys=True, separators=(",", ":"))
    return f"airliner-{trial.model}-{hashlib.sha256(canonical.encode()).hexdigest()[:DIGITS]}"
