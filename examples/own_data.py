"""Write noisy trajectories of a spring, a pendulum and a damped spring, as if somebody had measured them.

python examples/own_data.py
snakemake --cores 2 --configfile examples/own_data.yaml
"""

from pathlib import Path

from flexsurr.evaluation.published_tasks import TASKS, recordings

folder = Path("data")
folder.mkdir(exist_ok=True)
for name, task in TASKS.items():
    measured = recordings(task, seed=0)[["trajectory", "t", "q", "p"]]  # no derivatives: who measures them?
    file = folder / f"{name}.csv"
    measured.to_csv(file, index=False)
    print(f"{file}: {measured['trajectory'].nunique()} trajectories, {len(measured)} samples")
