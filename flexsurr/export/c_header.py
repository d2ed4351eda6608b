"""A model as one C99 header without dependencies: functions of arrays, names and units, a stepper."""

from collections.abc import Sequence

from flexsurr.export.c_statements import HELPERS, Statements
from flexsurr.export.expressions import Value
from flexsurr.export.model import ExportedModel, Quantity, allowed_range

STEP = """\
/* One step of the classical Runge-Kutta method of order 4 over h seconds, u held: x is overwritten.
   {guard}_STEP_S is a step with which it follows the fastest motion at rest. */
static inline void {name}_step(double *x, const double *u, double h)
{{
    double at[{d}], k[{d}], total[{d}];
    {name}_rates(x, u, k);
    for (int i = 0; i < {d}; i++) {{
        total[i] = k[i];
        at[i] = x[i] + 0.5 * h * k[i];
    }}
    {name}_rates(at, u, k);
    for (int i = 0; i < {d}; i++) {{
        total[i] += 2.0 * k[i];
        at[i] = x[i] + 0.5 * h * k[i];
    }}
    {name}_rates(at, u, k);
    for (int i = 0; i < {d}; i++) {{
        total[i] += 2.0 * k[i];
        at[i] = x[i] + h * k[i];
    }}
    {name}_rates(at, u, k);
    for (int i = 0; i < {d}; i++)
        x[i] += h / 6.0 * (total[i] + k[i]);
}}
"""

USE = """\
Use
    #include "{name}.h"
    double x[{guard}_STATES], u[{inputs}] = {{0}}, y[{outputs}];
    {name}_start(x, u);                      (states and inputs at rest)
    for (;;) {{
        u[0] = …;                            (inputs, held over the step)
        {name}_step(x, u, {guard}_STEP_S);
        {name}_outputs(x, u, y);
    }}
For an integrator of your own call {name}_rates(x, u, dx). All functions are pure: no memory is
allocated, nothing is kept between calls, and any number of threads may call them."""

USE_OF_MAP = """\
Use
    #include "{name}.h"
    double u[{guard}_INPUTS], y[{guard}_OUTPUTS];
    {name}_outputs(u, y);
It is a pure function: no memory is allocated, nothing is kept between calls, and any number of threads
may call it."""


def c_header(model: ExportedModel) -> str:
    """The text of the header; whatever it defines begins with the model's name."""
    guard, name = model.name.upper(), model.name
    statements = Statements(name)
    functions = _functions(model, statements)
    helpers = [HELPERS[helper].format(prefix=name) for helper in HELPERS if helper in statements.helpers]
    constants = [
        f"#define {guard}_{kind} {len(quantities)}"
        for kind, quantities in (
            ("STATES", model.states),
            ("INPUTS", model.inputs),
            ("OUTPUTS", model.outputs),
        )
    ]
    if model.rates is not None:
        constants.append(f"#define {guard}_STEP_S {model.step_s!r}")
    return "\n".join(
        [
            _comment(model),
            f"#ifndef {guard}_H",
            f"#define {guard}_H",
            "",
            "#include <math.h>",
            "#include <stddef.h>",
            "",
            *constants,
            "",
            *(
                _texts(name, kind, quantities)
                for kind, quantities in (
                    ("state", model.states),
                    ("input", model.inputs),
                    ("output", model.outputs),
                )
            ),
            _start(model),
            _within(model),
            *helpers,
            *functions,
            "#endif",
            "",
        ]
    )


def _functions(model: ExportedModel, statements: Statements) -> list[str]:
    if model.rates is None:
        what = "/* The outputs y at the inputs u. */"
        return [_function(model, "outputs", "const double *u", "y", model.results, statements, what)]
    arguments = "const double *x, const double *u"
    sizes = {"name": model.name, "guard": model.name.upper(), "d": len(model.states)}
    return [
        _function(
            model,
            "rates",
            arguments,
            "dx",
            model.rates,
            statements,
            "/* The rates dx of the states x under the inputs u; dx is none of the others. */",
        ),
        _function(
            model,
            "outputs",
            arguments,
            "y",
            model.results,
            statements,
            "/* The outputs y of the states x under the inputs u. */",
        ),
        STEP.format(**sizes),
    ]


def _function(
    model: ExportedModel,
    name: str,
    arguments: str,
    result: str,
    value: Value,
    statements: Statements,
    comment: str,
) -> str:
    unused = [f"(void){part.split('*')[1]};" for part in (*arguments.split(", "), f"double *{result}")]
    body = unused + statements.of(value, result)
    return "\n".join(
        [
            comment,
            f"static inline void {model.name}_{name}({arguments}, double *{result})",
            "{",
            *(f"    {line}" for line in body),
            "}",
            "",
        ]
    )


def _comment(model: ExportedModel) -> str:
    guard = model.name.upper()
    use = USE if model.rates is not None else USE_OF_MAP
    lines = [*model.about, ""]
    for title, letter, quantities in (
        ("States", "x", model.states),
        ("Inputs", "u", model.inputs),
        ("Outputs", "y", model.outputs),
    ):
        if quantities:
            lines += [title, *(_line(letter, i, quantity) for i, quantity in enumerate(quantities)), ""]
    sizes = {
        "inputs": f"{guard}_INPUTS" if model.inputs else "1",
        "outputs": f"{guard}_OUTPUTS" if model.outputs else "1",
    }
    lines += use.format(name=model.name, guard=guard, **sizes).splitlines()
    return "/*\n" + "\n".join(f"   {line}".rstrip() for line in lines).replace("*/", "* /") + "\n*/"


def _line(letter: str, i: int, quantity: Quantity) -> str:
    known = "" if quantity.low is None else f"; known from {quantity.low:.4g} to {quantity.high:.4g}"
    return f"    {letter}[{i}]  {quantity.name} [{quantity.unit}]: {quantity.meaning}{known}"


def _texts(name: str, kind: str, quantities: Sequence[Quantity]) -> str:
    """Functions that give the name and the unit of a quantity by its place."""
    return "\n".join(
        line
        for what in ("name", "unit")
        for line in (
            f"static inline const char *{name}_{kind}_{what}(int i)",
            "{",
            *(f"    {row}" for row in _strings([getattr(quantity, what) for quantity in quantities])),
            f"    return i >= 0 && i < {len(quantities)} ? texts[i] : NULL;",
            "}",
            "",
        )
    )


def _strings(texts: Sequence[str]) -> list[str]:
    # a line each, for a unit may hold spaces, at which no line may end
    rows = [f"    {_quoted(text)}," for text in texts] or ["    NULL"]
    return [f"static const char *const texts[{len(rows)}] = {{", *rows, "};"]


def _quoted(text: str) -> str:
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'


def _start(model: ExportedModel) -> str:
    """Values at rest."""
    arguments = "double *x, double *u" if model.states else "double *u"
    letters = (("x", model.states), ("u", model.inputs)) if model.states else (("u", model.inputs),)
    body = [
        f"    {letter}[{i}] = {quantity.start!r};"
        for letter, quantities in letters
        for i, quantity in enumerate(quantities)
    ]
    unused = [f"    (void){letter};" for letter, _ in letters]
    what = "/* Fills in what there is at rest. */"
    head = f"static inline void {model.name}_start({arguments})"
    return "\n".join([what, head, "{", *unused, *body, "}", ""])


def _within(model: ExportedModel) -> str:
    """Whether a model is taken at its word."""
    letter, quantities = ("x", model.states) if model.states else ("u", model.inputs)
    body = []
    for i, quantity in enumerate(quantities):
        if (limits := allowed_range(quantity)) is not None:
            body.append(
                f"    if (!({letter}[{i}] >= {limits[0]!r} && {letter}[{i}] <= {limits[1]!r}))\n"
                "        return 0;"
            )
    return "\n".join(
        [
            "/* 1 within the range of the training data and 5 % of it, else 0. */",
            f"static inline int {model.name}_within(const double *{letter})",
            "{",
            f"    (void){letter};",
            *body,
            "    return 1;",
            "}",
            "",
        ]
    )
