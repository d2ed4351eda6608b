"""What all tests share."""

from pathlib import Path

from hypothesis import settings

from flexsurr import kernel_cache

# Kernels that only tests define, by which the package's own machine code must not be kept.
kernel_cache.activate(Path(__file__).parent / "simulation" / "closed_form_problems.py")

# Machines that test are slow at times: an example's time says nothing here. Failures come back on
# their own machine by the printed blob.
settings.register_profile("flexsurr", deadline=None, print_blob=True)
settings.load_profile("flexsurr")
