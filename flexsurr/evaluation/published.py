"""What the study published, for the columns beside ours."""

import pandas as pd

# Wall time of the Hamiltonian network's response over that of the reduced model, mean and spread [%],
# by model and response. The spread is given as plus or minus one standard deviation where it is known.
COST_PERCENT: dict[tuple[str, str], tuple[float, float]] = {
    ("hnn", "free"): (1.29, float("nan")),
    ("hnn", "forced"): (83.60, float("nan")),
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


def beside(costs: pd.DataFrame) -> pd.DataFrame:
    """`costs` with paper_percent and paper_std_percent, by model and response.

    The published figure is a torch network against the described reduced model, both with SciPy's
    Radau; it is repeated on every row of its model, whatever that row's implementation and integrator.
    """
    nothing = (float("nan"), float("nan"))
    pairs = [
        COST_PERCENT.get((model, response), nothing)
        for model, response in zip(costs["model"], costs["response"], strict=True)
    ]
    return costs.assign(
        paper_percent=[mean for mean, _ in pairs], paper_std_percent=[spread for _, spread in pairs]
    )
