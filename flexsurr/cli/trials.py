"""Many trials of a batch, trained and scored one after another: those that are not there."""

from pathlib import Path

from flexsurr.beam import EquilibriumNotFound
from flexsurr.cli.batch import make_all, trials_of
from flexsurr.cli.command import Job, for_rules
from flexsurr.cli.scoring import score, score_map
from flexsurr.cli.training import train, train_map

BATCH = {
    "results": "the folder of results",
    "store": "the address of the tracking store",
    "output": "what is made",
}


@for_rules(**BATCH)
def trials(job: Job, results: Path, store: Path, output: Path) -> None:
    """Train and score a batch of surrogates of fields: those that are missing or out of date.

    Their folders lie below `results`; `output` lists what is in them.
    """
    items = trials_of(job, results, store, train, score)
    make_all(items, results, output, (EquilibriumNotFound, ArithmeticError))


@for_rules(**BATCH)
def map_trials(job: Job, results: Path, store: Path, output: Path) -> None:
    """Train and score a batch of surrogates of maps: those that are missing or out of date.

    Their folders lie below `results`; `output` lists what is in them.
    """
    make_all(trials_of(job, results, store, train_map, score_map), results, output)
