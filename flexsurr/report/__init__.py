"""Result files -> figures and tables.

`catalogue` lists what there is and what each reads, `figures` and `tables` hold the functions that make it.

    figure = DRAW["figure_10"](pd.read_parquet(...))
    save(figure, results / "figures" / "figure_10")
"""
