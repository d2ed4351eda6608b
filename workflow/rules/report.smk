# Figures and tables, each with a caption that says what to see.

from flexsurr.report.catalogue import FIGURES, TABLES


rule draw:
    input:
        lambda w: needed(plan.read_by(w.study, FIGURES[w.figure])),
    output:
        svg=report(
            f"{RESULTS}/figures/{{study}}/{{figure}}.svg",
            caption="../report/product.rst",
            category="{study}",
            subcategory="figures",
            labels=lambda w: {"figure": w.figure, "shows": FIGURES[w.figure].title},
        ),
        png=f"{RESULTS}/figures/{{study}}/{{figure}}.png",
    log:
        f"{RESULTS}/logs/draw/{{study}}-{{figure}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/draw/{{study}}-{{figure}}.tsv"
    threads: 1
    resources:
        mem_mb=1000,
        runtime=30,
    params:
        job=job("draw", "study", "figure"),
        code=code("draw"),
        caption=lambda w: caption(w.figure),
        results=lambda w: RESULTS,
    message:
        "drawing {wildcards.figure} of {wildcards.study}"
    shell:
        "python -m flexsurr draw --job {params.job:q} --results {params.results:q} --output {output.svg:q}"
        " > {log:q} 2>&1"


rule tabulate:
    input:
        lambda w: needed(plan.read_by(w.study, TABLES[w.table])),
        caption=lambda w: caption_file(w.table),
    output:
        html=report(
            f"{RESULTS}/tables/{{study}}/{{table}}.html",
            caption="../report/product.rst",
            category="{study}",
            subcategory="tables",
            labels=lambda w: {"table": w.table, "shows": TABLES[w.table].title},
        ),
        csv=f"{RESULTS}/tables/{{study}}/{{table}}.csv",
    log:
        f"{RESULTS}/logs/tabulate/{{study}}-{{table}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/tabulate/{{study}}-{{table}}.tsv"
    threads: 1
    resources:
        mem_mb=1000,
        runtime=30,
    params:
        job=job("tabulate", "study", "table"),
        code=code("tabulate"),
        caption=lambda w: caption(w.table),
        results=lambda w: RESULTS,
    message:
        "tabulating {wildcards.table} of {wildcards.study}"
    shell:
        "python -m flexsurr tabulate --job {params.job:q} --results {params.results:q}"
        " --caption {input.caption:q} --output {output.html:q} > {log:q} 2>&1"


# The tables that any study has.
ALL_TABLES = list(
    dict.fromkeys(name for study in STUDIES for name in plan.tables(study))
)


rule join:
    input:
        [
            f"{RESULTS}/tables/{study}/{name}.csv"
            for study in STUDIES
            for name in plan.tables(study)
        ],
    output:
        expand(f"{RESULTS}/tables/{{name}}.csv", name=ALL_TABLES),
    log:
        f"{RESULTS}/logs/join.log",
    benchmark:
        f"{RESULTS}/benchmarks/join.tsv"
    threads: 1
    resources:
        mem_mb=1000,
        runtime=30,
    params:
        job=lambda w: write("join", {}),
        code=code("join"),
        folder=lambda w, output: os.path.dirname(output[0]),
    message:
        "joining the tables of all studies"
    shell:
        "python -m flexsurr join --job {params.job:q} --inputs {input:q} --folder {params.folder:q} > {log:q} 2>&1"


# The page that the report opens with; there is none where nothing has a reference to be compared with.
rule answer:
    input:
        cost=f"{RESULTS}/tables/cost.csv",
        caption=caption_file("answer"),
    output:
        page=report(
            f"{RESULTS}/answer.html",
            caption="../report/product.rst",
            category="answer",
            labels={"shows": "When does a surrogate pay?"},
        ),
        frame=f"{RESULTS}/answer-frame.html",
        table=f"{RESULTS}/tables/answer.csv",
        figure=f"{RESULTS}/figures/answer.svg",
        picture=f"{RESULTS}/figures/answer.png",
    log:
        f"{RESULTS}/logs/answer.log",
    benchmark:
        f"{RESULTS}/benchmarks/answer.tsv"
    threads: 1
    resources:
        mem_mb=1000,
        runtime=30,
    params:
        job=lambda w: write("answer", {}),
        code=code("answer"),
        caption=lambda w: caption("answer"),
    message:
        "answering when a surrogate pays"
    shell:
        "python -m flexsurr answer --job {params.job:q} --cost {input.cost:q} --caption {input.caption:q}"
        " --table {output.table:q} --figure {output.figure:q} --output {output.page:q}"
        " --frame {output.frame:q} > {log:q} 2>&1"


if taken := sorted({*STUDIES} & {"all", *(made.name for made in workflow.rules)}):
    raise WorkflowError(
        f"config/config.yaml: studies: {taken[0]!r} is the name of a rule; give the study another"
    )


for study in STUDIES:

    rule:
        # Everything of one study: snakemake <study>
        name:
            study
        input:
            expand(f"{RESULTS}/figures/{study}/{{name}}.svg", name=plan.figures(study)),
            expand(f"{RESULTS}/tables/{study}/{{name}}.html", name=plan.tables(study)),
