"""How far two responses of the canonical wing come apart that start a millionth apart (docs/crossover.md).

For each way to draw the modes beyond the first: the largest distance of their tips in 30 s, over the peak.
Run: python benchmarks/predictability.py
"""

import numpy as np
from intrinsic import FIRST, SEED, STARTS, WING, T, basis

from flexsurr.beam import draw_initial_conditions, reduced_order
from flexsurr.config.study import Integrator
from flexsurr.simulation import simulate

TIGHT = Integrator(method="dop853", rtol=1e-9, atol=1e-11)
APART, SIMULATIONS = 1e-6, 3
AT_REST = np.array([WING.length_m, 0.0, 0.0])


def main() -> None:
    """Print the table."""
    for modes in (3, 8):
        own = basis(modes)
        model = reduced_order(own, "hamiltonian", "compiled")
        for drawn in ("as_forced", "as_energetic"):
            settings = STARTS.model_copy(update={"higher_modes": drawn})
            distances = []
            for x in draw_initial_conditions(own, settings, SEED, FIRST, SIMULATIONS):
                one, other = (model.tip(simulate(model, T, s * x, TIGHT).x) for s in (1.0, 1.0 + APART))
                peak = np.linalg.norm(one - AT_REST, axis=1).max()
                distances.append(np.linalg.norm(one - other, axis=1).max() / peak)
            shown = ", ".join(f"{distance:.2g}" for distance in distances)
            print(f"{modes} modes, {drawn}: {shown} of the peak", flush=True)


if __name__ == "__main__":
    main()
