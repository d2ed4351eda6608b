# Reference data: shards of trajectories or samples, the manifest of trajectories; statics; full against reduced order.


wildcard_constraints:
    study="|".join(STUDIES),
    variant="hamiltonian|as_printed|files",
    data=r"(hamiltonian|as_printed)(-\w+)?|files|(pseudo_random|sobol)(-linear_in_modes)?",
    shard=r"\d+",
    batch=r"\d+-of-\d+",


rule ingest:
    input:
        lambda w: plan.studies[w.study].sources,
    output:
        f"{RESULTS}/datasets/{{study}}/files/shard-0000.parquet",
    log:
        f"{RESULTS}/logs/ingest/{{study}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/ingest/{{study}}.tsv"
    threads: 1
    resources:
        mem_mb=4000,
        runtime=60,
    params:
        job=job("ingest", "study"),
        code=code("ingest"),
    message:
        "reading the files of {wildcards.study}"
    shell:
        "python -m flexsurr ingest --job {params.job:q} --output {output:q} > {log:q} 2>&1"


rule simulate:
    output:
        f"{RESULTS}/datasets/{{study}}/{{data}}/shard-{{shard}}.parquet",
    log:
        f"{RESULTS}/logs/simulate/{{study}}-{{data}}-{{shard}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/simulate/{{study}}-{{data}}-{{shard}}.tsv"
    wildcard_constraints:
        data=r"(hamiltonian|as_printed)(-\w+)?|(pseudo_random|sobol)(-linear_in_modes)?",
    priority: 30
    threads: 1
    resources:
        mem_mb=2000,
        runtime=60,
    params:
        job=job("simulate", "study", "data", "shard"),
        command=lambda w: plan.studies[w.study].command("simulate"),
        code=lambda w: code(plan.studies[w.study].command("simulate")),
    message:
        "simulating shard {wildcards.shard} of {wildcards.study}, {wildcards.data}"
    shell:
        "python -m flexsurr {params.command} --job {params.job:q} --output {output:q} > {log:q} 2>&1"


rule shards:
    # Where there are many: each is written as soon as it is made, and made once.
    output:
        f"{RESULTS}/datasets/{{study}}/{{data}}/shards-{{batch}}.json",
    log:
        f"{RESULTS}/logs/shards/{{study}}-{{data}}-{{batch}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/shards/{{study}}-{{data}}-{{batch}}.tsv"
    priority: 30
    threads: 1
    resources:
        mem_mb=2000,
        runtime=360,
    params:
        job=job("shards", "study", "data", "batch"),
        command=lambda w: plan.studies[w.study].command("shards"),
        code=lambda w: code(plan.studies[w.study].command("shards")),
        results=lambda w: RESULTS,
    message:
        "simulating shards of {wildcards.study}, {wildcards.data}: batch {wildcards.batch}"
    shell:
        "python -m flexsurr {params.command} --job {params.job:q} --results {params.results:q}"
        " --output {output:q} > {log:q} 2>&1"


rule manifest:
    input:
        shards=lambda w: needed(plan.studies[w.study].shard_files(w.data)),
    output:
        f"{RESULTS}/datasets/{{study}}/{{data}}/manifest.json",
    log:
        f"{RESULTS}/logs/manifest/{{study}}-{{data}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/manifest/{{study}}-{{data}}.tsv"
    threads: 1
    resources:
        mem_mb=1000,
        runtime=30,
    params:
        job=job("manifest", "study", "data"),
        code=code("manifest"),
        folder=lambda w, output: os.path.dirname(output[0]),
    message:
        "checking the dataset of {wildcards.study}, {wildcards.data}"
    shell:
        "python -m flexsurr manifest --job {params.job:q} --folder {params.folder:q} --output {output:q}"
        " > {log:q} 2>&1"


rule statics:
    output:
        statics=f"{RESULTS}/evaluation/{{study}}/statics.parquet",
        frequencies=f"{RESULTS}/evaluation/{{study}}/frequencies.parquet",
        shapes=f"{RESULTS}/evaluation/{{study}}/shapes.parquet",
    log:
        f"{RESULTS}/logs/statics/{{study}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/statics/{{study}}.tsv"
    threads: 1
    resources:
        mem_mb=1000,
        runtime=30,
    params:
        job=job("statics", "study"),
        code=code("statics"),
    message:
        "static deflection, frequencies and shapes of {wildcards.study}"
    shell:
        "python -m flexsurr statics --job {params.job:q}"
        " --statics {output.statics:q} --frequencies {output.frequencies:q} --shapes {output.shapes:q}"
        " > {log:q} 2>&1"


rule validation:
    output:
        f"{RESULTS}/evaluation/{{study}}/validation.parquet",
    log:
        f"{RESULTS}/logs/validation/{{study}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/validation/{{study}}.tsv"
    threads: 1
    resources:
        mem_mb=1000,
        runtime=30,
    params:
        job=job("validation", "study"),
        code=code("validate"),
    message:
        "full and reduced order of {wildcards.study} side by side"
    shell:
        "python -m flexsurr validate --job {params.job:q} --output {output:q} > {log:q} 2>&1"
