"""flexsurr: when does a neural-network surrogate of a flexible structure pay, how much, at what loss?"""

from flexsurr import kernel_cache

__version__ = "0.1.0"

kernel_cache.activate()
