"""A saved surrogate as MLflow serves it: what goes in, what comes out, and its card.

    import mlflow, pandas
    beam = mlflow.pyfunc.load_model("models:/cantilever-hamiltonian@champion")
    beam.predict(pandas.DataFrame({"eta_1": [0.2], "p_1": [0.0]}), params={"duration_s": 1.0})

MLflow imports this module by its name and calls `_load_pyfunc`; nothing here imports MLflow. What is loaded
are arrays with a JSON header, no code, but for a network of the user's own, whose file has to be here.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from flexsurr.evaluation.selection import ERROR, NMSE
from flexsurr.library import LoadedSurrogate, load_surrogate
from flexsurr.surrogates import Hamiltonian, LearnedMap, SurrogateFileError, load_map

RESPONSE = "response"
"""The column that says to which row of the input a row of a response belongs, counted from 0."""
DURATION_S, STEP_S = 10.0, 0.01


class ServedField:
    """A surrogate of a field: rows of initial states in, their free responses out, one below the other.

    The columns out are `response`, and those of `flexsurr.library.Response.table`. Parameters: duration_s,
    step_s [s].
    """

    defaults: Mapping[str, float] = {"duration_s": DURATION_S, "step_s": STEP_S}
    rows = (
        "Rows of initial states in, their free responses out; `params` may hold duration_s and step_s. "
        "`flexsurr.load_surrogate` takes the same file, and forces on it as well."
    )

    def __init__(self, surrogate: LoadedSurrogate) -> None:
        self._surrogate = surrogate

    @property
    def inputs(self) -> tuple[str, ...]:
        """The states."""
        return self._surrogate.state_names

    @property
    def outputs(self) -> tuple[str, ...]:
        """The columns of a response."""
        saved = self._surrogate.saved
        tip = () if saved.basis is None else ("tip_x_m", "tip_y_m", "tip_z_m", "tip_twist_rad")
        energy = ("energy_J",) if isinstance(saved.surrogate, Hamiltonian) else ()
        return (RESPONSE, "t_s", *self.inputs, *tip, *energy)

    @property
    def example(self) -> pd.DataFrame:
        """One initial state, within the training range."""
        low, high = self._surrogate.saved.low, self._surrogate.saved.high
        return _row(self.inputs, low + 0.625 * (high - low))

    def __str__(self) -> str:
        """What it stands for, and where it was trained."""
        return str(self._surrogate)

    def predict(self, model_input: pd.DataFrame, params: Mapping[str, Any] | None = None) -> pd.DataFrame:
        """The free responses of rows of initial states; warns with `OutOfRange` beyond the training range."""
        wanted = {**self.defaults, **(params or {})}
        tables = []
        for number, state in enumerate(model_input[list(self.inputs)].to_numpy(np.float64)):
            table = self._surrogate.simulate(initial=state, **wanted).table()
            table.insert(0, RESPONSE, float(number))
            tables.append(table)
        return pd.concat(tables, ignore_index=True)


class ServedMap:
    """A learned map y = g(u): rows of inputs in, a row of outputs for each. It has no parameters."""

    defaults: Mapping[str, float] = {}
    rows = "Rows of inputs in, a row of outputs for each."

    def __init__(self, learned: LearnedMap) -> None:
        self._learned = learned

    @property
    def inputs(self) -> tuple[str, ...]:
        """The names of the map's inputs."""
        return self._learned.inputs.names

    @property
    def outputs(self) -> tuple[str, ...]:
        """The names of its outputs."""
        return self._learned.output_names

    @property
    def example(self) -> pd.DataFrame:
        """One row of inputs, within the intervals of the training."""
        inputs = self._learned.inputs
        return _row(self.inputs, inputs.origin + 0.25 * inputs.half)

    def __str__(self) -> str:
        """What it is made of, and where it was trained."""
        learned, inputs = self._learned, self._learned.inputs
        width = max(map(len, self.inputs))
        return "\n".join(
            [
                f"{learned.form}, {learned.parameter_count} parameters: "
                f"{len(self.outputs)} outputs of {len(self.inputs)} inputs",
                "trained with",
                *(
                    f"  {name:<{width}}  {low:.4g} to {high:.4g}"
                    for name, low, high in zip(inputs.names, inputs.low, inputs.high, strict=True)
                ),
            ]
        )

    def predict(self, model_input: pd.DataFrame, params: Mapping[str, Any] | None = None) -> pd.DataFrame:
        """The outputs at rows of inputs, which are found by their names."""
        u = model_input[list(self.inputs)].to_numpy(np.float64)
        return pd.DataFrame(self._learned(u), columns=list(self.outputs))


def served(path: str | Path) -> ServedField | ServedMap:
    """The surrogate or the map that training wrote to `path`.

    Raises SurrogateFileError for a damaged or foreign file, OSError where there is none.
    """
    try:
        return ServedMap(load_map(path))
    except SurrogateFileError:  # a field's, or none at all: the other reader says what is wrong with it
        return ServedField(load_surrogate(path))


def card(model: ServedField | ServedMap, name: str, metrics: Mapping[str, Any]) -> str:
    """The model card in Markdown: what it stands for, its ranges, its errors, and how it is loaded."""
    errors = [
        f"| {error.replace('_', ' ')} | {value:.3g} |"
        for error, value in metrics.items()
        if isinstance(value, float) and error.startswith(MEASURED)
    ]
    columns = ", ".join(f'"{column}": [{float(model.example[column][0]):.4g}]' for column in model.inputs[:2])
    more = ", …" if len(model.inputs) > 2 else ""
    return "\n".join(
        [
            f"The surrogate of {name}. {_rule(metrics)}",
            "",
            "```",
            str(model),
            "```",
            "",
            "| error | |",
            "|---|---|",
            *errors,
            "",
            "Load it where flexsurr is installed; weights are arrays, and nothing that is loaded is code:",
            "",
            "```python",
            "import mlflow, pandas",
            f'model = mlflow.pyfunc.load_model("models:/{name}@champion")',
            f"model.predict(pandas.DataFrame({{{columns}{more}}}))",
            "```",
            "",
            f"{model.rows} Beyond the ranges above its errors are not known.",
        ]
    )


MEASURED = ("train_nmse", "validation_", "held_out_nmse", "long_response_error", "energy_drift", "own_energy")
"""How the names of the errors begin that a card shows."""


LIMITS = {
    "error_at_most_percent": ("runs", ERROR, "worst error of a response", " %"),
    "nmse_at_most": ("networks", NMSE, "validation nmse", ""),
}
"""What a study's rule of choice limits: of which runs, the error, its name and its unit."""


def _rule(metrics: Mapping[str, Any]) -> str:
    """Why it was chosen among the runs of the study."""
    for key, limit in metrics.get("chosen_by", {}).items():
        runs, error, what, unit = LIMITS[key]
        if limit is None or metrics[error] > limit:
            return f"Of all {runs} it has the least {what}."
        of_these = f"Of all {runs} whose {what} is at most {limit:g}{unit}"
        return f"{of_these}, it takes the fewest operations; others may err less."
    return "It was chosen by the rule of the study."


def _row(names: tuple[str, ...], values: Any) -> pd.DataFrame:
    return pd.DataFrame([values], columns=list(names))


def _load_pyfunc(path: str) -> ServedField | ServedMap:
    return served(path)
