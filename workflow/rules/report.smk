# Figures and tables, each with a caption that says what to see.

from flexsurr.report.catalogue import FIGURES, TABLES, by_reads

for study in STUDIES:
    for reads, same in by_reads(
        {name: FIGURES[name] for name in plan.figures(study)}
    ).items():

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

    for reads, same in by_reads(TABLES).items():

        rule:
            name:
                f"tabulate_{study}_{'_'.join(same)}"
            input:
                files=[
                    f"{RESULTS}/{file}"
                    for read in reads
                    for file in plan.files(study, read)
                ],
                captions=[
                    os.path.relpath(f"{workflow.basedir}/workflow/report/{name}.rst")
                    for name in same
                ],
            output:
                expand(f"{RESULTS}/tables/{study}/{{name}}.csv", name=same),
                *(
                    report(
                        f"{RESULTS}/tables/{study}/{name}.html",
                        caption=f"../report/{name}.rst",
                        category=study,
                        subcategory="tables",
                        labels={"table": name, "shows": TABLES[name].title},
                    )
                    for name in same
                ),
            log:
                f"{RESULTS}/logs/tables/{study}-{'-'.join(same)}.log",
            params:
                job=json.dumps({"tables": same}),
                code=code("tables"),
                folder=f"{RESULTS}/tables/{study}",
            message:
                f"tabulating {', '.join(same)} of {study}"
            shell:
                "python -m flexsurr.cli.tables --job {params.job:q} --inputs {input.files:q}"
                " --captions {input.captions:q} --folder {params.folder:q} > {log:q} 2>&1"


rule join:
    input:
        expand(f"{RESULTS}/tables/{{study}}/{{name}}.csv", study=STUDIES, name=TABLES),
        f"{RESULTS}/tables/airliner/cost.csv" if AIRLINER else [],
    output:
        expand(f"{RESULTS}/tables/{{name}}.csv", name=TABLES),
    log:
        f"{RESULTS}/logs/tables/join.log",
    params:
        job="{}",
        code=code("join"),
        folder=f"{RESULTS}/tables",
    message:
        "joining the tables of all studies"
    shell:
        "python -m flexsurr.cli.join --job {params.job:q} --inputs {input:q} --folder {params.folder:q}"
        " > {log:q} 2>&1"
