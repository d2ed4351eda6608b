# The airliner: samples of its aerodynamics, and networks that learn them.

airliner = plan.of_samples["airliner"]


# The general rules of a study would make the same files from trajectories.
ruleorder: train_coefficients > train
ruleorder: select_coefficients > select


rule sample_aerodynamics:
    output:
        f"{RESULTS}/datasets/airliner/{{dataset}}/shard-{{shard}}.parquet",
    log:
        f"{RESULTS}/logs/sample_aerodynamics/{{dataset}}-{{shard}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/sample_aerodynamics/{{dataset}}-{{shard}}.tsv"
    wildcard_constraints:
        dataset="(pseudo_random|sobol)(-linear_in_modes)?",
    threads: 1
    resources:
        mem_mb=2000,
        runtime=60,
    params:
        job=lambda w: write(
            f"sample_aerodynamics/{w.dataset}-{w.shard}",
            airliner.sample(w.dataset, w.shard),
        ),
        code=code("sample_aerodynamics"),
    message:
        "sampling the airliner's aerodynamics, {wildcards.dataset}, shard {wildcards.shard}"
    shell:
        "python -m flexsurr sample-aerodynamics --job {params.job:q} --output {output:q}"
        " > {log:q} 2>&1"


rule train_coefficients:
    input:
        shards=lambda w: expand(
            f"{RESULTS}/datasets/airliner/{airliner.runs[w.run_id].dataset}/shard-{{shard:04d}}.parquet",
            shard=range(airliner.shards),
        ),
    output:
        parameters=f"{RESULTS}/runs/{{run_id}}/parameters.json",
        metrics=f"{RESULTS}/runs/{{run_id}}/metrics.json",
        accuracy=f"{RESULTS}/runs/{{run_id}}/accuracy.parquet",
        errors=f"{RESULTS}/runs/{{run_id}}/errors.parquet",
    log:
        f"{RESULTS}/logs/train/{{run_id}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/train_coefficients/{{run_id}}.tsv"
    wildcard_constraints:
        run_id="airliner-.*",
    threads: 1
    resources:
        mem_mb=3000,
        runtime=240,
    params:
        job=lambda w: write(f"train/{w.run_id}", airliner.train(w.run_id)),
        code=code("train_coefficients"),
        folder=f"{RESULTS}/runs/{{run_id}}",
        store=STORE,
    message:
        "training {wildcards.run_id}"
    shell:
        "python -m flexsurr train-coefficients --job {params.job:q} --shards {input.shards:q}"
        " --store {params.store:q} --folder {params.folder:q} > {log:q} 2>&1"


rule select_coefficients:
    input:
        metrics=expand(f"{RESULTS}/runs/{{run_id}}/metrics.json", run_id=airliner.runs),
        accuracy=expand(
            f"{RESULTS}/runs/{{run_id}}/accuracy.parquet", run_id=airliner.runs
        ),
    output:
        selection=f"{RESULTS}/selected/airliner.json",
        table=f"{RESULTS}/tables/airliner_accuracy.csv",
    log:
        f"{RESULTS}/logs/select/airliner.log",
    benchmark:
        f"{RESULTS}/benchmarks/select_coefficients/airliner.tsv"
    threads: 1
    resources:
        mem_mb=1000,
        runtime=30,
    params:
        job=lambda w: write("select/airliner", airliner.select()),
        code=code("select_coefficients"),
        runs=f"{RESULTS}/runs",
        store=STORE,
    message:
        "choosing the network that the airliner flies with"
    shell:
        "python -m flexsurr select-coefficients --job {params.job:q} --runs {params.runs:q}"
        " --store {params.store:q} --output {output.selection:q} --table {output.table:q} > {log:q} 2>&1"
