"""What all tests share."""

from hypothesis import settings

# Machines that test are slow at times: an example's time says nothing here. Failures come back on
# their own machine by the printed blob.
settings.register_profile("flexsurr", deadline=None, print_blob=True)
settings.load_profile("flexsurr")
