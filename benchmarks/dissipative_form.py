"""How far the wing's field is from any that a D-HNN can be, along the study's trajectories.

    python benchmarks/dissipative_form.py

Both numbers are 0 for the field of a D-HNN (flexsurr.evaluation.dissipative_structure). States are every
twentieth of fifty free responses of 1 s.
"""

import numpy as np
from wing import ACCURATE, SEED, STRUCTURE

from flexsurr.beam import draw_initial_conditions, reduce, reduced_order
from flexsurr.config.study import InitialConditions, Reduction
from flexsurr.evaluation.dissipative_structure import dissipative_asymmetry
from flexsurr.simulation import simulate

TIMES = np.linspace(0.0, 1.0, 51)
UNDAMPED = {"damping_out_of_plane_s": 0.0, "damping_torsion_s": 0.0}


def main() -> None:
    """Print a row for each normalisation of the modes, damped and not, at full and small amplitude."""
    print("modes  damped    mixed   direct   mixed at a thousandth of the amplitude")
    for normalisation in ("mass", "unit"):
        for structure in (STRUCTURE, STRUCTURE.model_copy(update=UNDAMPED)):
            basis = reduce(structure, Reduction(modes=3, normalisation=normalisation))
            model = reduced_order(basis, "hamiltonian", "compiled")
            starts = draw_initial_conditions(basis, InitialConditions(), SEED, 0, 50)
            states = np.concatenate([simulate(model, TIMES, start, ACCURATE).x for start in starts])
            full, small = (dissipative_asymmetry(model, scale * states) for scale in (1.0, 1e-3))
            damped = "yes" if structure is STRUCTURE else "no"
            print(
                f"{normalisation:<6} {damped:<6} {full.mixed:>8.2g} {full.direct:>8.2g} {small.mixed:>8.1e}"
            )


if __name__ == "__main__":
    main()
