"""Fit a surrogate of a beam, export it as a C header, and run that in a real-time loop of a millisecond.

python examples/real_time.py          needs a C compiler
"""

import shutil
import subprocess
import tempfile
from pathlib import Path

from flexsurr.beam import reduce
from flexsurr.config.structure import Structure
from flexsurr.config.study import InitialConditions, Reduction
from flexsurr.export import c_header, exported_surrogate
from flexsurr.training.configuration_samples import configuration_samples
from flexsurr.training.inverse_dynamics import fit_port_hamiltonian
from flexsurr.training.saved_surrogate import SavedSurrogate

LOOP = Path(__file__).with_name("real_time_loop.c")

beam = Structure(
    name="strip",
    length_m=0.6,
    elements=8,
    joints=("out_of_plane",),
    mass_per_length_kg_m=0.3,
    bending_stiffness_out_of_plane_N_m2=1.2,
    damping_out_of_plane_s=1e-3,
)
basis = reduce(beam, Reduction(modes=2, normalisation="mass"))
# momenta are drawn for this strip, which weighs 0.2 kg
samples = configuration_samples(basis, "hamiltonian", InitialConditions(p_max_kg_m2_s=0.02), 500)
surrogate = SavedSurrogate(
    surrogate=fit_port_hamiltonian(samples, 6),
    study="example",
    variant="hamiltonian",
    run_id="strip",
    low=samples.x_train.min(axis=0),
    high=samples.x_train.max(axis=0),
    basis=basis,
)

compiler = next(filter(shutil.which, ("cc", "gcc", "clang")), None)
if compiler is None:
    raise SystemExit("no C compiler here: install gcc or clang")
with tempfile.TemporaryDirectory() as folder:
    (Path(folder) / "strip.h").write_text(c_header(exported_surrogate(surrogate)))
    program = Path(folder) / "real_time_loop"
    subprocess.run(
        [compiler, "-std=c99", "-O2", "-I", folder, "-o", str(program), str(LOOP), "-lm"], check=True
    )
    print(subprocess.run([program], check=True, capture_output=True, text=True).stdout, end="")
