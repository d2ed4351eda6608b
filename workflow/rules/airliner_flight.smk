# The airliner in flight: trims, modes and doublets, costs of random flights, figures.

from flexsurr.workflow.airliner_flight_plan import flight_job

AIRLINER_FIGURES = [
    *(f"figure_{number}" for number in range(16, 22)),
    "elastic_modes",
]
AIRLINER_FLIGHT = json.dumps(flight_job(airliner.airliner), sort_keys=True)


rule fly:
    input:
        selection=f"{RESULTS}/selected/airliner.json",
    output:
        modes=f"{RESULTS}/evaluation/airliner/modes.parquet",
        table=f"{RESULTS}/tables/airliner_modes.csv",
        left_out=f"{RESULTS}/tables/airliner_left_out_modes.csv",
        doublets=f"{RESULTS}/evaluation/airliner/doublets.parquet",
        trims=f"{RESULTS}/evaluation/airliner/trims.parquet",
    log:
        f"{RESULTS}/logs/fly/airliner.log",
    params:
        job=AIRLINER_FLIGHT,
        code=code("fly"),
        runs=f"{RESULTS}/runs",
    message:
        "trim, modes and doublets of the airliner"
    shell:
        "python -m flexsurr.cli.fly --job {params.job:q} --selection {input.selection:q}"
        " --runs {params.runs:q} --modes {output.modes:q} --table {output.table:q}"
        " --left_out {output.left_out:q} --doublets {output.doublets:q} --trims {output.trims:q} > {log:q} 2>&1"


rule fly_randomly:
    # It measures time, so it asks for every core: nothing else runs beside it.
    input:
        selection=f"{RESULTS}/selected/airliner.json",
    output:
        flights=f"{RESULTS}/evaluation/airliner/flights.parquet",
        exceedances=f"{RESULTS}/evaluation/airliner/exceedances.parquet",
        cost=f"{RESULTS}/tables/airliner_cost.csv",
        rows=f"{RESULTS}/evaluation/airliner/cost.parquet",
        limits=f"{RESULTS}/tables/airliner_limits.csv",
    log:
        f"{RESULTS}/logs/fly_randomly/airliner.log",
    threads: plan.settings.timing.cores or workflow.cores or 1
    params:
        job=AIRLINER_FLIGHT,
        code=code("fly_randomly"),
        runs=f"{RESULTS}/runs",
    message:
        "timing random flights of the airliner"
    shell:
        "python -m flexsurr.cli.fly_randomly --job {params.job:q} --selection {input.selection:q}"
        " --runs {params.runs:q} --flights {output.flights:q} --exceedances {output.exceedances:q}"
        " --cost {output.cost:q} --rows {output.rows:q} --limits {output.limits:q} > {log:q} 2>&1"


rule draw_airliner:
    input:
        modes=rules.fly.output.modes,
        doublets=rules.fly.output.doublets,
    output:
        *(
            report(
                f"{RESULTS}/figures/airliner/{name}.svg",
                caption=f"../report/airliner_{name}.rst",
                category="airliner",
                subcategory="figures",
                labels={"figure": name},
            )
            for name in AIRLINER_FIGURES
        ),
        *(f"{RESULTS}/figures/airliner/{name}.png" for name in AIRLINER_FIGURES),
    log:
        f"{RESULTS}/logs/figures/airliner.log",
    params:
        job=AIRLINER_FLIGHT,
        code=code("draw_airliner"),
        folder=f"{RESULTS}/figures/airliner",
    message:
        "drawing the airliner"
    shell:
        "python -m flexsurr.cli.draw_airliner --job {params.job:q} --modes {input.modes:q}"
        " --doublets {input.doublets:q} --folder {params.folder:q} > {log:q} 2>&1"


rule airliner:
    # Everything of the airliner.
    input:
        rules.draw_airliner.output,
        rules.fly.output.table,
        rules.fly_randomly.output.cost,
        f"{RESULTS}/tables/airliner_accuracy.csv",
