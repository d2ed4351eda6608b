"""flexsurr: when does a neural-network surrogate of a flexible structure pay, how much, at what loss?"""

__version__ = "0.1.0"
