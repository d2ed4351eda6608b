# The evaluation of a study of samples: errors of its maps, and its aircraft in flight with each of them.


rule accuracy:
    input:
        selection=f"{RESULTS}/selected/{{study}}.json",
        shards=lambda w: needed(
            file
            for data in plan.studies[w.study].datasets()
            for file in plan.studies[w.study].shard_files(data)
        ),
    output:
        accuracy=f"{RESULTS}/evaluation/{{study}}/accuracy.parquet",
        errors=f"{RESULTS}/evaluation/{{study}}/errors.parquet",
    log:
        f"{RESULTS}/logs/accuracy/{{study}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/accuracy/{{study}}.tsv"
    threads: 1
    resources:
        mem_mb=2000,
        runtime=30,
    params:
        job=job("accuracy", "study"),
        code=code("accuracy"),
        runs=f"{RESULTS}/runs",
        datasets=f"{RESULTS}/datasets/{{study}}",
    message:
        "accuracy of the maps of {wildcards.study}"
    shell:
        "python -m flexsurr accuracy --job {params.job:q} --selection {input.selection:q}"
        " --runs {params.runs:q} --datasets {params.datasets:q} --accuracy {output.accuracy:q}"
        " --errors {output.errors:q} > {log:q} 2>&1"


rule fly:
    input:
        selection=f"{RESULTS}/selected/{{study}}.json",
    output:
        modes=f"{RESULTS}/evaluation/{{study}}/modes.parquet",
        left_out=f"{RESULTS}/evaluation/{{study}}/left_out_modes.parquet",
        elastic_modes=f"{RESULTS}/evaluation/{{study}}/elastic_modes.parquet",
        doublets=f"{RESULTS}/evaluation/{{study}}/doublets.parquet",
        trims=f"{RESULTS}/evaluation/{{study}}/trims.parquet",
    log:
        f"{RESULTS}/logs/fly/{{study}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/fly/{{study}}.tsv"
    threads: 1
    resources:
        mem_mb=2000,
        runtime=60,
    params:
        job=job("fly", "study"),
        code=code("fly"),
        runs=f"{RESULTS}/runs",
    message:
        "trim, modes and doublets of {wildcards.study}"
    shell:
        "python -m flexsurr fly --job {params.job:q} --selection {input.selection:q}"
        " --runs {params.runs:q} --modes {output.modes:q}"
        " --left_out {output.left_out:q} --elastic_modes {output.elastic_modes:q}"
        " --doublets {output.doublets:q} --trims {output.trims:q} > {log:q} 2>&1"


rule fly_references:
    output:
        f"{RESULTS}/evaluation/{{study}}/reference_flights.parquet",
    log:
        f"{RESULTS}/logs/fly_references/{{study}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/fly_references/{{study}}.tsv"
    priority: 20
    threads: 1
    resources:
        mem_mb=2000,
        runtime=60,
    params:
        job=job("fly", "study"),
        code=code("fly-references"),
    message:
        "random flights of {wildcards.study} with the frozen lattice"
    shell:
        "python -m flexsurr fly-references --job {params.job:q} --output {output:q} > {log:q} 2>&1"


rule fly_randomly:
    # It measures time, so it asks for every core: nothing else runs beside it.
    input:
        selection=f"{RESULTS}/selected/{{study}}.json",
        references=rules.fly_references.output,
    output:
        flights=f"{RESULTS}/evaluation/{{study}}/flights.parquet",
        exceedances=f"{RESULTS}/evaluation/{{study}}/exceedances.parquet",
        cost=f"{RESULTS}/evaluation/{{study}}/flight_cost.parquet",
        rows=f"{RESULTS}/evaluation/{{study}}/cost-manoeuvre.parquet",
        limits=f"{RESULTS}/evaluation/{{study}}/limits.parquet",
    log:
        f"{RESULTS}/logs/fly_randomly/{{study}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/fly_randomly/{{study}}.tsv"
    threads: timing_cores
    resources:
        mem_mb=3000,
        runtime=240,
    params:
        job=job("fly", "study"),
        code=code("fly-randomly"),
        runs=f"{RESULTS}/runs",
    message:
        "timing random flights of {wildcards.study}"
    shell:
        "python -m flexsurr fly-randomly --job {params.job:q} --selection {input.selection:q}"
        " --runs {params.runs:q} --references {input.references:q} --flights {output.flights:q}"
        " --exceedances {output.exceedances:q} --cost {output.cost:q} --rows {output.rows:q} --limits {output.limits:q} > {log:q} 2>&1"
