"""The files of a new study: a structure, what to learn of it, and how to score it, with comments.

Everything in seconds, newtons and degrees follows from the structure's own frequencies and stiffness
(`flexsurr.evaluation.choice`), so that the study runs as it is, whatever its scale.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np

from flexsurr.beam import reduce, stiffness_matrix
from flexsurr.beam.equilibrium import static_residual
from flexsurr.config.load import TipForce, TipMoment
from flexsurr.config.structure import STIFFNESS_KEY, Structure
from flexsurr.config.study import Reduction
from flexsurr.evaluation.choice import Choice, plain

PERIODS = 20.0
"""Of the slowest mode in each response: enough to tell surrogates apart, in minutes."""

TRAJECTORIES = 40
SAMPLES = 100
"""Of each trajectory, networks train on at most so many."""

DEFLECTION = 0.03
"""How far the study's load moves the tip if held, of the length: near resonance it is some times that."""

TWIST_RAD = 0.1
"""The same where a moment twists it."""

HIGHER_MODES = """\
    higher_modes: as_forced  # as far out as the first mode, they would be chaos
"""

COMMENTS = {
    "length_m": "span, from the clamp to the tip",
    "elements": "rigid elements; errors fall with their square",
    "joints": "what gives way: in_plane, out_of_plane, torsion, axial",
    "mass_per_length_kg_m": "mass per span",
    "bending_stiffness_out_of_plane_N_m2": "EI of bending that lifts the tip",
    "bending_stiffness_in_plane_N_m2": "EI of bending to the side",
    "torsional_stiffness_N_m2": "GJ",
    "axial_stiffness_N": "EA",
    "torsional_inertia_per_length_kg_m": "mass moment of inertia about the span",
    "inertia_about_y_per_length_kg_m": "the part of it about y",
    "chord_m": "width of the section",
    "gravity_m_s2": "along −z",
}


def study_files(name: str, structure: Structure, modes: int, file: str | None = None) -> dict[str, str]:
    """The text of each file of the study `name` by its path below the folder that holds the Snakefile.

    `file` describes the structure; without one it is among those that are written. ValueError for more modes
    than the structure has coordinates, EquilibriumNotFound where it buckles under its own weight.
    """
    normalisation = "unit" if modes == 1 else "mass"
    reduction = Reduction(modes=modes, normalisation=normalisation, about=_about(structure))
    choice = Choice(reduce(structure, reduction))
    files = {
        f"config/sweeps/{name}.yaml": _sweep(name, structure, choice),
        f"config/studies/{name}.yaml": _study(name, file or f"config/structures/{name}.yaml", choice),
        f"{name}.yaml": _top(name),
    }
    return files if file else {f"config/structures/{name}.yaml": _structure(structure)} | files


def _about(structure: Structure) -> str:
    """Where the modes are taken: under gravity in equilibrium."""
    return "equilibrium" if structure.gravity_m_s2 > 0.0 else "undeformed"


def _structure(structure: Structure) -> str:
    given = structure.model_dump(mode="json", exclude_defaults=True)
    needed = {STIFFNESS_KEY[joint] for joint in structure.joints}
    lines = [
        f"# {name_in_words(structure.name)}: a uniform beam, clamped at one end. Units are in the keys;",
        "# docs/reference.md has the others: damping of each joint, gravity, how the clamp is turned.",
    ]
    for key, value in given.items():
        comment = COMMENTS.get(key, "")
        if key.endswith(("_N_m2", "_N")) and key not in needed:
            comment = f"{comment}; once its joint is listed"
        shown = f"[{', '.join(value)}]" if isinstance(value, list) else _written(value)
        lines.append(f"{key}: {shown}" + (f"  # {comment}" if comment else ""))
    return _aligned("\n".join(lines) + "\n", 44)


def _sweep(name: str, structure: Structure, choice: Choice) -> str:
    one = len(choice.basis.omega_rad_s) == 1
    samples = min(SAMPLES, round(choice.sampled_s / choice.sample_step_s))
    hidden, degree = (16, 8) if one else (32, 6)
    potential = "\n    potential: [polynomial]  # knows weight" if structure.gravity_m_s2 > 0.0 else ""
    network = "dissipative_hnn" if structure.dissipates else "hnn"
    of_network = "a Hamiltonian network" + (" with dissipation" if structure.dissipates else "")
    text = f"""\
# What to learn of {name}. A key with several values is a dimension of the search (docs/sweeps.md).

search: grid
spaces:
  # Mass matrix as a polynomial, by linear least squares from sampled configurations: no simulation at all.
  - architecture: port_hamiltonian
    configurations: [1000]
    degree: [{degree}]{potential}
    optimiser: [least_squares]

  # From simulated trajectories: {of_network}.
  - architecture: {network}
    hidden: [[{hidden}]]
    activation: [{"half_log" if one else "silu"}]
    samples_per_trajectory: [{samples}]
    epochs: [200]
    patience: [20]
    time_limit_s: [60.0]  # of processor time

  # Without structure: what most people try first.
  - architecture: mlp
    hidden: [[{hidden}]]
    activation: [tanh]
    samples_per_trajectory: [{samples}]
    epochs: [100]
    patience: [20]
    time_limit_s: [60.0]
"""
    return _aligned(text, 38)


def _study(name: str, file: str, choice: Choice) -> str:
    basis, structure = choice.basis, choice.basis.structure
    starts = choice.initial_conditions
    unit = "lengths or rad" if "torsion" in structure.joints else "lengths"
    higher = "" if starts.higher_modes == "alike" else HIGHER_MODES
    frequencies = ", ".join(f"{omega:.4g}" for omega in basis.omega_rad_s)
    duration_s = choice.response_s(PERIODS)
    periods = duration_s / choice.slowest_s
    longest_s = plain(min(10.0 * choice.slowest_s, 0.5 * duration_s))
    load, held = _load(structure, float(basis.omega_rad_s[0]))
    reaches = ", ".join(f"{reach:.2g}" for reach in choice.reaches)
    fast, tight = (_integrator(each) for each in (choice.integrator, choice.tight_integrator))
    conserves = not structure.dissipates and not choice.stiff
    energy = f"{{method: gauss_legendre_6, step_s: {choice.output_step_s / 2.0:g}}}" if conserves else fast
    text = f"""\
# {name_in_words(name)}: {len(basis.omega_rad_s)} mode(s), at {frequencies} rad/s.
# The slowest takes {choice.slowest_s:.3g} s; all times, ranges and integrators follow: see docs/choosing.md.

structure: {file}
sweeps:
  default: config/sweeps/{name}.yaml
seed: 2024
variants: [hamiltonian]  # as_printed beside it: the paper's model, without its gyroscopic term

reduction:
  modes: {len(basis.omega_rad_s)}
  normalisation: {basis.normalisation}
  about: {_about(structure)}

dataset:  # free responses that train the surrogates
  trajectories: {TRAJECTORIES}
  trajectories_per_shard: {TRAJECTORIES // 2}
  duration_s: {choice.sampled_s:.6g}  # two periods of the slowest mode
  step_s: {choice.sample_step_s:g}  # a twentieth of the fastest one's
  initial_conditions:  # as wide as what you will simulate
    q_min_deg: {starts.q_min_deg:g}  # each mode alone moves the tip by {reaches} {unit}
    q_max_deg: {starts.q_max_deg:g}
    p_min_kg_m2_s: {starts.p_min_kg_m2_s:g}  # with a quarter of the energy that the first mode has at q_max
    p_max_kg_m2_s: {starts.p_max_kg_m2_s:g}
{higher}  integrator: {tight}

evaluation:
  simulations: 3
  described_simulations: {{hamiltonian: 1}}
  scipy_simulations: 1
  duration_s: {duration_s:.6g}  # {periods:.3g} periods; errors of phase grow with their number
  output_step_s: {choice.output_step_s:g}
  repeats: 3
  long_responses: 5  # by which the surrogate of each architecture is chosen
  validation_duration_s: {plain(3.0 * choice.slowest_s):g}  # full against reduced order
  load:  # docs/own-structure.md: moments, tables, several at once
{load}
  longest_load_s: {longest_s:g}  # it ends at a random time within
  reference_integrator: {tight}
  judging_integrator: {fast}
  drawing_integrator: {fast}
  energy_integrator: {energy}
  integrators:  # compiled ones that are timed, beside SciPy's Radau
    - {fast}

statics:
  tip_loads_N: [{", ".join(f"{force:g}" for force in held)}]
"""
    return _aligned(text, 38)


def _load(structure: Structure, omega_rad_s: float) -> tuple[str, list[float]]:
    """The study's load, swinging below the first frequency, and tip forces [N] whose deflection is large."""
    if structure.felt_axes:
        direction = structure.felt_axes[-1]
        of_length = structure.length_m / _compliance(structure, TipForce(force_N=1.0, direction=direction))
        share = DEFLECTION * (1.0 if {"in_plane", "out_of_plane"} & set(structure.joints) else 0.1)
        acts, largest = f"kind: tip_force\n    force_N: {plain(share * of_length):g}", plain(of_length)
    else:
        direction = structure.clamp_axes[0]
        of_radian = 1.0 / _compliance(structure, TipMoment(moment_N_m=1.0, direction=direction))
        acts, largest = f"kind: tip_moment\n    moment_N_m: {plain(TWIST_RAD * of_radian):g}", 1.0
    along = ", ".join(f"{part + 0.0:.6g}" for part in direction)
    text = f"""\
    {acts}
    direction: [{along}]
    history: {{kind: sine, frequency_rad_s: {plain(0.8 * omega_rad_s):g}}}  # below the first mode's"""
    return text, [largest * part for part in (0.0, 0.2, 0.4, 0.6, 0.8, 1.0)]


def _compliance(structure: Structure, load: TipForce | TipMoment) -> float:
    """How far a unit load moves what it acts on, along itself: Qᵀ K⁻¹ Q, in m/N, of a moment in rad/(N m)."""
    rest = np.zeros(structure.coordinates)
    pushed = static_residual(structure, rest) - static_residual(structure, rest, load)
    return float(pushed @ np.linalg.solve(stiffness_matrix(structure), pushed))


def _top(name: str) -> str:
    return f"""\
# Laid on top of config/config.yaml:  snakemake --cores 2 --configfile {name}.yaml
results: results-{name}
studies: [{name}]
"""


def name_in_words(name: str) -> str:
    """A name as the beginning of a sentence."""
    words = name.replace("_", " ").replace("-", " ")
    return words[:1].upper() + words[1:]


def _aligned(text: str, column: int) -> str:
    """The same text with the comments behind values one below the other."""
    lines = []
    for line in text.splitlines():
        value, hash_, comment = line.partition("  # ")
        behind = hash_ and value.strip()
        lines.append(f"{value:<{column - 2}}{hash_}{comment}" if behind else line)
    return "\n".join(lines) + "\n"


def _integrator(integrator: Any) -> str:
    values: Mapping[str, Any] = integrator.model_dump(exclude_none=True)
    return "{" + ", ".join(f"{key}: {_written(value)}" for key, value in values.items()) + "}"


def _written(value: Any) -> str:
    """A value as YAML reads it back: without a point, 1e-07 would be a word."""
    if not isinstance(value, float):
        return str(value)
    text = f"{value:.6g}"
    mantissa, exponential, exponent = text.partition("e")
    return f"{float(mantissa)}e{int(exponent):+d}" if exponential else text


def damping_s(structure: Structure, ratio: float) -> float:
    """Rayleigh's β [s] with which the first mode has this damping ratio: ratio = ½ β ω₁."""
    (omega,) = reduce(structure, Reduction(modes=1)).omega_rad_s
    return float(2.0 * ratio / omega)
