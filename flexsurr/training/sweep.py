"""From a sweep to its trials, each with a name that is its content."""

import hashlib
import itertools
import json
import math
from collections.abc import Iterator, Mapping
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flexsurr.config.own_network import own_network
from flexsurr.config.sweep import Range, Space, Sweep
from flexsurr.config.trial import Trial, trial_of

DIGITS = 10

TRIED = 1000
"""So many points are drawn for each combination that is wanted: a narrow range may hold too few."""

Combination = dict[tuple[str, ...], Any]
"""One value of each dimension of a space."""


def expand(sweep: Sweep, sha256: Mapping[str, str] = MappingProxyType({})) -> list[Trial]:
    """The trials of `sweep`, in its order, none twice; `sha256` has those of the user's own architectures.

    grid: every combination of every space. random, sobol: `draws` different combinations of each space, by
    the seed and the space's number; all of a space that has no more. One draw more leaves those before it
    as they are. Raises ValueError naming the space and the first combination that makes no trial.
    """
    trials: dict[str, Trial] = {}
    for number, space in enumerate(sweep.spaces, start=1):
        for combination in _combinations(sweep, number, space):
            settings = {"architecture": space.architecture, **_settings(combination)}
            trial = _trial(number, settings, sha256.get(space.architecture))
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


def _combinations(sweep: Sweep, number: int, space: Space) -> list[Combination]:
    dimensions = space.dimensions()
    sizes = [values.count if isinstance(values, Range) else len(values) for values in dimensions.values()]
    if sweep.draws is not None and sweep.draws < math.prod(sizes):
        return _drawn(sweep, number, dimensions)
    every = (values.every() if isinstance(values, Range) else values for values in dimensions.values())
    return [dict(zip(dimensions, chosen, strict=True)) for chosen in itertools.product(*every)]


def _drawn(sweep: Sweep, number: int, dimensions: Mapping[tuple[str, ...], Any]) -> list[Combination]:
    """As many different combinations as are to be drawn: there must be more."""
    varied = {
        key: values for key, values in dimensions.items() if isinstance(values, Range) or len(values) > 1
    }
    fixed = {key: values[0] for key, values in dimensions.items() if key not in varied}
    found: dict[str, Combination] = {}
    assert sweep.draws is not None
    for shares in itertools.islice(_shares(sweep, number, len(varied)), TRIED * sweep.draws):
        chosen = {
            key: values.at(share) if isinstance(values, Range) else values[int(share * len(values))]
            for (key, values), share in zip(varied.items(), shares.tolist(), strict=True)
        }
        found.setdefault(repr(list(chosen.values())), {**fixed, **chosen})
        if len(found) == sweep.draws:
            return list(found.values())
    raise ValueError(
        f"spaces[{number - 1}]: draws: {sweep.draws} is not allowed; allowed: at most {len(found)}, for "
        "its ranges have no more combinations that differ"
    )


def _shares(sweep: Sweep, number: int, dimensions: int) -> Iterator[NDArray[np.float64]]:
    """Points (dimensions,) of the unit cube, one after the other without an end."""
    generator = np.random.default_rng([sweep.seed, number])
    if sweep.search == "random":
        while True:
            yield generator.random(dimensions)
    from scipy.stats.qmc import Sobol  # here, for scipy.stats takes a second to import

    sequence = Sobol(dimensions, scramble=True, rng=generator)
    while True:
        # twice as many each time: the sequence is even over powers of two
        yield from sequence.random(max(sequence.num_generated, 1))


def _settings(combination: Combination) -> dict[str, Any]:
    """The settings of a trial, the keywords of a class of the user's own together."""
    settings = {key[0]: value for key, value in combination.items() if len(key) == 1}
    options = {key[1]: value for key, value in combination.items() if len(key) > 1}
    return settings | ({"options": options} if options else {})


def _trial(number: int, settings: dict[str, Any], sha256: str | None) -> Trial:
    try:
        return trial_of(**settings, sha256=sha256)
    except ValueError as error:
        shown = ", ".join(
            f"{key}: {list(value) if isinstance(value, tuple) else value}" for key, value in settings.items()
        )
        raise ValueError(f"spaces[{number - 1}] ({shown}): {error}") from None
