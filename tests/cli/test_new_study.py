"""A new study from one command: files that a plan takes, for any beam; nothing overwritten; short errors."""

import argparse
import re
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml

from flexsurr.beam import reduce, reduced_order, tip_position, tip_twist
from flexsurr.beam.initial_conditions import initial_states
from flexsurr.cli import studies
from flexsurr.cli.command import COMMANDS
from flexsurr.config.settings import load
from flexsurr.workflow.plan import Plan

TOP = Path(__file__).parents[2]
ROD = ("--length", "2", "--mass", "0.35", "--bending", "12")
BLADE = ("--length", "1.5", "--width", "0.08", "--height", "0.006", "--material", "aluminium")
BEAMS = {
    "rod": (*ROD,),
    "soft-rod": ("--length", "2", "--mass", "35", "--bending", "0.12", "--elements", "6"),
    "blade": (*BLADE, "--joints", "out_of_plane,in_plane,torsion", "--damping", "0.02"),
    "tube": ("--length", "1", "--mass", "1", "--torsion", "20", "--inertia", "1e-3", "--damping", "0.01"),
    "bar": ("--length", "1", "--mass", "1", "--axial", "2e6", "--modes", "2"),
    "sideways": ("--length", "3", "--mass", "1", "--in-plane", "50", "--modes", "2"),
    "heavy": (*ROD, "--gravity", "9.81", "--damping", "0.01"),
    "plank": ("--length", "3", "--width", "0.2", "--height", "0.03", "--young", "1e10", "--density", "500"),
}


@pytest.fixture(scope="module")
def clone(tmp_path_factory):
    root = tmp_path_factory.mktemp("clone")
    shutil.copytree(TOP / "config", root / "config")
    return root


def new_study(root, *arguments):
    parser = argparse.ArgumentParser()
    COMMANDS["new-study"].arguments(parser)
    studies.new_study(**vars(parser.parse_args([*arguments, "--directory", str(root)])))


@pytest.mark.parametrize("name", BEAMS)
def test_its_files_make_a_plan(clone, name, capsys):
    new_study(clone, name, *BEAMS[name])
    files = capsys.readouterr().out.split("\n\n")[0].splitlines()
    assert len(files) == 4
    assert all((clone / file).read_text().startswith("# ") for file in files)
    assert all(len(line) <= 110 for file in files for line in (clone / file).read_text().splitlines())
    plan = Plan(load(clone, ["config/config.yaml", f"{name}.yaml"]))
    assert list(plan.studies) == [name]
    study = plan.studies[name]
    assert len(study.runs) == 3
    settings = study.resolved.study
    assert settings.evaluation.load.parts
    assert study.resolved.structure.dissipates == ("--damping" in BEAMS[name])


def test_times_go_with_the_period_and_loads_with_the_stiffness(clone):
    """Ten thousand times the mass over the stiffness: a hundred times as slow; a hundredth of the force."""
    values = {}
    for name, mass, bending in (("brisk", "0.35", "12"), ("slow", "35", "0.12")):
        new_study(clone, name, "--length", "2", "--mass", mass, "--bending", bending)
        values[name] = yaml.safe_load((clone / f"config/studies/{name}.yaml").read_text())
    quick, slow = values["brisk"], values["slow"]
    for part, key in (("dataset", "duration_s"), ("dataset", "step_s"), ("evaluation", "duration_s")):
        assert slow[part][key] == pytest.approx(100.0 * quick[part][key], rel=0.05)
    forces = [study["evaluation"]["load"]["force_N"] for study in (quick, slow)]
    assert forces[1] == pytest.approx(0.01 * forces[0])


@pytest.mark.parametrize("name", BEAMS)
def test_ranges_follow_from_the_beam(clone, name):
    """The first mode moves the tip by half the length or rad; p_max has a quarter of the energy of q_max."""
    ranged = f"ranged-{name}"
    new_study(clone, ranged, *BEAMS[name])
    study = Plan(load(clone, ["config/config.yaml", f"{ranged}.yaml"])).studies[ranged].resolved
    starts, structure = study.study.dataset.initial_conditions, study.structure
    basis = reduce(structure, study.study.reduction)
    r = len(basis.omega_rad_s)
    unit = np.full((2, 2 * r), 0.5)
    unit[0, 0] = unit[1, r] = 1.0
    bent, moving = initial_states(basis, starts, unit)
    shape = basis.modes @ bent[:r]
    moved = np.linalg.norm(tip_position(structure, shape) - tip_position(structure, 0.0 * shape))
    most = max(moved / structure.length_m, abs(tip_twist(structure, shape)))
    assert most == pytest.approx(0.05 if name == "bar" else 0.5, rel=0.06)
    weightless = replace(basis, structure=structure.model_copy(update={"gravity_m_s2": 0.0}))
    model = reduced_order(weightless, "hamiltonian", "numpy")
    elastic, kinetic = (model.energy(state) for state in (bent, moving))
    # of the heavy one the modal mass is a tenth too small, since weight has its part in the frequency
    assert kinetic == pytest.approx(0.25 * elastic, rel=0.15 if name == "heavy" else 0.07)
    assert starts.q_min_deg == -starts.q_max_deg
    assert starts.p_min_kg_m2_s == -starts.p_max_kg_m2_s
    assert starts.higher_modes == ("alike" if r == 1 else "as_forced")


def test_a_beam_in_a_file_has_a_study_with_that_file(clone):
    new_study(clone, "gusty", "--structure", "config/structures/tapered_wing.yaml")
    assert not (clone / "config/structures/gusty.yaml").exists()
    study = Plan(load(clone, ["config/config.yaml", "gusty.yaml"])).studies["gusty"].resolved
    assert study.structure.name == "tapered_wing"
    assert len(study.study.evaluation.load.parts) == 1
    assert study.study.reduction.about == "equilibrium"


def test_nothing_is_overwritten(clone):
    path = clone / "config/sweeps/mine.yaml"
    path.write_text("mine\n")
    with pytest.raises(ValueError, match=r"config/sweeps/mine\.yaml: exists already, and nothing is over"):
        new_study(clone, "mine", *ROD)
    assert path.read_text() == "mine\n"
    assert not (clone / "config/studies/mine.yaml").exists()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--length", "-2", "--mass", "1", "--bending", "1"), "--length: -2.0 is not allowed"),
        (("--length", "2", "--mass", "0", "--bending", "1"), "--mass: 0.0 is not allowed"),
        (("--length", "2", "--bending", "1"), "--mass: missing"),
        (("--length", "2", "--mass", "1"), "--bending: missing"),
        (("--length", "2", "--mass", "1", "--torsion", "1"), "--inertia: 0.0 is not allowed with the joint"),
        ((*ROD, "--joints", "torsion"), "--torsion: needed for the joint 'torsion'"),
        ((*ROD, "--joints", "sideways"), "--joints: sideways is not allowed"),
        ((*ROD, "--modes", "11"), "--modes: 11 is not allowed; allowed: 1 to 10"),
        ((*ROD, "--damping", "2"), "--damping: 2 is not allowed"),
        ((*ROD, "--gravity", "-1"), "--gravity: -1.0 is not allowed"),
        ((*ROD, "--elements", "0"), "--elements: 0 is not allowed"),
        ((*BLADE, "--mass", "1"), "--mass: follows from the shape"),
        (BLADE[:4], "--height: None is not allowed"),
        (BLADE[:6], "--young: None is not allowed; allowed: more than 0, or --material"),
        ((*ROD, "--material", "steel"), "--material: needs --width and --height"),
        (ROD[2:], "--length: missing; allowed: more than 0, or else --structure"),
        (
            ("--structure", "config/structures/wing.yaml", *ROD),
            "--length: not with --structure; allowed: in config/structures/wing.yaml itself",
        ),
    ],
)
def test_mistakes_are_one_line_with_the_option(clone, arguments, words):
    with pytest.raises(ValueError, match=re.escape(words)) as caught:
        new_study(clone, "wrong", *arguments)
    assert str(caught.value).startswith(words)
    assert "\n" not in str(caught.value)
    assert not (clone / "wrong.yaml").exists()


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("my beam", "'my beam' is no name; allowed: letters, digits"),
        ("train", "'train' is the name of a rule"),
        ("on", "'on' is no word in YAML"),
        ("1e5", "'1e5' is no word in YAML"),
    ],
)
def test_a_name_is_one_word_that_nothing_else_has(clone, name, words):
    with pytest.raises(ValueError, match=words):
        new_study(clone, name, *ROD)
    assert not (clone / f"{name}.yaml").exists()


def test_the_folder_is_ours(tmp_path):
    with pytest.raises(ValueError, match=r"has no config/config\.yaml"):
        new_study(tmp_path, "rod", *ROD)


def test_from_the_shell_a_mistake_ends_with_exit_code_1(clone):
    call = [
        sys.executable,
        "-m",
        "flexsurr",
        "new-study",
        "wrong",
        *ROD,
        "--modes",
        "0",
        "--directory",
        clone,
    ]
    done = subprocess.run(call, cwd=TOP, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 1
    assert done.stderr == "flexsurr new-study: --modes: 0 is not allowed; allowed: 1 to 10\n"
