"""Learned right-hand sides: architectures, scaling, compiled and saved forms."""

from flexsurr.surrogates.activations import ACTIVATIONS
from flexsurr.surrogates.compiled import CompiledSurrogate, compiled
from flexsurr.surrogates.hnn import HNN
from flexsurr.surrogates.mlp import MLP
from flexsurr.surrogates.network import Network
from flexsurr.surrogates.polynomial import PolynomialHamiltonian
from flexsurr.surrogates.saved import SurrogateFileError, load, load_model, save
from flexsurr.surrogates.scaling import Scaling, canonical_scaling
from flexsurr.surrogates.surrogate import Hamiltonian, Surrogate

__all__ = [
    "ACTIVATIONS",
    "HNN",
    "MLP",
    "CompiledSurrogate",
    "Hamiltonian",
    "Network",
    "PolynomialHamiltonian",
    "Scaling",
    "Surrogate",
    "SurrogateFileError",
    "canonical_scaling",
    "compiled",
    "load",
    "load_model",
    "save",
]
