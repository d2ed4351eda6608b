"""Cost, accuracy and energy of any model against any other: models in, DataFrames out.

One function per file of results/evaluation/<study>/:

| file | function |
|---|---|
| statics.parquet | `static_tip` |
| frequencies.parquet | `natural_frequencies` |
| validation.parquet | `validation_table` |
| response-<variant>-<response>.parquet | `response_table` |
| energy-<variant>.parquet | `energy_table` |
| cost-<variant>-<response>.parquet | `cost_table` |
| learned_loads-<variant>.parquet | `learned_load_table` |

and `long_response_errors`, by which training ranks its runs, `held_out_errors` of their fields,
`energy_balance`, and `dissipative_asymmetry`, how far a field is from any D-HNN's. `surrogates` is
always a mapping from the name of an architecture to its fitted surrogate.
"""

from flexsurr.evaluation.contenders import with_learned_loads
from flexsurr.evaluation.cost import cost_table
from flexsurr.evaluation.dissipative_structure import dissipative_asymmetry
from flexsurr.evaluation.energy import energy_table
from flexsurr.evaluation.energy_balance import energy_balance
from flexsurr.evaluation.held_out import held_out_errors
from flexsurr.evaluation.learned_loads import learn_forces, learned_load_table
from flexsurr.evaluation.responses import response_table
from flexsurr.evaluation.selection import long_response_errors, long_responses
from flexsurr.evaluation.statics import natural_frequencies, static_tip
from flexsurr.evaluation.validation import validation_table

__all__ = [
    "cost_table",
    "dissipative_asymmetry",
    "energy_balance",
    "energy_table",
    "held_out_errors",
    "learn_forces",
    "learned_load_table",
    "long_response_errors",
    "long_responses",
    "natural_frequencies",
    "response_table",
    "static_tip",
    "validation_table",
    "with_learned_loads",
]
