"""Many trials and shards: no command line grows with their number."""

import re

BEAM = "cantilever"
TARGETS = (f"results/selected/{BEAM}.json", f"results/tables/{BEAM}/training.html")
SWEEP = "config/sweeps/quick.yaml"


def commands(project) -> dict[str, str]:
    """The longest command of each name that a run would give to the shell."""
    output = project.run_well("--dry-run", "--printshellcmds", *TARGETS)
    lines = re.findall(r"python -m flexsurr \S+ .*", output)
    return {line.split()[3]: line for line in sorted(lines, key=len)}


def test_no_command_grows_with_trials_or_shards(make_project):
    few, many = make_project(), make_project()
    for project, count in ((few, 2), (many, 60)):
        project.change(SWEEP, "spaces.0.seed", list(range(10, 10 + count)))
        project.change("config/presets/quick.yaml", f"overrides.{BEAM}.dataset.trajectories", count)
        project.change("config/presets/quick.yaml", f"overrides.{BEAM}.dataset.trajectories_per_shard", 1)
    short, long = commands(few), commands(many)
    assert {"simulate", "manifest", "train", "score", "select", "tabulate"} <= short.keys()
    assert {name: len(line) for name, line in long.items()} == {name: len(short[name]) for name in long}
