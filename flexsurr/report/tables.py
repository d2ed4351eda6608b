"""The tables: data frames whose columns are a contract, their files, and a page to read each on."""

import html
from collections.abc import Callable, Sequence
from pathlib import Path

import pandas as pd

from flexsurr.config.trial import FIELDS, MAPS, dimensions
from flexsurr.evaluation.columns import (
    ACCURACY_COLUMNS,
    COST_COLUMNS,
    FREQUENCY_COLUMNS,
    MODE_COLUMNS,
    STATIC_COLUMNS,
)
from flexsurr.evaluation.published import published_loss
from flexsurr.report.architectures import architectures
from flexsurr.report.seeds import seeds
from flexsurr.storage import replacing

TRAINING_COLUMNS = (
    "study",
    "variant",
    "run_id",
    "architecture",
    "configurations",
    "hidden",
    "activation",
    "degree",
    "options",
    "scaling",
    "optimiser",
    "learning_rate",
    "weight_decay",
    "batch_size",
    "precision",
    "device",
    "loss",
    "keep",
    "patience",
    "time_limit_s",
    "seed",
    "dataset",
    "epoch_limit",
    "epochs",
    "best_epoch",
    "wall_s",
    "processor_s",
    "parameters",
    "final_loss",
    "train_nmse",
    "validation_nmse",
    "best_validation_nmse",
    "published_loss",
    "sampling",
    "lattice",
    "networks",
    "inputs",
)
"""Every setting of a trial has its column, empty for a run that takes none; those of maps are the last."""

LEARNED_LOAD_COLUMNS = (
    "study",
    "variant",
    "map",
    "form",
    "parameters",
    "tip_rms_over_length",
    "twist_largest_error_rad",
    "force_relative_error",
)

ROLLOUT_COLUMNS = (
    "study",
    "model",
    "trajectory",
    "samples",
    "duration_s",
    "completed",
    "error_percent",
    "own_energy_drift_percent",
)

ROLLOUT_COST_COLUMNS = (
    "study",
    "model",
    "implementation",
    "integrator",
    "simulations",
    "duration_s",
    "right_hand_sides",
    "us_per_right_hand_side",
    "wall_s_mean",
    "wall_s_std",
    "error_percent",
    "diverged",
)


def static_tip(statics: pd.DataFrame) -> pd.DataFrame:
    """static_tip.csv: tip position [m] against dead tip load [N], ascending."""
    return _columns(statics, STATIC_COLUMNS).sort_values("load_N", ignore_index=True)


def natural_frequencies(frequencies: pd.DataFrame) -> pd.DataFrame:
    """natural_frequencies.csv: full order, reduced order, and what is published [rad/s]."""
    return _columns(frequencies, FREQUENCY_COLUMNS)


def training(metrics: pd.DataFrame) -> pd.DataFrame:
    """training.csv: every run, failed ones with empty losses; best validation first in each variant."""
    published = [
        published_loss({str(key): value for key, value in run.items()}) for run in metrics.to_dict("records")
    ]
    settings = [name for kind in (FIELDS, MAPS) for name in dimensions(kind) if name not in metrics.columns]
    whole = metrics.assign(published_loss=published, **dict.fromkeys(settings))
    frame = _columns(whole, TRAINING_COLUMNS)
    return frame.sort_values(["study", "variant", "validation_nmse", "run_id"], ignore_index=True)


def cost(costs: pd.DataFrame) -> pd.DataFrame:
    """cost.csv: every model × implementation × integrator, by study, variant and response."""
    return _columns(costs, COST_COLUMNS)


def learned_loads(errors: pd.DataFrame) -> pd.DataFrame:
    """learned_loads.csv: what the maps of a learned load err by."""
    return _columns(errors, LEARNED_LOAD_COLUMNS)


def rollout_errors(errors: pd.DataFrame) -> pd.DataFrame:
    """rollout_errors.csv: every selected surrogate on every held-out trajectory."""
    return _columns(errors, ROLLOUT_COLUMNS)


def rollout_cost(costs: pd.DataFrame) -> pd.DataFrame:
    """rollout_cost.csv: every surrogate × implementation × integrator."""
    return _columns(costs, ROLLOUT_COST_COLUMNS)


def airliner_accuracy(accuracy: pd.DataFrame) -> pd.DataFrame:
    """airliner_accuracy.csv: every output of each selected map."""
    return _columns(accuracy, ACCURACY_COLUMNS)


def airliner_modes(modes: pd.DataFrame) -> pd.DataFrame:
    """airliner_modes.csv: eigenvalues in trim, with the lattice and with the network."""
    return _columns(modes, MODE_COLUMNS)


def as_it_is(frame: pd.DataFrame) -> pd.DataFrame:
    """The whole of what an evaluation wrote."""
    return frame


TABULATE: dict[str, Callable[[pd.DataFrame], pd.DataFrame]] = {
    tabulate.__name__: tabulate
    for tabulate in (
        static_tip,
        natural_frequencies,
        training,
        architectures,
        seeds,
        cost,
        learned_loads,
        rollout_errors,
        rollout_cost,
        airliner_accuracy,
        airliner_modes,
    )
} | dict.fromkeys(
    ("airliner_elastic_modes", "airliner_left_out_modes", "airliner_cost", "airliner_limits"), as_it_is
)
"""The functions that make the tables of the catalogue, by their names."""


def save_table(frame: pd.DataFrame, path: Path) -> None:
    """Write `frame` as CSV, nine significant digits, there whole or not at all."""
    _write(path, frame.to_csv(index=False, float_format="%.9g", lineterminator="\n"))


def save_page(frame: pd.DataFrame, title: str, caption: str, path: Path) -> None:
    """Write `frame` as a page of HTML with a title and a caption, there whole or not at all."""
    _write(path, page(frame, title, caption))


def page(frame: pd.DataFrame, title: str, caption: str) -> str:
    """A self-contained HTML page: title, caption, table. Numbers with four digits; empty where unknown."""
    numeric = [pd.api.types.is_numeric_dtype(frame[name]) for name in frame.columns]
    head = "".join(
        f'<th class="{"number" if is_number else "word"}">{_heading(name)}</th>'
        for name, is_number in zip(frame.columns, numeric, strict=True)
    )
    rows = []
    for values in frame.itertuples(index=False):
        cells = (
            f'<td class="number">{_number(value)}</td>'
            if is_number
            else f"<td>{html.escape(_word(value))}</td>"
            for value, is_number in zip(values, numeric, strict=True)
        )
        rows.append(f"<tr>{''.join(cells)}</tr>")
    body = "\n".join(rows)
    return _PAGE.format(title=html.escape(title), caption=html.escape(caption), head=head, body=body)


def _columns(frame: pd.DataFrame, names: Sequence[str]) -> pd.DataFrame:
    """Exactly these columns; KeyError naming those that are missing."""
    missing = [name for name in names if name not in frame.columns]
    if missing:
        raise KeyError(f"columns missing: {', '.join(missing)}")
    return frame[list(names)].reset_index(drop=True)


def _heading(name: str) -> str:
    """The column's name, which may break after an underscore."""
    return html.escape(name).replace("_", "_<wbr>")


def _number(value: float) -> str:
    if pd.isna(value):
        return ""
    return f"{value:.4g}".replace("e-0", "e-").replace("e+0", "e+")


def _word(value: object) -> str:
    return "" if value is None or (isinstance(value, float) and pd.isna(value)) else str(value)


def _write(path: Path, text: str) -> None:
    with replacing(path) as beside:
        beside.write_text(text, encoding="utf-8")


_PAGE = """<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<title>{title}</title>
<style>
body {{ font: 14px/1.45 system-ui, sans-serif; margin: 2em; color: #1b1b1b; }}
p {{ max-width: 60em; }}
table {{ border-collapse: collapse; font-size: 12.5px; }}
th {{ position: sticky; top: 0; background: #fff; border-bottom: 1.5px solid #000; text-align: left;
  vertical-align: bottom; padding: 4px 10px; max-width: 9em; }}
td {{ padding: 2px 10px; border-bottom: 1px solid #e4e4e4; white-space: nowrap; }}
th.number, td.number {{ text-align: right; font-variant-numeric: tabular-nums; }}
tr:hover td {{ background: #f3f6fa; }}
</style>
</head>
<body>
<h1>{title}</h1>
<p>{caption}</p>
<table>
<thead><tr>{head}</tr></thead>
<tbody>
{body}
</tbody>
</table>
</body>
</html>
"""
