"""How far a run is: what is left adds up, and is never counted twice."""

import logging

import pytest
from snakemake_interface_logger_plugins.common import LogEvent

from flexsurr.workflow.progress import OTHERWISE_S, TYPICAL_S, Progress, Teller, earlier_means


class Clock:
    """A time that the test sets."""

    def __init__(self) -> None:
        self.s = 1000.0

    def __call__(self) -> float:
        return self.s


@pytest.fixture
def clock() -> Clock:
    return Clock()


def test_what_is_left_is_shared_by_the_cores_but_for_what_runs_alone(clock):
    run = Progress(2, ["evaluate"], {"train": 10.0, "evaluate": 30.0}, clock)
    run.planned({"train": 4, "evaluate": 1})
    assert run.left_s == 4 * 10.0 / 2 + 30.0
    run.started(1, "train", "training a")
    clock.s += 4.0
    assert run.left_s == (4 * 10.0 - 4.0) / 2 + 30.0


def test_the_times_of_this_run_count_more_than_earlier_ones_and_those_more_than_typical_ones(clock):
    run = Progress(1, (), {"score": 7.0}, clock)
    run.planned({"train": 2, "score": 1, "draw_wing_runs": 1, "select": 1})
    assert run.left_s == 2 * TYPICAL_S["train"] + 7.0 + TYPICAL_S["draw"] + OTHERWISE_S
    run.started(1, "train", "")
    clock.s += 3.0
    run.ended(1)
    assert run.left_s == 3.0 + 7.0 + TYPICAL_S["draw"] + OTHERWISE_S


def test_a_job_that_takes_longer_than_expected_is_never_less_than_nothing(clock):
    run = Progress(1, (), {"train": 5.0}, clock)
    run.planned({"train": 1})
    run.started(1, "train", "")
    clock.s += 500.0
    assert run.left_s == 0.0
    run.ended(1)
    assert run.left_s == 0.0
    assert run.line() == "1 of 1 jobs done in 8 min"


def test_a_failed_job_is_not_waited_for_and_its_time_says_nothing(clock):
    run = Progress(1, (), {"train": 5.0}, clock)
    run.planned({"train": 2})
    run.started(1, "train", "")
    clock.s += 100.0
    run.ended(1, well=False)
    assert run.left_s == 5.0


def test_the_line_says_what_runs_how_much_is_left_and_until_when(clock):
    run = Progress(2, (), {"train": 100.0}, clock)
    run.planned({"train": 6})
    for number in range(5):
        run.started(number, "train", f"training {number}")
    done, left, running = run.line().split(" | ")
    assert done == "0 of 6 jobs done in 0 s"
    assert left.startswith("about 5 min left, until ")
    assert running == "training 0; training 1; training 2 and 2 more"


def test_elsewhere_nobody_knows_when_it_ends(clock):
    run = Progress(None, (), {}, clock)
    run.planned({"train": 6})
    assert run.left_s is None
    assert "left" not in run.line()


def test_it_follows_what_snakemake_logs(clock):
    run, said = Progress(2, (), {"train": 10.0}, clock), []
    logger = logging.Logger("of the workflow")
    logger.addHandler(Teller(lambda: run, said.append))

    def log(event: LogEvent, **values: object) -> None:
        logger.info("", extra={"event": event, **values})

    log(LogEvent.RUN_INFO, stats={"train": 3, "total": 3})
    for number in (1, 2):
        log(LogEvent.JOB_INFO, jobid=number, rule_name="train", rule_msg=f"training {number}")
    clock.s += 10.0
    log(LogEvent.JOB_FINISHED, job_id=1)
    log(LogEvent.PROGRESS, done=1, total=3)
    logger.info("something else")
    (line,) = said
    assert line.startswith("1 of 3 jobs done in 10 s | about 5 s left, until ")
    assert line.endswith(" | training 2")
    log(LogEvent.JOB_ERROR, jobid=2)
    assert run.left_s == 5.0


def test_earlier_times_come_from_the_files_of_benchmarks(tmp_path):
    for name, text in {
        "train/a.tsv": "s\th:m:s\n2.0\t0:00:02\n",
        "train/b.tsv": "s\th:m:s\n4.0\t0:00:04\n",
        "score/c.tsv": "no benchmark\nat all\n",
        "draw/d.tsv": "",
    }.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text)
    assert earlier_means(tmp_path) == {"train": 3.0}
    assert earlier_means(tmp_path / "nowhere") == {}
