"""Pull the tip of a beam of your own, let it go, and see how many modes follow the full-order model.

python examples/tip_load_release.py
"""

import numpy as np

from flexsurr.beam import (
    find_equilibrium,
    full_order,
    reduce,
    reduced_order,
    stiffness_matrix,
    tip_position,
)
from flexsurr.config.load import TipForce
from flexsurr.config.structure import Structure
from flexsurr.config.study import Integrator, Reduction
from flexsurr.simulation import simulate

beam = Structure(
    name="strip",
    length_m=0.6,
    elements=8,
    joints=("out_of_plane",),
    mass_per_length_kg_m=0.3,
    bending_stiffness_out_of_plane_N_m2=1.2,
    damping_out_of_plane_s=1e-3,
)
stiff = Integrator(method="radau_iia_5", rtol=1e-6, atol=1e-9)  # for the fast joints of the full model
t = np.linspace(0.0, 1.0, 501)

pulled = find_equilibrium(beam, TipForce(force_N=2.0))
x, _, z = tip_position(beam, pulled)
print(f"pulled up by 2 N the tip is at x = {x:.4f} m, z = {z:.4f} m")

full = full_order(beam, "hamiltonian", "compiled")
followed = simulate(full, t, np.concatenate([pulled, np.zeros_like(pulled)]), stiff)
energy = full.energy(followed.x)
kept = 100 * energy[-1] / energy[0]
print(f"full order: {followed.steps} steps; after a second {kept:.0f} % of the energy is left")

for modes in (1, 2, 3):
    basis = reduce(beam, Reduction(modes=modes, normalisation="mass"))
    model = reduced_order(basis, "hamiltonian", "compiled")
    eta = np.linalg.solve(basis.stiffness, basis.modes.T @ stiffness_matrix(beam) @ pulled)
    response = simulate(model, t, np.concatenate([eta, np.zeros(modes)]), stiff)
    apart = np.linalg.norm(model.tip(response.x) - full.tip(followed.x), axis=1).max()
    print(f"{modes} mode(s): the tips are up to {1e3 * apart:.1f} mm apart within a second")
