"""What the study published, for the columns beside ours."""

import pandas as pd

# Wall time of the network's response over that of the reduced model, mean [%], by name of the structure,
# model and response.
COST_PERCENT: dict[str, dict[tuple[str, str], float]] = {
    "cantilever": {("hnn", "free"): 1.29, ("hnn", "forced"): 83.60},
    "wing": {
        ("dissipative_hnn", "free"): 12.38,
        ("mlp", "free"): 8.99,
        ("dissipative_hnn", "forced"): 51.91,
        ("mlp", "forced"): 56.39,
    },
}

# Table 3: natural frequencies [rad/s] of the wing, full order and the first of the reduced order.
_TABLE_3 = (
    (2.21, 9.55, 13.78, 27.39, 36.38, 46.69, 63.14, 65.05, 80.53),
    (2.21, 9.59, 13.83, 27.63),
)

# By name of the structure: full order, reduced order.
FREQUENCIES_RAD_S: dict[str, tuple[tuple[float, ...], tuple[float, ...]]] = {
    "wing": _TABLE_3,
    "wing_as_printed": _TABLE_3,
}


def beside(costs: pd.DataFrame, structure: str) -> pd.DataFrame:
    """`costs` with paper_percent by model and response, and paper_std_percent, of which nothing is known.

    The published figure is a torch network against the described reduced model of `structure`, both with
    SciPy's Radau; it is repeated on every row of its model, whatever that row's implementation and
    integrator.
    """
    published = COST_PERCENT.get(structure, {})
    pairs = zip(costs["model"], costs["response"], strict=True)
    return costs.assign(
        paper_percent=[published.get(pair, float("nan")) for pair in pairs], paper_std_percent=float("nan")
    )
