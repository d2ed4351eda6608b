"""Every exported form gives the numbers of the surrogate that it stands for, and says what they are."""

import json
import re
import struct
import subprocess
import types

import fmpy
import numpy as np
import onnx
import onnxruntime
import pytest
from exported_models import NAMES, SAMPLES
from exported_models import case as case_of
from fmpy.fmi3 import FMU3Model
from fmpy.validation import validate_fmu

from flexsurr.export import c_header, fmu, numpy_file, onnx_file

STRICT = ("-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic")
SANITIZED = ("-O0", "-fsanitize=address,undefined", "-fno-sanitize-recover=all")
TOLERANCE = 1e-12


def close(found, expected, cancelling=1.0):
    """Equal to rounding, beside the largest of each column's terms; what is no number is none in both."""
    assert found.shape == expected.shape
    there = np.isfinite(expected)
    np.testing.assert_array_equal(np.isfinite(found), there)
    largest = np.where(there, np.abs(expected), 0.0).max(axis=0, initial=0.0)
    apart = np.abs(np.where(there, found - expected, 0.0)) / np.where(largest > 0.0, largest, 1.0)
    assert apart.max(initial=0.0) <= TOLERANCE * cancelling


@pytest.fixture(scope="module")
def c_answers(tmp_path_factory):
    """Rates, outputs and states a step later of every case, by one C program that sanitizers watch."""
    folder = tmp_path_factory.mktemp("c")
    blocks, numbers = [], []
    for name in NAMES:
        case = case_of(name)
        (folder / f"{name}.h").write_text(c_header(case.model))
        d, n, k = case.x.shape[1], case.u.shape[1], len(case.model.outputs)
        calls = f"{name}_outputs(u, y);"
        if d:
            calls = (
                f"{name}_rates(x, u, dx); {name}_outputs(x, u, y); {name}_step(x, u, {name.upper()}_STEP_S);"
            )
        blocks.append(
            f"for (int s = 0; s < {SAMPLES}; s++) {{ in(x, {d}); in(u, {n}); {calls}"
            f" out(dx, {d}); out(y, {k}); out(x, {d}); }}"
        )
        numbers += np.hstack([case.x, case.u]).ravel().tolist()
    program = "\n".join(
        [
            "#include <stdio.h>",
            "#include <stdlib.h>",
            *(f'#include "{name}.h"' for name in NAMES),
            "static double x[64], u[64], dx[64], y[64];",
            "static void in(double *v, int n)"
            " { if (fread(v, sizeof(double), (size_t)n, stdin) != (size_t)n) exit(1); }",
            "static void out(const double *v, int n) { fwrite(v, sizeof(double), (size_t)n, stdout); }",
            "int main(void) {",
            *blocks,
            "return 0; }",
        ]
    )
    (folder / "main.c").write_text(program)
    command = ["cc", *STRICT, *SANITIZED, "main.c", "-o", "main", "-lm"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[:3000]
    done = subprocess.run(
        [folder / "main"], input=struct.pack(f"{len(numbers)}d", *numbers), capture_output=True
    )
    assert done.returncode == 0, done.stderr[-3000:]
    answers, found = np.frombuffer(done.stdout), {}
    for name in NAMES:
        case = case_of(name)
        d, k = case.x.shape[1], len(case.model.outputs)
        own, answers = np.split(answers, [SAMPLES * (2 * d + k)])
        found[name] = np.split(own.reshape(SAMPLES, -1), [d, d + k], axis=1)
    assert not answers.size
    return found


def python_of(case):
    """The module that the NumPy file is."""
    module = types.ModuleType(case.model.name)
    exec(numpy_file(case.model), module.__dict__)
    return module


@pytest.mark.parametrize("name", NAMES)
def test_c_gives_the_numbers_of_the_surrogate(name, c_answers):
    rates, outputs, _ = c_answers[name]
    close(rates, case_of(name).rates)
    close(outputs, case_of(name).outputs, case_of(name).cancelling)


@pytest.mark.parametrize("name", NAMES)
def test_numpy_gives_the_numbers_of_the_surrogate(name):
    case, module = case_of(name), python_of(case_of(name))
    if not case.x.size:
        close(module.outputs(case.u), case.outputs, case.cancelling)
        close(module.outputs(case.u[0]), case.outputs[0], case.cancelling)
        return
    close(module.rates(case.x, case.u), case.rates)
    close(module.outputs(case.x, case.u), case.outputs)
    np.testing.assert_allclose(
        module.rates(case.x[0], case.u[0]), module.rates(case.x, case.u)[0], rtol=1e-12
    )


@pytest.mark.parametrize("name", NAMES)
def test_onnx_gives_the_numbers_of_the_surrogate(name):
    case = case_of(name)
    session = onnxruntime.InferenceSession(onnx_file(case.model), providers=["CPUExecutionProvider"])
    given = {"states": case.x, "inputs": case.u}
    found = session.run(None, {argument.name: given[argument.name] for argument in session.get_inputs()})
    expected = [values for values in (case.rates, case.outputs) if values.size]
    for numbers, of_surrogate in zip(found, expected, strict=True):
        close(numbers, of_surrogate, case.cancelling)


@pytest.mark.parametrize("name", ["wing", "unpaired", "hamiltonian_polynomial"])
def test_a_step_of_c_is_that_of_numpy(name, c_answers):
    case = case_of(name)
    close(c_answers[name][2], python_of(case).step(case.x, case.u))


def test_the_stepper_is_of_order_four():
    module = python_of(case_of("wing"))
    x = 0.05 * case_of("wing").x[0]

    def after(steps):
        state = x
        for _ in range(steps):
            state = module.step(state, None, 20 * module.STEP_S / steps)
        return state

    exact = after(1280)
    errors = [np.abs(after(steps) - exact).max() for steps in (80, 160)]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(4.0, abs=0.3)


@pytest.mark.parametrize(
    "name", ["wing", "eight_modes", "map_network", "aerodynamics", "aircraft", "unpaired"]
)
def test_an_fmu_is_valid_and_gives_the_numbers_of_the_surrogate(name, tmp_path):
    case, path = case_of(name), tmp_path / f"{name}.fmu"
    path.write_bytes(fmu(case.model))
    assert validate_fmu(str(path)) == []
    description = fmpy.read_model_description(str(path))
    of = {variable.name: variable for variable in description.modelVariables}
    for quantity in (*case.model.states, *case.model.inputs, *case.model.outputs):
        assert (of[quantity.name].unit or "") == quantity.unit
    folder = fmpy.extract(str(path), tmp_path / "unit")
    unit = FMU3Model(
        guid=description.guid,
        modelIdentifier=description.modelExchange.modelIdentifier,
        unzipDirectory=str(folder),
        instanceName="unit",
    )
    unit.instantiate()
    unit.enterInitializationMode()
    unit.exitInitializationMode()

    def references(quantities, form="{}"):
        return [of[form.format(quantity.name)].valueReference for quantity in quantities]

    found = []
    for x, u in zip(case.x, case.u, strict=True):
        unit.setFloat64(references(case.model.states), x.tolist())
        unit.setFloat64(references(case.model.inputs), u.tolist())
        found.append(
            unit.getFloat64(references(case.model.states, "der({})"))
            + unit.getFloat64(references(case.model.outputs))
        )
    unit.terminate()
    unit.freeInstance()
    close(np.array(found), np.hstack([case.rates, case.outputs]))


@pytest.mark.parametrize("interface", ["ModelExchange", "CoSimulation"])
def test_an_fmu_is_simulated_as_the_surrogate_is(interface, tmp_path):
    case, path = case_of("wing"), tmp_path / "wing.fmu"
    path.write_bytes(fmu(case.model))
    module, state = python_of(case), 0.05 * case.x[0]
    steps = 50
    times = module.STEP_S * np.arange(steps + 1)
    found = fmpy.simulate_fmu(
        str(path),
        fmi_type=interface,
        start_values=dict(zip(module.STATES, state.tolist(), strict=True)),
        stop_time=times[-1],
        output_interval=module.STEP_S,
        step_size=module.STEP_S,
        relative_tolerance=1e-10,
        output=[*module.STATES, *module.OUTPUTS],
    )
    for _ in range(steps):
        state = module.step(state)
    assert found["time"][-1] == pytest.approx(times[-1])
    at_end = np.array([found[name][-1] for name in (*module.STATES, *module.OUTPUTS)])
    expected = np.concatenate([state, module.outputs(state)])
    tolerance = 1e-9 if interface == "CoSimulation" else 1e-3
    np.testing.assert_allclose(at_end, expected, rtol=tolerance, atol=tolerance * np.abs(state).min())


@pytest.mark.parametrize("name", ["wing", "map_network"])
def test_names_and_units_are_in_every_form(name, tmp_path):
    model = case_of(name).model
    kinds = {"states": model.states, "inputs": model.inputs, "outputs": model.outputs}
    header, module = c_header(model), python_of(case_of(name))
    properties = {entry.key: entry.value for entry in onnx.load_from_string(onnx_file(model)).metadata_props}
    for kind, quantities in kinds.items():
        units = {quantity.name: quantity.unit for quantity in quantities}
        assert getattr(module, kind.upper()) == units
        assert {entry["name"]: entry["unit"] for entry in json.loads(properties[kind])} == units
        for quantity in quantities:
            assert f"{quantity.name} [{quantity.unit}]" in header


def test_the_numpy_file_needs_numpy_alone():
    for case in map(case_of, NAMES):
        imports = set(re.findall(r"^ *(?:import|from) .*$", numpy_file(case.model), re.MULTILINE))
        assert imports <= {"import numpy as np", "import math"}


def test_two_exports_of_a_model_are_the_same_bytes():
    model = case_of("wing").model
    assert (fmu(model), onnx_file(model)) == (fmu(model), onnx_file(model))
