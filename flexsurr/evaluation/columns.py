"""Columns of the tables that others read. Naming them imports nothing that fills them."""

STATIC_COLUMNS = ("load_N", "x_exact_m", "z_exact_m", "x_fom_m", "z_fom_m", "x_rom_m", "z_rom_m")
FREQUENCY_COLUMNS = (
    "structure",
    "mode",
    "fom_rad_s",
    "rom_rad_s",
    "published_fom_rad_s",
    "published_rom_rad_s",
)
REBUILT = "vlm_rebuild"
"""The model of a row whose vortex lattice was built anew at every call."""

COST_COLUMNS = (
    "study",
    "variant",
    "response",
    "model",
    "implementation",
    "integrator",
    "simulations",
    "wall_s_mean",
    "wall_s_std",
    "relative_to_described_percent",
    "relative_to_described_std_percent",
    "relative_to_numpy_percent",
    "relative_to_compiled_percent",
    "paper_percent",
    "paper_std_percent",
    "tip_error_percent",
    "energy_drift_percent",
    "diverged",
)

CROSSOVER_COLUMNS = (
    "modes",
    "model",
    "parameters",
    "wall_s",
    "relative_to_compiled_percent",
    "tip_error_percent",
    "diverged",
    "operations",
    "run_id",
)

MODE_COLUMNS = ("mode", "reference_real", "reference_imag", "surrogate_real", "surrogate_imag")

ACCURACY_COLUMNS = ("output", "train_nmse", "validation_nmse", "validation_r2", "model")
