# Surrogates: one job a trial, then the choice among them.


rule tracking_store:
    # Two processes that create the store at once ruin it: this job comes before any that writes to it.
    output:
        f"{RESULTS}/mlflow/store.json",
    log:
        f"{RESULTS}/logs/tracking_store.log",
    params:
        job=job("store"),
    message:
        "creating the tracking store"
    shell:
        "python -m flexsurr.cli.store --job {params.job:q} --output {output:q} > {log:q} 2>&1"


rule train:
    # The store is ancient: a new one is no reason to train anew.
    input:
        manifest=lambda w: (
            f"{RESULTS}/datasets/{plan.runs[w.run_id].study}/{plan.runs[w.run_id].data}/manifest.json"
        ),
        store=ancient(rules.tracking_store.output[0]),
    output:
        parameters=f"{RESULTS}/runs/{{run_id}}/parameters.json",
        weights=f"{RESULTS}/runs/{{run_id}}/weights.npz",
        history=f"{RESULTS}/runs/{{run_id}}/history.parquet",
        fit=f"{RESULTS}/runs/{{run_id}}/fit.json",
    log:
        f"{RESULTS}/logs/train/{{run_id}}.log",
    params:
        job=job("train", "run_id"),
        code=code("train"),
        folder=f"{RESULTS}/runs/{{run_id}}",
    message:
        "training {wildcards.run_id}"
    shell:
        "python -m flexsurr.cli.train --job {params.job:q} --manifest {input.manifest:q}"
        " --store {input.store:q} --folder {params.folder:q} > {log:q} 2>&1"


for study in STUDIES:

    rule:
        name:
            f"judge_{study}"
        input:
            fits=expand(
                f"{RESULTS}/runs/{{run_id}}/fit.json", run_id=plan.runs_of(study)
            ),
            weights=expand(
                f"{RESULTS}/runs/{{run_id}}/weights.npz", run_id=plan.runs_of(study)
            ),
            manifests=expand(
                f"{RESULTS}/datasets/{study}/{{variant}}/manifest.json",
                variant=plan.variants(study),
            ),
        output:
            expand(
                f"{RESULTS}/runs/{{run_id}}/metrics.json", run_id=plan.runs_of(study)
            ),
        log:
            f"{RESULTS}/logs/judge/{study}.log",
        params:
            job=json.dumps(plan.judge(study), sort_keys=True),
            code=code("judge"),
            runs=f"{RESULTS}/runs",
        message:
            f"judging the surrogates of {study}"
        shell:
            "python -m flexsurr.cli.judge --job {params.job:q} --runs {params.runs:q}"
            " --manifests {input.manifests:q} > {log:q} 2>&1"


rule select:
    input:
        metrics=lambda w: expand(
            f"{RESULTS}/runs/{{run_id}}/metrics.json", run_id=plan.runs_of(w.study)
        ),
        store=ancient(rules.tracking_store.output[0]),
    output:
        f"{RESULTS}/selected/{{study}}.json",
    log:
        f"{RESULTS}/logs/select/{{study}}.log",
    params:
        job=job("select", "study"),
        code=code("select"),
        runs=f"{RESULTS}/runs",
    message:
        "choosing the surrogates of {wildcards.study}"
    shell:
        "python -m flexsurr.cli.select --job {params.job:q} --runs {params.runs:q}"
        " --store {input.store:q} --output {output:q} > {log:q} 2>&1"
