"""From a sweep to its trials, each with a name that is its content."""

import hashlib
import itertools
import json
from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Any

import numpy as np

from flexsurr.config.own_network import own_network
from flexsurr.config.sweep import Space, Sweep
from flexsurr.config.trial import Trial, trial_of

DIGITS = 10


def expand(sweep: Sweep, sha256: Mapping[str, str] = MappingProxyType({})) -> list[Trial]:
    """The trials of `sweep`, in its order, none twice; `sha256` has those of the user's own architectures.

    grid: every combination of every space. random: `draws` different combinations of each space, by its
    seed; all of a space that has no more. Raises ValueError naming the space and the first combination
    that makes no trial.
    """
    generator = np.random.default_rng(sweep.seed)
    trials: dict[str, Trial] = {}
    for number, space in enumerate(sweep.spaces, start=1):
        combinations = _combinations(space)
        if sweep.draws is not None and sweep.draws < len(combinations):
            chosen = generator.choice(len(combinations), size=sweep.draws, replace=False)
            combinations = [combinations[place] for place in sorted(chosen.tolist())]
        for combination in combinations:
            trial = _trial(number, combination, sha256.get(space.architecture))
            trials.setdefault(_canonical(trial.model_dump(mode="json")), trial)
    return list(trials.values())


def run_id(trial: Trial, study: str, variant: str, data: str, any_seed: bool = False) -> str:
    """The architecture and ten hex digits of the hash of everything that names a run.

    `data` is a hash of all that its dataset depends on: a run on other data is another run. With `any_seed`
    the name is that of all runs which differ in nothing but their seed.
    """
    settings = trial.model_dump(mode="json", exclude={"seed"} if any_seed else None)
    content = {"study": study, "variant": variant, "data": data, "trial": settings}
    own = own_network(trial.architecture)
    name = trial.architecture if own is None else own.name
    return f"{name}-{hashlib.sha256(_canonical(content).encode()).hexdigest()[:DIGITS]}"


def _canonical(content: Mapping[str, Any]) -> str:
    return json.dumps(content, sort_keys=True, separators=(",", ":"))


def _combinations(space: Space) -> list[dict[str, Any]]:
    values = space.model_dump(exclude_none=True)
    architecture = values.pop("architecture")
    if "options" in values:
        values["options"] = _products(values["options"])
    return [{"architecture": architecture, **combination} for combination in _products(values)]


def _products(values: Mapping[str, Sequence[Any]]) -> list[dict[str, Any]]:
    """Every combination of one value of each key."""
    return [dict(zip(values, chosen, strict=True)) for chosen in itertools.product(*values.values())]


def _trial(number: int, combination: dict[str, Any], sha256: str | None) -> Trial:
    try:
        return trial_of(**combination, sha256=sha256)
    except ValueError as error:
        shown = ", ".join(f"{key}: {value}" for key, value in combination.items())
        raise ValueError(f"spaces, number {number} ({shown}): {error}") from None
