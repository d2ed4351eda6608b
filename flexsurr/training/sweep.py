"""From a sweep to its trials, each with a name that is its content."""

import hashlib
import itertools
import json
from typing import Any

import numpy as np

from flexsurr.config.sweep import Space, Sweep
from flexsurr.config.trial import Trial, trial_of

DIGITS = 10


def expand(sweep: Sweep) -> list[Trial]:
    """The trials of `sweep`, in its order, none twice.

    grid: every combination of every space. random: `draws` different combinations of each space, by its
    seed; all of a space that has no more. Raises ValueError naming the space and the first combination
    that makes no trial.
    """
    generator = np.random.default_rng(sweep.seed)
    trials: dict[Trial, None] = {}
    for number, space in enumerate(sweep.spaces, start=1):
        combinations = _combinations(space)
        if sweep.draws is not None and sweep.draws < len(combinations):
            chosen = generator.choice(len(combinations), size=sweep.draws, replace=False)
            combinations = [combinations[place] for place in sorted(chosen.tolist())]
        trials |= dict.fromkeys(_trial(number, combination) for combination in combinations)
    return list(trials)


def run_id(trial: Trial, study: str, variant: str, data: str, any_seed: bool = False) -> str:
    """The architecture and ten hex digits of the hash of everything that names a run.

    `data` is a hash of all that its dataset depends on: a run on other data is another run. With `any_seed`
    the name is that of all runs which differ in nothing but their seed.
    """
    settings = trial.model_dump(mode="json", exclude={"seed"} if any_seed else None)
    content = {"study": study, "variant": variant, "data": data, "trial": settings}
    canonical = json.dumps(content, sort_keys=True, separators=(",", ":"))
    return f"{trial.architecture}-{hashlib.sha256(canonical.encode()).hexdigest()[:DIGITS]}"


def _combinations(space: Space) -> list[dict[str, Any]]:
    values = space.model_dump(exclude_none=True)
    architecture = values.pop("architecture")
    return [
        {"architecture": architecture, **dict(zip(values, combination, strict=True))}
        for combination in itertools.product(*values.values())
    ]


def _trial(number: int, combination: dict[str, Any]) -> Trial:
    try:
        return trial_of(**combination)
    except ValueError as error:
        shown = ", ".join(f"{key}: {value}" for key, value in combination.items())
        raise ValueError(f"spaces, number {number} ({shown}): {error}") from None
