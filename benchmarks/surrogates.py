"""What one right-hand side of a surrogate costs, against the compiled reduced-order model it replaces.

Run alone on the machine:  python benchmarks/surrogates.py
Timed within compiled code, as integrators call it, in turns with the reference. Weights are random: they
make no difference.
"""

import numpy as np
from cantilever import cantilever_model
from numba import njit
from timing import compare

from flexsurr.simulation import rhs
from flexsurr.surrogates import ACTIVATIONS, HNN, MLP, EvenHNN, PolynomialHamiltonian, Scaling, compiled
from flexsurr.surrogates.monomials import monomials_to_degree

COMPILED_CALLS = 5000
REPEATS = 60
WIDTHS = (8, 16, 32, 128)
REFERENCE = "compiled reduced model"
SCALING = Scaling(q=0.35, p=3.5, energy=30.0)
NAMES, UNITS = ("eta_1", "p_1"), ("1", "kg m2/s")


@njit(error_model="numpy")
def call_repeatedly(kernel, t, x, dx, work, count):
    # Each state depends on the one before, as in an integrator: no two calls overlap.
    for _ in range(count):
        rhs(kernel, t, x, dx, work)
        x[0] += 1e-15 * dx[0]


def caller(model):
    x, dx, work = np.array([0.2, 1.0]), np.empty(2), np.empty(model.work_size)
    return lambda: call_repeatedly(model.kernel, 0.0, x, dx, work, COMPILED_CALLS)


def network(form, hidden, activation):
    size = sum(int(np.prod(shape)) for shape in form.shapes(2, hidden))
    weights = np.random.default_rng(0).normal(size=size)
    return compiled(form(weights, SCALING, NAMES, UNITS, hidden, activation))


def even_network(neurons, activation):
    size = sum(int(np.prod(shape)) for shape in EvenHNN.shapes(2, neurons))
    weights = np.random.default_rng(0).normal(size=size)
    return compiled(EvenHNN(weights, SCALING, NAMES, UNITS, (neurons,), activation))


def polynomial(degree, kind):
    exponents = monomials_to_degree(2, degree)
    if kind == "even":
        exponents = exponents[
            (exponents[:, 0] % 2 == 0) & (exponents[:, 1] % 2 == 0) & (exponents[:, 1] <= 2)
        ]
    coefficients = np.random.default_rng(0).normal(size=len(exponents))
    return compiled(PolynomialHamiltonian(coefficients, SCALING, NAMES, UNITS, exponents))


def show(label, models, reference):
    """Nanoseconds a call and, in brackets, times cheaper than the reference."""
    callers = {REFERENCE: caller(reference)} | {str(k): caller(m) for k, m in models.items()}
    timings = compare(f"right-hand side of {label}", callers, REPEATS, counts=COMPILED_CALLS)
    del timings[REFERENCE]
    cells = [f"{1e9 * t.median_s:>6.0f} ({1.0 / t.ratio:>4.1f})" for t in timings.values()]
    print(f"{label:<34}", *cells, flush=True)


def main() -> None:
    reference = cantilever_model("hamiltonian")
    twice = {REFERENCE: caller(reference), "the same again": caller(reference)}
    own = compare("right-hand side", twice, REPEATS, counts=COMPILED_CALLS)[REFERENCE]
    print(f"compiled reduced-order model: {1e9 * own.median_s:.0f} ns a call")
    print("ns a call (times cheaper than that model)")
    for label, kind, degrees in (
        ("polynomial, even, degree", "even", (4, 6, 8, 10)),
        ("all terms", "all", (4, 6)),
    ):
        models = {degree: polynomial(degree, kind) for degree in degrees}
        show(f"{label} {', '.join(map(str, degrees))}", models, reference)
    for activation in ("half_log", "atan"):
        models = {neurons: even_network(neurons, activation) for neurons in (4, 8, 16)}
        show(f"even_hnn {activation}, 4, 8, 16 neurons", models, reference)
    print(f"{'one hidden layer':<34}", *(f"{width:>13}" for width in WIDTHS))
    for form in (HNN, MLP):
        for activation in ACTIVATIONS:
            models = {width: network(form, (width,), activation) for width in WIDTHS}
            show(f"{form.architecture} {activation}", models, reference)
    for form in (HNN, MLP):
        show(
            f"{form.architecture} half_log, 16x16, 32x32",
            {n: network(form, (n, n), "half_log") for n in (16, 32)},
            reference,
        )


if __name__ == "__main__":
    main()
