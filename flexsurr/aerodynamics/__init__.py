"""The airliner's aerodynamics: a vortex lattice rebuilt, frozen, or reduced to its quadratic form."""
