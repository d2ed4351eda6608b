# Surrogates: one job a trial, its score, then the choice among them.

# Runs are recorded here for the page on which they are compared. It is no input of any job: an address
# decides nothing, and Snakemake passes over whatever depends on an `ancient` file that it makes again.
STORE = f"{RESULTS}/mlflow/store.json"


onstart:
    # Two processes that create the store at once ruin it: it is there before the first job.
    tracked = write("store", plan.store())
    shell("python -m flexsurr store --job {tracked:q} --output {STORE:q}")


# What no job could log: scores, figures, the chosen surrogates. It says what the page lacks.
onsuccess:
    shell("python -m flexsurr track --results {RESULTS:q} || true")


onerror:
    shell("python -m flexsurr track --results {RESULTS:q} || true")


rule train:
    input:
        data=lambda w: needed(plan.study_of(w.run_id).trains_on(w.run_id)),
    output:
        parameters=f"{RESULTS}/runs/{{run_id}}/parameters.json",
        weights=f"{RESULTS}/runs/{{run_id}}/weights.npz",
        best=f"{RESULTS}/runs/{{run_id}}/best.npz",
        history=f"{RESULTS}/runs/{{run_id}}/history.parquet",
        fit=f"{RESULTS}/runs/{{run_id}}/fit.json",
    log:
        f"{RESULTS}/logs/train/{{run_id}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/train/{{run_id}}.tsv"
    priority: 20
    threads: 1
    resources:
        mem_mb=3000,
        runtime=720,
    params:
        job=job("train", "run_id"),
        command=lambda w: plan.study_of(w.run_id).command("train"),
        code=lambda w: code(plan.study_of(w.run_id).command("train")),
        data=lambda w, input: sorted({os.path.dirname(file) for file in input.data}),
        folder=lambda w, output: os.path.dirname(output.weights),
        store=STORE,
    message:
        "training {wildcards.run_id}"
    shell:
        "python -m flexsurr {params.command} --job {params.job:q} --data {params.data:q}"
        " --store {params.store:q} --folder {params.folder:q} > {log:q} 2>&1"


rule score:
    input:
        fit=rules.train.output.fit,
        weights=rules.train.output.weights,
        best=rules.train.output.best,
        manifest=lambda w: needed(plan.study_of(w.run_id).scored_on(w.run_id)),
    output:
        f"{RESULTS}/runs/{{run_id}}/metrics.json",
    log:
        f"{RESULTS}/logs/score/{{run_id}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/score/{{run_id}}.tsv"
    threads: 1
    resources:
        mem_mb=2000,
        runtime=60,
    params:
        job=job("score", "run_id"),
        command=lambda w: plan.study_of(w.run_id).command("score"),
        code=lambda w: code(plan.study_of(w.run_id).command("score")),
    message:
        "scoring {wildcards.run_id}"
    shell:
        "python -m flexsurr {params.command} --job {params.job:q} --fit {input.fit:q} --weights {input.weights:q}"
        " --best {input.best:q} --manifest {input.manifest:q} --output {output:q} > {log:q} 2>&1"


rule trials:
    # Where there are many: training and score of each, one trial after another. What is there stays.
    input:
        data=lambda w: needed(plan.read_by_trials(w.study, w.batch)),
    output:
        f"{RESULTS}/batches/{{study}}/trials-{{batch}}.json",
    log:
        f"{RESULTS}/logs/trials/{{study}}-{{batch}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/trials/{{study}}-{{batch}}.tsv"
    priority: 10
    threads: 1
    resources:
        mem_mb=3000,
        runtime=720,
    params:
        job=job("batch_of_trials", "study", "batch"),
        command=lambda w: plan.studies[w.study].command("trials"),
        code=lambda w: code(plan.studies[w.study].command("trials")),
        results=lambda w: RESULTS,
        store=STORE,
        trials=lambda w: len(plan.trial_batches[w.study][w.batch]),
    message:
        "training {params.trials} trials of {wildcards.study}: batch {wildcards.batch}"
    shell:
        "python -m flexsurr {params.command} --job {params.job:q} --results {params.results:q}"
        " --store {params.store:q} --output {output:q} > {log:q} 2>&1"


rule select:
    input:
        metrics=lambda w: needed(plan.files(w.study, "metrics")),
    output:
        f"{RESULTS}/selected/{{study}}.json",
    log:
        f"{RESULTS}/logs/select/{{study}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/select/{{study}}.tsv"
    threads: 1
    resources:
        mem_mb=1000,
        runtime=30,
    params:
        job=job("select", "study"),
        code=code("select"),
        runs=f"{RESULTS}/runs",
    message:
        "choosing the surrogates of {wildcards.study}"
    shell:
        "python -m flexsurr select --job {params.job:q} --runs {params.runs:q}"
        " --output {output:q} > {log:q} 2>&1"
