"""What a person does before a study runs: begin one, check it, look up a key."""

import argparse
import sys
from pathlib import Path
from typing import Any

import yaml
from pydantic import ValidationError

from flexsurr.beam import EquilibriumNotFound
from flexsurr.beam.soundness import unit_hint
from flexsurr.cli.command import for_people
from flexsurr.config.reference import reference as all_keys
from flexsurr.config.section import MATERIALS, Material, rectangle
from flexsurr.config.settings import check_name, load
from flexsurr.config.structure import JOINTS, Joint, Structure
from flexsurr.config.study_files import read_structure
from flexsurr.evaluation.new_study import damping_s, study_files
from flexsurr.storage import replacing
from flexsurr.workflow.modes_plan import ModesPlan
from flexsurr.workflow.plan import AnyPlan, Plan
from flexsurr.workflow.sample_plan import SamplePlan
from flexsurr.workflow.trajectory_plan import TrajectoryPlan

CONFIG = Path("config/config.yaml")


def _check_arguments(parser: argparse.ArgumentParser) -> None:
    """The files to lay on top of config/config.yaml."""
    parser.add_argument(
        "--configfile",
        nargs="*",
        default=[],
        metavar="FILE",
        help="laid on top of config/config.yaml in this order, as snakemake --configfile does",
    )
    parser.add_argument(
        "--directory", type=Path, default=Path(), help="that holds the Snakefile; by default this one"
    )


@for_people(_check_arguments)
def check(configfile: list[str], directory: Path) -> None:
    """Check the configuration as snakemake does, and say what it would make.

    Prints a line for each study, and on stderr what looks odd of its structure. Raises ConfigurationError
    with a line for each mistake.
    """
    plan = Plan(load(directory, [str(CONFIG), *configfile]))
    for name, study in plan.studies.items():
        print(f"{name}: {_data(study)}, {len(study.runs)} runs")
        if isinstance(study, TrajectoryPlan) and (hint := unit_hint(study.resolved.structure)):
            print(f"{name}: {hint}", file=sys.stderr)


def _data(study: AnyPlan) -> str:
    """What a study learns from, in a few words."""
    match study:
        case TrajectoryPlan(variants=variants, resolved=resolved):
            datasets = len(resolved.study.datasets)
            return f"{resolved.structure.name}, {len(variants)} variants, {datasets} datasets each"
        case SamplePlan():
            return f"{len(study.datasets())} sets of samples"
        case ModesPlan():
            return f"{study.structure}, {len(study.plans)} numbers of modes"
    return f"{len(study.sources)} files"


ELEMENTS = 10

KEYS = {
    "length": "length_m",
    "mass": "mass_per_length_kg_m",
    "bending": "bending_stiffness_out_of_plane_N_m2",
    "in_plane": "bending_stiffness_in_plane_N_m2",
    "torsion": "torsional_stiffness_N_m2",
    "axial": "axial_stiffness_N",
    "inertia": "torsional_inertia_per_length_kg_m",
    "gravity": "gravity_m_s2",
    "elements": "elements",
    "joints": "joints",
}
"""The key of a structure that an option gives."""

JOINT_OF: dict[str, Joint] = {
    "bending": "out_of_plane",
    "in_plane": "in_plane",
    "torsion": "torsion",
    "axial": "axial",
}
"""The joint that an option's stiffness is of."""


def _new_study_arguments(parser: argparse.ArgumentParser) -> None:
    """What the beam is."""
    parser.add_argument("name", help="of the study and of its files: letters, digits, hyphens, underscores")
    parser.add_argument(
        "--structure",
        type=Path,
        metavar="FILE",
        help="of a beam that is described already, below --directory; without it --length and a section",
    )
    parser.add_argument("--length", type=float, metavar="M", help="span [m]")
    by_values = parser.add_argument_group("the section by its values")
    for option, unit, text in (
        ("mass", "KG_M", "mass per span [kg/m]"),
        ("bending", "N_M2", "EI of bending that lifts the tip [N m²]"),
        ("in-plane", "N_M2", "EI of bending to the side [N m²]"),
        ("torsion", "N_M2", "GJ [N m²]; needs --inertia"),
        ("inertia", "KG_M", "mass moment of inertia per span about the span [kg m]"),
        ("axial", "N", "EA [N]"),
    ):
        by_values.add_argument(f"--{option}", type=float, metavar=unit, help=text)
    by_shape = parser.add_argument_group("or by its shape, a solid rectangle")
    by_shape.add_argument("--width", type=float, metavar="M", help="to the side [m]")
    by_shape.add_argument("--height", type=float, metavar="M", help="upwards [m]")
    by_shape.add_argument("--material", choices=sorted(MATERIALS), help="with the values of the standards")
    by_shape.add_argument("--young", type=float, metavar="PA", help="or E [Pa]")
    by_shape.add_argument("--poisson", type=float, help="ν, by default 0.3")
    by_shape.add_argument("--density", type=float, metavar="KG_M3", help="with E: mass per volume [kg/m³]")
    parser.add_argument(
        "--joints",
        type=lambda text: text.split(","),
        metavar="KIND,…",
        help=f"{', '.join(JOINTS)}; by default those whose stiffness is given, of a rectangle out_of_plane",
    )
    parser.add_argument(
        "--damping", type=float, metavar="RATIO", help="of the first mode, such as 0.02; by default 0"
    )
    parser.add_argument(
        "--gravity", type=float, metavar="M_S2", help="downwards [m/s²], such as 9.80665; by default 0"
    )
    parser.add_argument("--elements", type=int, help=f"by default {ELEMENTS}")
    parser.add_argument(
        "--modes", type=int, help="that are kept, by default 1, or 3 where joints are several"
    )
    parser.add_argument(
        "--directory", type=Path, default=Path(), help="that holds the Snakefile; by default this one"
    )


@for_people(_new_study_arguments, ValueError, EquilibriumNotFound)
def new_study(name: str, directory: Path, structure: Path | None, modes: int | None, **given: Any) -> None:
    """Begin a study of your own beam: write its structure, sweep and study, ready to run.

    ValueError for what makes no beam, or exists already; ConfigurationError for mistakes in the file of a
    structure.
    """
    check_name(name)
    if not name[0].isalpha() or yaml.safe_load(name) != name:
        raise ValueError(
            f"{name!r} is no word in YAML; allowed: a letter first, and not on, yes, null or such"
        )
    if not (directory / "config" / "config.yaml").is_file():
        raise ValueError(
            f"{directory}: has no config/config.yaml; allowed: the folder that holds the Snakefile"
        )
    beam = _described(directory, structure, given) if structure else _structure(name, given)
    kept = modes if modes is not None else min(1 if len(beam.joints) == 1 else 3, beam.coordinates)
    if not 1 <= kept <= beam.coordinates:
        raise ValueError(f"--modes: {kept} is not allowed; allowed: 1 to {beam.coordinates}")
    files = study_files(name, beam, kept, structure.as_posix() if structure else None)
    for path in files:
        if (directory / path).exists():
            raise ValueError(f"{path}: exists already, and nothing is overwritten; allowed: another name")
    for path, text in files.items():
        (directory / path).parent.mkdir(parents=True, exist_ok=True)
        with replacing(directory / path) as beside:
            beside.write_text(text, encoding="utf-8")
    print("\n".join(files))
    print(f"\nflexsurr check --configfile {name}.yaml")
    run = f"snakemake --cores 2 --configfile {name}.yaml"
    print(f"{run} -- results-{name}/selected/{name}.json  # the surrogates")
    print(f"{run}  # and all tables and figures")
    print(f"{run} --report results-{name}/report.html  # on one page")


def _described(directory: Path, file: Path, given: dict[str, Any]) -> Structure:
    """The beam in a file, of which the options may say nothing more."""
    for option, value in given.items():
        if value is not None:
            raise ValueError(f"--{option.replace('_', '-')}: not with --structure; allowed: in {file} itself")
    return read_structure(directory / file)


def _structure(name: str, given: dict[str, Any]) -> Structure:
    """The beam that the options describe."""
    if given["length"] is None:
        raise ValueError("--length: missing; allowed: more than 0, or else --structure")
    section = _rectangle(given)
    values = {"elements": ELEMENTS, **section} | {
        KEYS[option]: value for option, value in given.items() if option in KEYS and value is not None
    }
    if "mass_per_length_kg_m" not in values:
        raise ValueError("--mass: missing; allowed: more than 0, or else --width, --height and --material")
    if given["joints"] is None:
        values["joints"] = [joint for option, joint in JOINT_OF.items() if given[option] is not None]
        if section and not values["joints"]:
            values["joints"] = ["out_of_plane"]
        if not values["joints"]:
            raise ValueError(
                "--bending: missing; allowed: more than 0, or --in-plane, --torsion, --axial, or a rectangle"
            )
    damping = given["damping"] or 0.0
    if not 0.0 <= damping < 1.0:
        raise ValueError(f"--damping: {damping:g} is not allowed; allowed: 0 or more, less than 1")
    try:
        structure = Structure.model_validate({"name": name, **values})
    except ValidationError as error:
        raise ValueError(_in_options(error)) from None
    if damping == 0.0:
        return structure
    beta = float(f"{damping_s(structure, damping):.4g}")
    return structure.model_copy(update={f"damping_{joint}_s": beta for joint in structure.joints})


def _rectangle(given: dict[str, Any]) -> dict[str, float]:
    """The section by its shape, if that is given."""
    if given["width"] is None and given["height"] is None:
        for option in ("material", "young", "density"):
            if given[option] is not None:
                raise ValueError(f"--{option}: needs --width and --height")
        return {}
    for option in ("width", "height"):
        if given[option] is None or not given[option] > 0.0:
            raise ValueError(f"--{option}: {given[option]} is not allowed; allowed: more than 0")
    for option in ("mass", "bending", "in_plane", "torsion", "axial", "inertia"):
        if given[option] is not None:
            raise ValueError(f"--{option.replace('_', '-')}: follows from the shape; allowed: one of the two")
    if given["material"] is not None:
        return rectangle(given["width"], given["height"], MATERIALS[given["material"]])
    for option in ("young", "density"):
        if given[option] is None or not given[option] > 0.0:
            raise ValueError(
                f"--{option}: {given[option]} is not allowed; allowed: more than 0, or --material"
            )
    poisson = 0.3 if given["poisson"] is None else given["poisson"]
    if not -1.0 < poisson <= 0.5:
        raise ValueError(f"--poisson: {poisson:g} is not allowed; allowed: more than -1, at most 0.5")
    material = Material(given["young"], poisson, given["density"])
    return rectangle(given["width"], given["height"], material)


def _in_options(error: ValidationError) -> str:
    """What is wrong with the first value, in the words of the command line."""
    problem = error.errors()[0]
    options = {key: f"--{option.replace('_', '-')}" for option, key in KEYS.items()}
    if problem["type"] == "value_error":
        text = problem["msg"].removeprefix("Value error, ")
        for key, option in options.items():
            text = text.replace(key, option)
        return text
    option = options[str(problem["loc"][0])]
    allowed = problem["msg"].removeprefix("Input should be ")
    return f"{option}: {problem['input']} is not allowed; allowed: {allowed}"


def _reference_arguments(parser: argparse.ArgumentParser) -> None:
    """Where it goes."""
    parser.add_argument("--output", type=Path, metavar="FILE", help="written to it; by default printed")


@for_people(_reference_arguments)
def reference(output: Path | None) -> None:
    """Print every key of a configuration as Markdown: meaning, unit, default, allowed values.

    Raises LookupError for a key without a description.
    """
    text = all_keys()
    if output is None:
        print(text, end="")
    else:
        output.write_text(text, encoding="utf-8")
