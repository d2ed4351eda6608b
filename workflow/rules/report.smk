# Figures and tables, each with a caption that says what to see.

from flexsurr.report import FIGURES, TABLES

for study in STUDIES:
    drawn = {name: FIGURES[name].reads for name in plan.figures(study)}
    for reads in dict.fromkeys(drawn.values()):
        same = [name for name, read in drawn.items() if read == reads]

        rule:
            name:
                f"draw_{study}_{'_'.join(same)}"
            input:
                [
                    f"{RESULTS}/{file}"
                    for read in reads
                    for file in plan.files(study, read)
                ],
            output:
                *(
                    report(
                        f"{RESULTS}/figures/{study}/{name}.svg",
                        caption=f"../report/{name}.rst",
                        category=study,
                        subcategory="figures",
                        labels={"figure": name, "shows": FIGURES[name].title},
                    )
                    for name in same
                ),
                *(f"{RESULTS}/figures/{study}/{name}.png" for name in same),
            log:
                f"{RESULTS}/logs/figures/{study}-{'-'.join(same)}.log",
            params:
                job=json.dumps(plan.draw(study, same, reads), sort_keys=True),
                code=code("figures"),
                folder=f"{RESULTS}/figures/{study}",
            message:
                f"drawing {', '.join(same)} of {study}"
            shell:
                "python -m flexsurr.cli.figures --job {params.job:q} --inputs {input:q}"
                " --folder {params.folder:q} > {log:q} 2>&1"


for table in TABLES:
    for study in STUDIES:

        rule:
            name:
                f"tabulate_{study}_{table}"
            input:
                files=[
                    f"{RESULTS}/{file}"
                    for read in TABLES[table].reads
                    for file in plan.files(study, read)
                ],
                caption=os.path.relpath(
                    f"{workflow.basedir}/workflow/report/{table}.rst"
                ),
            output:
                csv=f"{RESULTS}/tables/{study}/{table}.csv",
                page=report(
                    f"{RESULTS}/tables/{study}/{table}.html",
                    caption=f"../report/{table}.rst",
                    category=study,
                    subcategory="tables",
                    labels={"table": table, "shows": TABLES[table].title},
                ),
            log:
                f"{RESULTS}/logs/tables/{study}-{table}.log",
            params:
                job=json.dumps({"table": table}),
                code=code("table"),
            message:
                f"tabulating {table} of {study}"
            shell:
                "python -m flexsurr.cli.table --job {params.job:q} --inputs {input.files:q}"
                " --caption {input.caption:q} --csv {output.csv:q} --page {output.page:q} > {log:q} 2>&1"

    rule:
        name:
            f"join_{table}"
        input:
            expand(
                f"{RESULTS}/tables/{{study}}/{table}.csv",
                study=(
                    [*STUDIES, "airliner"] if table == "cost" and AIRLINER else STUDIES
                ),
            ),
        output:
            f"{RESULTS}/tables/{table}.csv",
        log:
            f"{RESULTS}/logs/tables/{table}.log",
        params:
            job="{}",
            code=code("join"),
        message:
            f"joining {table} of all studies"
        shell:
            "python -m flexsurr.cli.join --job {params.job:q} --inputs {input:q} --output {output:q}"
            " > {log:q} 2>&1"
