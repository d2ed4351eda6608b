"""What all tests share."""

from pathlib import Path

from hypothesis import settings

from flexsurr import kernel_cache

# Kernels that only tests define, by which the package's own machine code must not be kept.
kernel_cache.activate(Path(__file__).parent / "simulation" / "closed_form_problems.py")

# Machines that test are slow at times: an example's time says nothing here. The same examples each time:
# who tests a change shall not meet what chance finds elsewhere. To look further: --hypothesis-profile=search
settings.register_profile("flexsurr", deadline=None, derandomize=True)
settings.register_profile("search", deadline=None, print_blob=True, max_examples=1000)
settings.load_profile("flexsurr")
