"""A model as a functional mock-up unit: FMI 3.0, model exchange and co-simulation, with sources and a binary.

The binary is of this machine's platform; an importer on another one compiles the sources.
"""

import hashlib
import io
import os
import platform
import shutil
import subprocess
import sys
import tempfile
import zipfile
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree as xml

from flexsurr import __version__
from flexsurr.export.c_header import c_header
from flexsurr.export.formulas import NotExported
from flexsurr.export.model import ExportedModel, Quantity

SOURCE = Path(__file__).with_name("fmi3_model.c")
STEP_NAME = "internal_step_s"
BASE_UNITS = {
    "m": {"m": 1}, "s": {"s": 1}, "rad": {"rad": 1}, "kg": {"kg": 1}, "m/s": {"m": 1, "s": -1},
    "rad/s": {"rad": 1, "s": -1}, "N": {"kg": 1, "m": 1, "s": -2}, "J": {"kg": 1, "m": 2, "s": -2},
    "rad/m": {"rad": 1, "m": -1}, "1": {},
}  # fmt: skip
"""What units are made of, for importers that convert them; they leave all others as they are."""

ENDINGS = {"linux": "so", "darwin": "dylib", "windows": "dll"}
OPTIONS = ("-std=c99", "-O2", "-fPIC", "-fvisibility=hidden", "-shared")


def fmu(model: ExportedModel) -> bytes:
    """The unit's content. Raises NotExported where there is no C compiler, or it fails."""
    text = _sources(model)
    files = {
        "modelDescription.xml": _description(model, _token(text)),
        "sources/buildDescription.xml": _build_description(model),
        **{f"sources/{name}": content.encode() for name, content in text.items()},
    }
    files |= _binary(model.name, text)
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in files.items():
            entry = zipfile.ZipInfo(name)  # without the time of day: the same model is the same bytes
            entry.external_attr = 0o644 << 16
            archive.writestr(entry, data, zipfile.ZIP_DEFLATED)
    return content.getvalue()


def _sources(model: ExportedModel) -> dict[str, str]:
    """The C files, by name."""
    header = c_header(replace(model, name="model"))
    token = "{" + hashlib.sha256((model.name + header).encode()).hexdigest()[:32] + "}"
    nominals = ", ".join(repr(_nominal(state)) for state in model.states) or "0.0"
    settings = f'#define MODEL_TOKEN "{token}"\n#define MODEL_NOMINALS {nominals}\n'
    return {"model.h": settings + header, SOURCE.name: SOURCE.read_text(encoding="utf-8")}


def _token(text: dict[str, str]) -> str:
    return text["model.h"].split('"')[1]


def _nominal(quantity: Quantity) -> float:
    """The largest value that the training data hold, or 1."""
    if quantity.low is None or quantity.high is None:
        return 1.0
    return max(abs(quantity.low), abs(quantity.high)) or 1.0


def _binary(name: str, text: dict[str, str]) -> dict[str, bytes]:
    system = {"win32": "windows"}.get(sys.platform, sys.platform)
    machine = {"AMD64": "x86_64", "arm64": "aarch64"}.get(platform.machine(), platform.machine())
    compilers = (os.environ["CC"],) if os.environ.get("CC") else ("cc", "gcc", "clang")
    compiler = next((each for each in compilers if shutil.which(each.split()[0])), None)
    if compiler is None or system not in ENDINGS:
        raise NotExported(
            f"--to fmu needs a C compiler, and there is none of {', '.join(compilers)}; name yours in CC"
        )
    library = f"{name}.{ENDINGS[system]}"
    with tempfile.TemporaryDirectory() as folder:
        for file, content in text.items():
            (Path(folder) / file).write_text(content, encoding="utf-8")
        done = subprocess.run(
            [*compiler.split(), *OPTIONS, SOURCE.name, "-o", library, "-lm"],
            cwd=folder,
            capture_output=True,
            text=True,
            check=False,
        )
        if done.returncode:
            lines = done.stderr.splitlines() or ["it says nothing"]
            first = next((line for line in lines if "error" in line), lines[0])
            raise NotExported(f"the C compiler {compiler} fails: {first}")
        return {f"binaries/{machine}-{system}/{library}": (Path(folder) / library).read_bytes()}


def _description(model: ExportedModel, token: str) -> bytes:
    d, n, k = len(model.states), len(model.inputs), len(model.outputs)
    root = xml.Element(
        "fmiModelDescription",
        fmiVersion="3.0",
        modelName=model.name,
        description=" ".join(model.about),
        generationTool=f"flexsurr {__version__}",
        instantiationToken=token,
        variableNamingConvention="flat",
    )
    keeps = {"canGetAndSetFMUState": "true", "canSerializeFMUState": "true"}
    xml.SubElement(root, "ModelExchange", {"modelIdentifier": model.name, **keeps})
    steps = {"canHandleVariableCommunicationStepSize": "true"}
    xml.SubElement(root, "CoSimulation", {"modelIdentifier": model.name, **steps, **keeps})
    quantities = [*model.states, *model.inputs, *model.outputs]
    units = {quantity.unit for quantity in quantities if quantity.unit}
    units |= {_rate_unit(state) for state in model.states} | {"s"}
    definitions = xml.SubElement(root, "UnitDefinitions")
    for unit in sorted(units - {""}):
        defined = xml.SubElement(definitions, "Unit", name=unit)
        if (powers := BASE_UNITS.get(unit)) is not None:
            xml.SubElement(defined, "BaseUnit", {base: str(power) for base, power in powers.items()})
    experiment = {"stepSize": repr(model.step_s)} if d else {}
    xml.SubElement(root, "DefaultExperiment", {"startTime": "0", **experiment})

    variables = xml.SubElement(root, "ModelVariables")

    def variable(name: str, reference: int, causality: str, unit: str, text: str, **others: str) -> None:
        attributes = {"name": name, "valueReference": str(reference), "causality": causality}
        attributes |= {"variability": "continuous"} | others
        attributes |= {"unit": unit} if unit else {}
        attributes |= {"description": text} if text else {}
        xml.SubElement(variables, "Float64", attributes)

    variable("time", 0, "independent", "s", "")
    for i, state in enumerate(model.states):
        start, nominal = repr(state.start), repr(_nominal(state))
        variable(
            state.name,
            1 + i,
            "output",
            state.unit,
            state.meaning,
            initial="exact",
            start=start,
            nominal=nominal,
        )
    for i, state in enumerate(model.states):
        text = f"rate of {state.name}"
        variable(f"der({state.name})", 1 + d + i, "local", _rate_unit(state), text, derivative=str(1 + i))
    for i, given in enumerate(model.inputs):
        variable(given.name, 1 + 2 * d + i, "input", given.unit, given.meaning, start=repr(given.start))
    first = 1 + 2 * d + n
    for i, output in enumerate(model.outputs):
        variable(output.name, first + i, "output", output.unit, output.meaning)
    if d:
        text = "longest step of the integrator within a step of co-simulation"
        step = {"variability": "tunable", "start": repr(model.step_s), "min": "0"}
        variable(STEP_NAME, first + k, "parameter", "s", text, **step)

    structure = xml.SubElement(root, "ModelStructure")
    outputs = [str(first + i) for i in range(k)]
    rates = [str(1 + d + i) for i in range(d)]
    for reference in (*(str(1 + i) for i in range(d)), *outputs):
        xml.SubElement(structure, "Output", valueReference=reference)
    for reference in rates:
        xml.SubElement(structure, "ContinuousStateDerivative", valueReference=reference)
    for reference in (*outputs, *rates):
        xml.SubElement(structure, "InitialUnknown", valueReference=reference)
    return _text(root)


def _rate_unit(state: Quantity) -> str:
    """The unit of a state over a second."""
    return f"({state.unit})/s" if state.unit else ""


def _build_description(model: ExportedModel) -> bytes:
    root = xml.Element("fmiBuildDescription", fmiVersion="3.0")
    build = xml.SubElement(root, "BuildConfiguration", modelIdentifier=model.name)
    files = xml.SubElement(build, "SourceFileSet", language="C99")
    xml.SubElement(files, "SourceFile", name=SOURCE.name)
    return _text(root)


def _text(root: xml.Element) -> bytes:
    xml.indent(root)
    text: bytes = xml.tostring(root, encoding="utf-8", xml_declaration=True)
    return text + b"\n"
