# The selected surrogates against the reference: what they are worth, and what they cost.


rule responses:
    input:
        selection=f"{RESULTS}/selected/{{study}}.json",
    output:
        free=f"{RESULTS}/evaluation/{{study}}/response-{{variant}}-free.parquet",
        forced=f"{RESULTS}/evaluation/{{study}}/response-{{variant}}-forced.parquet",
        energy=f"{RESULTS}/evaluation/{{study}}/energy-{{variant}}.parquet",
    log:
        f"{RESULTS}/logs/responses/{{study}}-{{variant}}.log",
    params:
        job=job("respond", "study", "variant"),
        code=code("respond"),
        runs=f"{RESULTS}/runs",
    message:
        "responses and energies of {wildcards.study}, {wildcards.variant}"
    shell:
        "python -m flexsurr.cli.respond --job {params.job:q} --selection {input.selection:q}"
        " --runs {params.runs:q} --free {output.free:q} --forced {output.forced:q}"
        " --energy {output.energy:q} > {log:q} 2>&1"


rule evaluate:
    # It measures time, so it asks for every core: nothing else runs beside it.
    input:
        selection=f"{RESULTS}/selected/{{study}}.json",
    output:
        f"{RESULTS}/evaluation/{{study}}/cost-{{variant}}-{{response}}.parquet",
    log:
        f"{RESULTS}/logs/evaluate/{{study}}-{{variant}}-{{response}}.log",
    threads: plan.settings.timing.cores or workflow.cores or 1
    params:
        job=job("cost", "study", "variant", "response"),
        code=code("evaluate"),
        runs=f"{RESULTS}/runs",
    message:
        "timing the {wildcards.response} response of {wildcards.study}, {wildcards.variant}"
    shell:
        "python -m flexsurr.cli.evaluate --job {params.job:q} --selection {input.selection:q}"
        " --runs {params.runs:q} --output {output:q} > {log:q} 2>&1"
