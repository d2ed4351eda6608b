"""JᵀJ in pieces: the same whatever the pieces, in memory that does not grow with the samples."""

import tracemalloc

import numpy as np
import pytest

from flexsurr.training.levenberg_marquardt import accumulated

SAMPLES, D, UNKNOWNS = 101, 3, 7


def problem(samples, seed=0):
    """Rows of a random least-squares problem, made when they are asked for."""

    def rows(part, residuals, jacobian):
        first, last, _ = part.indices(samples)
        for s in range(first, last):
            generator = np.random.default_rng([seed, s])
            at = slice((s - first) * D, (s - first + 1) * D)
            residuals[at] = generator.normal(size=D)
            jacobian[at] = generator.normal(size=(D, UNKNOWNS))

    return rows


@pytest.mark.parametrize("chunk", [1, 3 * UNKNOWNS * D, 7 * UNKNOWNS * D + 5, 10**9])
def test_pieces_make_the_whole(chunk):
    residuals, jacobian = np.empty(SAMPLES * D), np.empty((SAMPLES * D, UNKNOWNS))
    problem(SAMPLES)(slice(None), residuals, jacobian)
    found = accumulated(problem(SAMPLES), (SAMPLES, D), UNKNOWNS, chunk)
    assert found.loss == pytest.approx(residuals @ residuals)
    np.testing.assert_allclose(found.gram, jacobian.T @ jacobian, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(found.gradient, jacobian.T @ residuals, rtol=1e-12, atol=1e-12)


def test_memory_does_not_grow_with_the_samples():
    def peak(samples):
        tracemalloc.start()
        accumulated(problem(samples), (samples, D), UNKNOWNS, 50 * UNKNOWNS * D)
        _, most = tracemalloc.get_traced_memory()
        tracemalloc.stop()
        return most

    assert peak(5000) < 1.2 * peak(500)
