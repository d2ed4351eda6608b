"""Small frames of the shape that evaluation writes, made up so that every feature of a figure appears."""

import numpy as np
import pandas as pd
import pytest

from flexsurr.config.structure import Structure
from flexsurr.evaluation.columns import COST_COLUMNS

VARIANTS = ("hamiltonian", "as_printed")
MODELS = ("mlp", "hnn", "polynomial")


@pytest.fixture
def structure() -> Structure:
    return Structure(
        name="cantilever",
        length_m=1.0,
        elements=10,
        joints=("out_of_plane",),
        mass_per_length_kg_m=0.2,
        bending_stiffness_out_of_plane_N_m2=50.0,
    )


@pytest.fixture
def statics() -> pd.DataFrame:
    load = np.arange(0.0, 151.0, 50.0)
    x, z = 1.0 - 1e-3 * load, 4e-3 * load
    return pd.DataFrame(
        {
            "load_N": load,
            "x_exact_m": x,
            "z_exact_m": z,
            "x_fom_m": x + 1e-6 * load,
            "z_fom_m": z + 1e-6 * load,
            "x_rom_m": x + 1e-4 * load,
            "z_rom_m": z - 1e-4 * load,
        }
    )


@pytest.fixture
def shapes() -> pd.DataFrame:
    s = np.linspace(0.0, 1.0, 11)
    frames = []

    def add(kind: str, number: int, line: str, y: float, z: np.ndarray, **columns: object) -> None:
        points = {"x_m": s, "y_m": y, "z_m": z}
        frames.append(
            pd.DataFrame(
                {"kind": kind, "number": number, "line": line, "node": range(11), **points, **columns}
            )
        )

    for line, y in (("left", 0.05), ("axis", 0.0), ("right", -0.05)):
        add("rest", 0, line, y, 0.0 * s, model="rom")
        for mode in (1, 2, 3, 4):
            add("mode", mode, line, y, 0.2 * np.sin(mode * s) * (1 + y), model="rom", omega_rad_s=10.0 * mode)
    for number, load_N in enumerate((0.0, 50.0, 150.0)):
        for model in ("fom", "rom"):
            add("static", number, "axis", 0.0, 2e-3 * load_N * s**2, model=model, load_N=load_N)
    return pd.concat(frames, ignore_index=True)


@pytest.fixture
def validation() -> pd.DataFrame:
    t = np.linspace(0.0, 1.0, 201)
    frames = []
    for variant, shift in zip(VARIANTS, (0.0, 0.05), strict=True):
        for model, lag in (("fom", 0.0), ("rom", 0.01)):
            z = 0.5 * np.sin(50.0 * t + shift + lag)
            frames.append(
                pd.DataFrame({"variant": variant, "model": model, "t_s": t, "tip_x_m": 1.0, "tip_z_m": z})
            )
    return pd.concat(frames, ignore_index=True)


def make_response(response: str, variants: tuple[str, ...] = VARIANTS) -> pd.DataFrame:
    t = np.linspace(0.0, 8.0, 1601)
    frames = []
    for variant in variants:
        for k, model in enumerate(("reference", *MODELS)):
            # one surrogate fails half-way
            shown = t if model != "mlp" else t[: t.size // 2]
            frames.append(
                pd.DataFrame(
                    {
                        "variant": variant,
                        "response": response,
                        "model": model,
                        "t_s": shown,
                        "tip_x_m": 0.9 + 0.05 * np.sin(100.0 * shown),
                        "tip_y_m": 0.01 * np.sin(50.0 * shown),
                        "tip_z_m": 0.4 * np.sin(50.0 * shown + 1e-3 * k * shown),
                        "tip_twist_rad": 0.1 * np.cos(50.0 * shown + 1e-3 * k * shown),
                        "tip_error_percent": 10.0**-k * shown,
                        "load_end_s": 3.0 if response == "forced" else 0.0,
                    }
                )
            )
    return pd.concat(frames, ignore_index=True)


@pytest.fixture
def free() -> pd.DataFrame:
    return make_response("free")


@pytest.fixture
def forced() -> pd.DataFrame:
    return make_response("forced")


@pytest.fixture
def sustained() -> pd.DataFrame:
    return make_response("sustained").assign(load_end_s=5.0)


@pytest.fixture
def energy() -> pd.DataFrame:
    t = np.linspace(0.0, 8.0, 161)
    setups = [("models", model, "gauss_legendre_6(h=0.0025)") for model in ("rom", *MODELS)]
    setups += [
        ("integrators", "rom", name)
        for name in ("scipy_radau", "rk4(h=0.001)", "dop853(rtol=1e-07,atol=1e-09)")
    ]
    return pd.concat(
        [
            pd.DataFrame(
                {
                    "panel": panel,
                    "variant": variant,
                    "response": response,
                    "model": model,
                    "integrator": integrator,
                    "t_s": t,
                    "energy_J": 5.0 + 10.0**-k * t,
                    "drift_percent": 20.0 * 10.0**-k * t,
                    "load_end_s": 3.0 if response == "forced" else 0.0,
                }
            )
            for variant in VARIANTS
            for response in ("free", "forced")
            for k, (panel, model, integrator) in enumerate(setups)
        ],
        ignore_index=True,
    )


@pytest.fixture
def damped_energy() -> pd.DataFrame:
    t = np.linspace(0.0, 30.0, 301)
    return pd.concat(
        [
            pd.DataFrame(
                {
                    "panel": panel,
                    "variant": variant,
                    "response": response,
                    "model": model,
                    "integrator": "radau_iia_5",
                    "t_s": t,
                    "energy_J": 5.0 * np.exp(-(1.0 - 0.3 * k) * t),
                    "drift_percent": 1.0 + k * t,
                    "load_end_s": 3.0 if response == "forced" else 0.0,
                }
            )
            for variant in VARIANTS
            for panel, response in (("models", "free"), ("models", "forced"), ("integrators", "free"))
            for k, model in enumerate(("rom", "mlp", "dissipative_hnn", "port_hamiltonian_many"))
        ],
        ignore_index=True,
    )


@pytest.fixture
def cost() -> pd.DataFrame:
    rows = []
    for variant in VARIANTS:
        for response in ("free", "forced"):
            for k, model in enumerate(("rom", *MODELS)):
                wall = {"numpy": 1.0 / (k + 1), "compiled": 0.5}
                wall |= {"described": 20.0} if model == "rom" else {"torch": 4.0}
                for implementation, seconds in wall.items():
                    rows.append((variant, response, model, implementation, "scipy_radau", seconds, 50.0 + k))
                for power, integrator in enumerate(("dop853_fixed(h=0.01)", "rk4(h=0.001)")):
                    error = float("nan") if model == "mlp" and power else 10.0 ** (-2 * power - k)
                    rows.append(
                        (
                            variant,
                            response,
                            model,
                            "compiled",
                            integrator,
                            1e-3 * (power + 1) / (k + 1),
                            error,
                        )
                    )
    frame = pd.DataFrame(
        rows,
        columns=[
            "variant",
            "response",
            "model",
            "implementation",
            "integrator",
            "wall_s_mean",
            "tip_error_percent",
        ],
    )
    frame["study"] = "cantilever"
    frame["simulations"] = 3
    frame["diverged"] = 3 * frame["tip_error_percent"].isna()
    frame.loc[frame["diverged"] > 0, "wall_s_mean"] = float("nan")
    frame["paper_percent"] = frame["model"].map({"hnn": 1.29})
    return frame.reindex(columns=[*COST_COLUMNS])


@pytest.fixture
def metrics() -> pd.DataFrame:
    rows = []
    for variant in VARIANTS:
        for architecture, optimiser in (
            ("hnn", "levenberg_marquardt"),
            ("hnn", "adam"),
            ("mlp", "lbfgs"),
            ("polynomial", "least_squares"),
        ):
            rows.append(
                {
                    "study": "cantilever",
                    "variant": variant,
                    "run_id": f"{architecture}-{optimiser}-{variant}",
                    "configuration": f"{architecture}-{optimiser}-{variant}",
                    "architecture": architecture,
                    "configurations": None,
                    "hidden": "" if architecture == "polynomial" else "16",
                    "activation": None if architecture == "polynomial" else "half_log",
                    "degree": 6 if architecture == "polynomial" else None,
                    "optimiser": optimiser,
                    "structure": "cantilever",
                    **dict.fromkeys(("options", "scaling", "learning_rate", "weight_decay", "batch_size")),
                    **dict.fromkeys(("precision", "device", "loss", "keep", "patience", "give_up")),
                    "samples_per_trajectory": None,
                    "mass_matrix": None,
                    "time_limit_s": None,
                    "reason": "",
                    "seed": 0,
                    "dataset": "default",
                    "epoch_limit": 10,
                    "epochs": 10,
                    "best_epoch": 9,
                    "parameters": 20,
                    "operations": {"polynomial": 30, "hnn": 220, "mlp": 400}[architecture],
                    "long_response_error_percent_worst": {"polynomial": 1e-3, "hnn": 0.3, "mlp": 5.0}[
                        architecture
                    ],
                    "diverged": 0,
                    "rom_operations": 900,
                    "fom_operations": 6000,
                    "final_loss": 1e-8,
                    "best_validation_nmse": 2e-8,
                    "wall_s": 0.2,
                    "processor_s": 0.2,
                    "train_nmse": 1e-8,
                    "validation_nmse": 2e-8,
                    "status": "finished",
                }
            )
    rows[0] |= {"status": "failed", "train_nmse": None, "validation_nmse": None}
    rows[0] |= {"operations": None, "long_response_error_percent_worst": None}
    rows[0] |= {"reason": "the loss is not finite after epoch 3"}
    return pd.DataFrame(rows)


@pytest.fixture
def selection() -> dict[str, float]:
    return {"error_at_most_percent": 0.5}


@pytest.fixture
def without_lattice() -> None:
    """What a study without an aircraft has for it."""


@pytest.fixture
def sweeps(metrics) -> dict[str, list[str]]:
    """Two sweeps: one of everything, one of the polynomials alone."""
    polynomials = metrics[metrics["architecture"] == "polynomial"]
    return {"default": list(metrics["run_id"]), "few": list(polynomials["run_id"])}


@pytest.fixture
def history(metrics) -> pd.DataFrame:
    epoch = np.arange(10)
    return pd.concat(
        [
            pd.DataFrame(
                {
                    "run_id": run_id,
                    "epoch": epoch,
                    "wall_s": 0.1 * epoch,
                    "train_loss": 10.0**-epoch,
                    "validation_loss": 2.0 * 10.0**-epoch,
                }
            )
            for run_id in metrics["run_id"]
        ],
        ignore_index=True,
    )


@pytest.fixture
def relatives() -> pd.DataFrame:
    """Runs of two studies of one structure, with other modes, scalings and datasets."""
    settings = [
        ("mlp", "unit", "min_max", "default"),
        ("dissipative_hnn", "mass", "canonical", "default"),
        ("dissipative_hnn", "mass", "per_feature", "many"),
        ("dissipative_hnn", "unit", "canonical", "default"),
        ("port_hamiltonian", "mass", None, "many"),
    ]
    rows = [
        {
            "study": "wing" if modes == "mass" else "wing_unit",
            "variant": variant,
            "run_id": f"{architecture}-{k}-{variant}",
            "architecture": architecture,
            "configurations": None,
            "normalisation": modes,
            "scaling": scaling,
            "dataset": dataset,
            "hidden": "32",
            "activation": "silu",
            "degree": None,
            "mass_matrix": None,
            "optimiser": "levenberg_marquardt",
            "seed": 0,
            "status": "finished",
            "parameters": 100 * k + 100,
            "wall_s": 1.0,
            "processor_s": 1.0,
            "train_nmse": 10.0**-k,
            "validation_nmse": 10.0**-k,
            "held_out_nmse": 10.0**-k,
            "held_out_nmse_by_state": {"eta_1": 10.0**-k, "p_1": 2.0 * 10.0**-k},
            "long_response_error_percent_median": 1.0,
            "long_response_error_percent_worst": None if k == 1 else 100.0 * 0.1**k,
            "diverged": int(k == 1),
        }
        for variant in VARIANTS
        for k, (architecture, modes, scaling, dataset) in enumerate(settings)
    ]
    failed = {**rows[0], "run_id": "mlp-failed", "status": "failed", "held_out_nmse": None}
    return pd.DataFrame([*rows, {**failed, "held_out_nmse_by_state": None}])
