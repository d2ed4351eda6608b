# The selected surrogates against the reference: what they are worth, and what they cost.


rule responses:
    input:
        selection=f"{RESULTS}/selected/{{study}}.json",
    output:
        free=f"{RESULTS}/evaluation/{{study}}/response-{{variant}}-free.parquet",
        forced=f"{RESULTS}/evaluation/{{study}}/response-{{variant}}-forced.parquet",
        sustained=f"{RESULTS}/evaluation/{{study}}/response-{{variant}}-sustained.parquet",
        energy=f"{RESULTS}/evaluation/{{study}}/energy-{{variant}}.parquet",
    log:
        f"{RESULTS}/logs/responses/{{study}}-{{variant}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/responses/{{study}}-{{variant}}.tsv"
    threads: 1
    resources:
        mem_mb=2000,
        runtime=60,
    params:
        job=job("respond", "study", "variant"),
        code=code("respond"),
        runs=f"{RESULTS}/runs",
    message:
        "responses and energies of {wildcards.study}, {wildcards.variant}"
    shell:
        "python -m flexsurr respond --job {params.job:q} --selection {input.selection:q}"
        " --runs {params.runs:q} --free {output.free:q} --forced {output.forced:q}"
        " --sustained {output.sustained:q} --energy {output.energy:q} > {log:q} 2>&1"


rule learn_load:
    input:
        lambda w: (
            f"{RESULTS}/datasets/{w.study}/{plan.studies[w.study].load_data(w.variant)}/manifest.json"
        ),
    output:
        polynomial=f"{RESULTS}/evaluation/{{study}}/{{variant}}/learned_load.npz",
        network=f"{RESULTS}/evaluation/{{study}}/{{variant}}/network_load.npz",
        errors=f"{RESULTS}/evaluation/{{study}}/learned_loads-{{variant}}.parquet",
    log:
        f"{RESULTS}/logs/learn_load/{{study}}-{{variant}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/learn_load/{{study}}-{{variant}}.tsv"
    threads: 1
    resources:
        mem_mb=4000,
        runtime=60,
    params:
        job=job("learn_load", "study", "variant"),
        code=code("learn-load"),
    message:
        "learning the load of {wildcards.study}, {wildcards.variant}"
    shell:
        "python -m flexsurr learn-load --job {params.job:q} --manifest {input:q}"
        " --polynomial {output.polynomial:q} --network {output.network:q} --errors {output.errors:q}"
        " > {log:q} 2>&1"


rule rehearse:
    # It compiles what is timed, beside other jobs: a job that measures time keeps all cores waiting.
    input:
        selection=f"{RESULTS}/selected/{{study}}.json",
        loads=learned_loads,
    output:
        f"{RESULTS}/evaluation/{{study}}/rehearsed-{{variant}}.parquet",
    log:
        f"{RESULTS}/logs/rehearse/{{study}}-{{variant}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/rehearse/{{study}}-{{variant}}.tsv"
    priority: 10
    threads: 1
    resources:
        mem_mb=2000,
        runtime=60,
    params:
        job=job("rehearse", "study", "variant"),
        code=code("rehearse"),
        runs=f"{RESULTS}/runs",
    message:
        "compiling what is timed of {wildcards.study}, {wildcards.variant}"
    shell:
        "python -m flexsurr rehearse --job {params.job:q} --selection {input.selection:q}"
        " --runs {params.runs:q} --loads {input.loads:q} --output {output:q} > {log:q} 2>&1"


rule evaluate:
    # It measures time, so it asks for every core: nothing else runs beside it.
    input:
        rules.rehearse.output,
        selection=f"{RESULTS}/selected/{{study}}.json",
        loads=learned_loads,
    output:
        free=f"{RESULTS}/evaluation/{{study}}/cost-{{variant}}-free.parquet",
        forced=f"{RESULTS}/evaluation/{{study}}/cost-{{variant}}-forced.parquet",
    log:
        f"{RESULTS}/logs/evaluate/{{study}}-{{variant}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/evaluate/{{study}}-{{variant}}.tsv"
    threads: timing_cores
    resources:
        mem_mb=2000,
        runtime=240,
    params:
        job=job("cost", "study", "variant"),
        code=code("evaluate"),
        runs=f"{RESULTS}/runs",
    message:
        "timing responses of {wildcards.study}, {wildcards.variant}"
    shell:
        "python -m flexsurr evaluate --job {params.job:q} --selection {input.selection:q}"
        " --runs {params.runs:q} --loads {input.loads:q} --free {output.free:q} --forced {output.forced:q}"
        " > {log:q} 2>&1"


rule rivals:
    # It measures time, so it asks for every core: nothing else runs beside it.
    input:
        lambda w: needed(
            f"runs/{key}/metrics.json"
            for key in plan.job("rivals", w.study, w.modes)["runs"]
        ),
    output:
        f"{RESULTS}/evaluation/{{study}}/rivals-{{modes}}.parquet",
    log:
        f"{RESULTS}/logs/rivals/{{study}}-{{modes}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/rivals/{{study}}-{{modes}}.tsv"
    wildcard_constraints:
        modes=r"\d+",
    threads: timing_cores
    resources:
        mem_mb=2000,
        runtime=240,
    params:
        job=job("rivals", "study", "modes"),
        code=code("rivals"),
        runs=f"{RESULTS}/runs",
    message:
        "timing what stands for {wildcards.modes} modes of {wildcards.study}"
    shell:
        "python -m flexsurr rivals --job {params.job:q} --runs {params.runs:q}"
        " --output {output:q} > {log:q} 2>&1"


rule rollouts:
    input:
        selection=f"{RESULTS}/selected/{{study}}.json",
        manifest=f"{RESULTS}/datasets/{{study}}/files/manifest.json",
    output:
        table=f"{RESULTS}/evaluation/{{study}}/rollouts.parquet",
        curves=f"{RESULTS}/evaluation/{{study}}/rollout_curves.parquet",
    log:
        f"{RESULTS}/logs/rollouts/{{study}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/rollouts/{{study}}.tsv"
    threads: 1
    resources:
        mem_mb=2000,
        runtime=60,
    params:
        job=job("rollouts", "study"),
        code=code("rollouts"),
        runs=f"{RESULTS}/runs",
    message:
        "surrogates of {wildcards.study} beside held-out trajectories"
    shell:
        "python -m flexsurr rollouts --job {params.job:q} --selection {input.selection:q}"
        " --runs {params.runs:q} --manifest {input.manifest:q} --table {output.table:q}"
        " --curves {output.curves:q} > {log:q} 2>&1"


rule rollout_cost:
    # It measures time, so it asks for every core: nothing else runs beside it.
    input:
        selection=f"{RESULTS}/selected/{{study}}.json",
        manifest=f"{RESULTS}/datasets/{{study}}/files/manifest.json",
    output:
        f"{RESULTS}/evaluation/{{study}}/rollout_cost.parquet",
    log:
        f"{RESULTS}/logs/rollout_cost/{{study}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/rollout_cost/{{study}}.tsv"
    threads: timing_cores
    resources:
        mem_mb=2000,
        runtime=240,
    params:
        job=job("rollout_cost", "study"),
        code=code("rollout-cost"),
        runs=f"{RESULTS}/runs",
    message:
        "timing rollouts of {wildcards.study}"
    shell:
        "python -m flexsurr rollout-cost --job {params.job:q} --selection {input.selection:q}"
        " --runs {params.runs:q} --manifest {input.manifest:q} --output {output:q} > {log:q} 2>&1"


# No figure of the report: ask for the file, snakemake results/animations/<study>-<variant>.gif (or .html).
rule watch:
    input:
        selection=f"{RESULTS}/selected/{{study}}.json",
    output:
        f"{RESULTS}/animations/{{study}}-{{variant}}.{{ending}}",
    log:
        f"{RESULTS}/logs/watch/{{study}}-{{variant}}-{{ending}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/watch/{{study}}-{{variant}}-{{ending}}.tsv"
    wildcard_constraints:
        ending="gif|html",
    threads: 1
    resources:
        mem_mb=2000,
        runtime=30,
    params:
        job=job("watch", "study", "variant"),
        code=code("watch"),
        runs=f"{RESULTS}/runs",
    message:
        "animating {wildcards.study}, {wildcards.variant}"
    shell:
        "python -m flexsurr watch --job {params.job:q} --selection {input.selection:q}"
        " --runs {params.runs:q} --output {output:q} > {log:q} 2>&1"
