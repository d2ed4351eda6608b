# Figures and tables, each with a caption that says what to see. One start of Python makes all that show what
# one rule has made, for it takes longer than a figure does. Which they are follows from the study: hence loops.

from flexsurr.report.catalogue import FIGURES, TABLES

for study in STUDIES:
    for shown, names in plan.made_together(study, FIGURES).items():

        rule:
            # Figures of one study that show what one rule has made.
            name:
                f"draw_{study}_{shown}"
            input:
                needed(plan.shown(study, FIGURES, names)),
            output:
                svg=[
                    report(
                        f"{RESULTS}/figures/{{study}}/{figure}.svg",
                        caption=f"../report/{figure}.rst",
                        category="{study}",
                        subcategory="figures",
                        labels={"figure": figure, "shows": FIGURES[figure].title},
                    )
                    for figure in names
                ],
                png=[f"{RESULTS}/figures/{{study}}/{figure}.png" for figure in names],
            log:
                f"{RESULTS}/logs/draw/{{study}}-{shown}.log",
            benchmark:
                f"{RESULTS}/benchmarks/draw/{{study}}-{shown}.tsv"
            wildcard_constraints:
                study=study,
            group:
                "figures-{study}"
            threads: 1
            resources:
                mem_mb=1000,
                runtime=30,
            params:
                job=job("draw", "study", ending=shown),
                code=code("draw"),
                results=lambda w: RESULTS,
                folder=lambda w, output: os.path.dirname(output[0]),
            message:
                f"drawing {len(names)} of the figures of {study}: {shown}"
            shell:
                "python -m flexsurr draw --job {params.job:q} --results {params.results:q}"
                " --folder {params.folder:q} > {log:q} 2>&1"

    for shown, names in plan.made_together(study, TABLES).items():

        rule:
            # Tables of one study that show what one rule has made.
            name:
                f"tabulate_{study}_{shown}"
            input:
                needed(plan.shown(study, TABLES, names)),
                captions=[caption_file(table) for table in names],
            output:
                html=[
                    report(
                        f"{RESULTS}/tables/{{study}}/{table}.html",
                        caption=f"../report/{table}.rst",
                        category="{study}",
                        subcategory="tables",
                        labels={"table": table, "shows": TABLES[table].title},
                    )
                    for table in names
                ],
                csv=[f"{RESULTS}/tables/{{study}}/{table}.csv" for table in names],
            log:
                f"{RESULTS}/logs/tabulate/{{study}}-{shown}.log",
            benchmark:
                f"{RESULTS}/benchmarks/tabulate/{{study}}-{shown}.tsv"
            wildcard_constraints:
                study=study,
            group:
                "tables-{study}"
            threads: 1
            resources:
                mem_mb=1000,
                runtime=30,
            params:
                job=job("tabulate", "study", ending=shown),
                code=code("tabulate"),
                results=lambda w: RESULTS,
                folder=lambda w, output: os.path.dirname(output[0]),
            message:
                f"tabulating {len(names)} of the tables of {study}: {shown}"
            shell:
                "python -m flexsurr tabulate --job {params.job:q} --results {params.results:q}"
                " --captions {input.captions:q} --folder {params.folder:q} > {log:q} 2>&1"


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
            caption="../report/answer.rst",
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
    message:
        "answering when a surrogate pays"
    shell:
        "python -m flexsurr answer --job {params.job:q} --cost {input.cost:q} --caption {input.caption:q}"
        " --table {output.table:q} --figure {output.figure:q} --output {output.page:q}"
        " --frame {output.frame:q} > {log:q} 2>&1"


for study in STUDIES:

    rule:
        # Everything of one study: snakemake <study>
        name:
            study
        input:
            expand(f"{RESULTS}/figures/{study}/{{name}}.svg", name=plan.figures(study)),
            expand(f"{RESULTS}/tables/{study}/{{name}}.html", name=plan.tables(study)),
            # a run that has been deleted comes back
            needed(plan.files(study, "metrics")),
