"""Cost, accuracy and energy of any model against any other: models in, DataFrames out.

One function per file of results/evaluation/<study>/:

| file | function |
|---|---|
| statics.parquet | `statics.static_tip` |
| frequencies.parquet | `statics.natural_frequencies` |
| validation.parquet | `validation.validation_table` |
| response-<variant>-<response>.parquet | `responses.response_table` |
| energy-<variant>.parquet | `energy.energy_table` |
| cost-<variant>-<response>.parquet | `cost.cost_table` |
| learned_loads-<variant>.parquet | `learned_loads.learned_load_table` |
| rivals-<modes>.parquet | `rivals.rivals_table` |

and `scores.long_response_errors`, by which runs are ranked (`selection`), `scores.held_out_errors` of their
fields, `energy.energy_balance`, and `dissipative_structure.dissipative_asymmetry`, how far a field
is from any D-HNN's. `surrogates` is always a mapping from the name of an architecture to its fitted
surrogate.
"""
