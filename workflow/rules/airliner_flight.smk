# The airliner in flight: trims, modes and doublets, costs of random flights, figures.

from flexsurr.report.catalogue import AIRLINER_FIGURES, AIRLINER_TABLES
from flexsurr.workflow.airliner_flight_plan import flight_job


def flight(wildcards):
    """The file that holds the values of every job that flies the airliner."""
    return write("fly/airliner", flight_job(airliner.airliner))


rule fly:
    input:
        selection=f"{RESULTS}/selected/airliner.json",
    output:
        modes=f"{RESULTS}/evaluation/airliner/modes.parquet",
        table=f"{RESULTS}/tables/airliner_modes.csv",
        left_out=f"{RESULTS}/tables/airliner_left_out_modes.csv",
        elastic_modes=f"{RESULTS}/tables/airliner_elastic_modes.csv",
        doublets=f"{RESULTS}/evaluation/airliner/doublets.parquet",
        trims=f"{RESULTS}/evaluation/airliner/trims.parquet",
    log:
        f"{RESULTS}/logs/fly/airliner.log",
    benchmark:
        f"{RESULTS}/benchmarks/fly/airliner.tsv"
    threads: 1
    resources:
        mem_mb=2000,
        runtime=60,
    params:
        job=flight,
        code=code("fly"),
        runs=f"{RESULTS}/runs",
    message:
        "trim, modes and doublets of the airliner"
    shell:
        "python -m flexsurr fly --job {params.job:q} --selection {input.selection:q}"
        " --runs {params.runs:q} --modes {output.modes:q} --table {output.table:q}"
        " --left_out {output.left_out:q} --elastic_modes {output.elastic_modes:q}"
        " --doublets {output.doublets:q} --trims {output.trims:q} > {log:q} 2>&1"


rule fly_randomly:
    # It measures time, so it asks for every core: nothing else runs beside it.
    input:
        selection=f"{RESULTS}/selected/airliner.json",
    output:
        flights=f"{RESULTS}/evaluation/airliner/flights.parquet",
        exceedances=f"{RESULTS}/evaluation/airliner/exceedances.parquet",
        cost=f"{RESULTS}/tables/airliner_cost.csv",
        rows=f"{RESULTS}/tables/airliner/cost.csv",
        limits=f"{RESULTS}/tables/airliner_limits.csv",
    log:
        f"{RESULTS}/logs/fly_randomly/airliner.log",
    benchmark:
        f"{RESULTS}/benchmarks/fly_randomly/airliner.tsv"
    threads: plan.settings.timing.cores or workflow.cores or 1
    resources:
        mem_mb=3000,
        runtime=240,
    params:
        job=flight,
        code=code("fly_randomly"),
        runs=f"{RESULTS}/runs",
    message:
        "timing random flights of the airliner"
    shell:
        "python -m flexsurr fly-randomly --job {params.job:q} --selection {input.selection:q}"
        " --runs {params.runs:q} --flights {output.flights:q} --exceedances {output.exceedances:q}"
        " --cost {output.cost:q} --rows {output.rows:q} --limits {output.limits:q} > {log:q} 2>&1"


rule draw_airliner:
    input:
        selection=f"{RESULTS}/selected/airliner.json",
        modes=rules.fly.output.modes,
        doublets=rules.fly.output.doublets,
        elastic_modes=rules.fly.output.elastic_modes,
    output:
        *(
            report(
                f"{RESULTS}/figures/airliner/{name}.svg",
                caption=f"../report/airliner_{name}.rst",
                category="airliner",
                subcategory="figures",
                labels={"figure": name, "shows": AIRLINER_FIGURES[name].title},
            )
            for name in AIRLINER_FIGURES
        ),
        *(f"{RESULTS}/figures/airliner/{name}.png" for name in AIRLINER_FIGURES),
    log:
        f"{RESULTS}/logs/figures/airliner.log",
    benchmark:
        f"{RESULTS}/benchmarks/draw_airliner/airliner.tsv"
    threads: 1
    resources:
        mem_mb=2000,
        runtime=30,
    params:
        job=flight,
        code=code("draw_airliner"),
        runs=f"{RESULTS}/runs",
        folder=f"{RESULTS}/figures/airliner",
    message:
        "drawing the airliner"
    shell:
        "python -m flexsurr draw-airliner --job {params.job:q} --selection {input.selection:q}"
        " --runs {params.runs:q} --modes {input.modes:q}"
        " --doublets {input.doublets:q} --elastic_modes {input.elastic_modes:q} --folder {params.folder:q} > {log:q} 2>&1"


rule show_airliner:
    input:
        tables=expand(f"{RESULTS}/tables/{{name}}.csv", name=AIRLINER_TABLES),
        captions=[
            os.path.relpath(f"{workflow.basedir}/workflow/report/{name}.rst")
            for name in AIRLINER_TABLES
        ],
    output:
        *(
            report(
                f"{RESULTS}/tables/airliner/{name}.html",
                caption=f"../report/{name}.rst",
                category="airliner",
                subcategory="tables",
                labels={"table": name, "shows": AIRLINER_TABLES[name].title},
            )
            for name in AIRLINER_TABLES
        ),
    log:
        f"{RESULTS}/logs/tables/airliner.log",
    benchmark:
        f"{RESULTS}/benchmarks/show_airliner/airliner.tsv"
    threads: 1
    resources:
        mem_mb=1000,
        runtime=30,
    params:
        job=lambda w: write(
            "pages/airliner",
            {"titles": [table.title for table in AIRLINER_TABLES.values()]},
        ),
        code=code("pages"),
        folder=f"{RESULTS}/tables/airliner",
    message:
        "pages of the airliner's tables"
    shell:
        "python -m flexsurr pages --job {params.job:q} --tables {input.tables:q}"
        " --captions {input.captions:q} --folder {params.folder:q} > {log:q} 2>&1"


rule airliner:
    # Everything of the airliner.
    input:
        rules.draw_airliner.output,
        rules.show_airliner.output,
        rules.fly_randomly.output.rows,
