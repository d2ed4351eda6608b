# On the terminal, after each job: what runs, how much is left, and when it will end.

from flexsurr.workflow.progress import Progress, Teller, earlier_means

# Their jobs take every core, unless the configuration says otherwise.
TIMED = ("evaluate", "rivals", "rollout_cost", "fly_randomly")


def progress():
    """What is known before the first job. Where jobs go is not known before."""
    return Progress(
        workflow.resource_settings.cores if workflow.local_exec else None,
        TIMED if plan.settings.timing.cores is None else (),
        earlier_means(Path(RESULTS) / "benchmarks"),
    )


if workflow.is_main_process:
    logger.addHandler(Teller(progress, logger.info))
