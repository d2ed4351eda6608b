# Surrogates: one job a trial, its score, then the choice among them.

# Runs are recorded here for the page on which they are compared. It is no input of any job: an address
# decides nothing, and Snakemake passes over whatever depends on an `ancient` file that it makes again.
STORE = f"{RESULTS}/mlflow/store.json"


onstart:
    # Two processes that create the store at once ruin it: it is there before the first job.
    tracked = write("store", plan.store())
    shell("python -m flexsurr store --job {tracked:q} --output {STORE:q}")


def run_command(rule, wildcards):
    """The command by which `rule` makes a run: one for fields, one for maps."""
    return plan.study_of(wildcards.run_id).command(rule)


rule train:
    input:
        data=lambda w: expand(
            f"{RESULTS}/{{file}}", file=plan.study_of(w.run_id).trains_on(w.run_id)
        ),
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
    threads: 1
    resources:
        mem_mb=3000,
        runtime=720,
    params:
        job=job("train", "run_id"),
        command=lambda w: run_command("train", w),
        code=lambda w: code(run_command("train", w)),
        data=lambda w, input: sorted({os.path.dirname(file) for file in input.data}),
        folder=f"{RESULTS}/runs/{{run_id}}",
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
        manifest=lambda w: expand(
            f"{RESULTS}/{{file}}", file=plan.study_of(w.run_id).scored_on(w.run_id)
        ),
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
        command=lambda w: run_command("score", w),
        code=lambda w: code(run_command("score", w)),
    message:
        "scoring {wildcards.run_id}"
    shell:
        "python -m flexsurr {params.command} --job {params.job:q} --fit {input.fit:q} --weights {input.weights:q}"
        " --best {input.best:q} --manifest {input.manifest:q} --output {output:q} > {log:q} 2>&1"


rule select:
    input:
        metrics=lambda w: expand(
            f"{RESULTS}/runs/{{run_id}}/metrics.json",
            run_id=plan.studies[w.study].runs,
        ),
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
        store=STORE,
    message:
        "choosing the surrogates of {wildcards.study}"
    shell:
        "python -m flexsurr select --job {params.job:q} --runs {params.runs:q}"
        " --store {params.store:q} --output {output:q} > {log:q} 2>&1"
