"""Whether a low rank makes sparse polynomials of the canonical wing's mass matrix cheaper: docs/crossover.md.

M(q) = F + Σ_k A_k φ_k(q), with φ_k shared by entries: of the entries with the same monomials, what a singular
value decomposition of their coefficients leaves. m monomials of e entries take m e products, in rank k they
take k (m + e). Run: python benchmarks/low_rank.py
"""

import numpy as np
from intrinsic import STARTS, basis

from flexsurr.surrogates.monomials import runs
from flexsurr.surrogates.sparse_mass import sparse_kernel
from flexsurr.training.configuration_samples import configuration_samples
from flexsurr.training.known_mass import fit_sparse

SAMPLES, DEGREE = 4000, 4
ALLOWED = (1e-2, 1e-3, 1e-4)
"""What is left out of all coefficients of q over its ranges, beside their size."""


def groups(modes: int):
    """Coefficients (entries, monomials) of each group of entries with the same monomials, and their sizes."""
    samples = configuration_samples(basis(modes), "hamiltonian", STARTS, SAMPLES)
    found = fit_sparse(samples, DEGREE)
    matrix = found.parameters[: -2 * found.packed_size].reshape(found.packed_size, -1)
    order, pieces = runs(found.exponents)
    kernel, _ = sparse_kernel(np.ones(modes), pieces, matrix[:, order], found.stiffness, found.damping)
    shapes = [(int(entries), int(monomials)) for monomials, entries in kernel.groups]
    ends = np.cumsum([entries * monomials for entries, monomials in shapes])[:-1]
    return [part.reshape(shape) for part, shape in zip(np.split(kernel.mass, ends), shapes, strict=True)]


def products(coefficients, allowed: float) -> int:
    """Of a group of entries in the lowest rank that leaves out `allowed` of each."""
    entries, monomials = coefficients.shape
    scaled = coefficients / np.linalg.norm(coefficients[:, 1:], axis=1, keepdims=True).clip(1e-300)
    values = np.linalg.svd(scaled[:, 1:], compute_uv=False)
    left = np.sqrt(np.cumsum((values**2)[::-1])[::-1] / entries)
    rank = int(np.sum(left > allowed))
    return min(rank * (entries + monomials), entries * monomials)


def main() -> None:
    """Print the table."""
    print("| modes | entries by group | products | " + " | ".join(f"to {part:g}" for part in ALLOWED) + " |")
    print("|---" * (3 + len(ALLOWED)) + "|")
    for modes in (3, 6, 8, 10):
        found = groups(modes)
        counts = [sum(part.size for part in found)]
        counts += [sum(products(part, allowed) for part in found) for allowed in ALLOWED]
        sizes = ", ".join(str(len(part)) for part in found)
        print(f"| {modes} | {sizes} | " + " | ".join(map(str, counts)) + " |", flush=True)


if __name__ == "__main__":
    main()
