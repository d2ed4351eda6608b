"""Learned right-hand sides: architectures, scaling, compiled and saved forms."""

from flexsurr.surrogates.activations import ACTIVATIONS
from flexsurr.surrogates.even_hnn import EvenHNN
from flexsurr.surrogates.forces import LearnedLoad
from flexsurr.surrogates.hnn import HNN, DissipativeHNN
from flexsurr.surrogates.layers import Network
from flexsurr.surrogates.learned_map import Intervals, LearnedMap, generalised_force
from flexsurr.surrogates.mlp import MLP
from flexsurr.surrogates.network_map import NetworkMap
from flexsurr.surrogates.polynomial import PolynomialHamiltonian
from flexsurr.surrogates.polynomial_map import PolynomialMap
from flexsurr.surrogates.port_hamiltonian import PortHamiltonian
from flexsurr.surrogates.port_hamiltonian_network import NetworkPortHamiltonian
from flexsurr.surrogates.port_hamiltonian_polynomial import PolynomialPortHamiltonian
from flexsurr.surrogates.saved import SurrogateFileError, load, load_map, load_model, save, save_map
from flexsurr.surrogates.scaling import (
    FeatureScaling,
    PairScaling,
    Scaling,
    StateScaling,
    canonical_scaling,
    feature_scaling,
    min_max_scaling,
    pair_scaling,
)
from flexsurr.surrogates.surrogate import CompiledSurrogate, Hamiltonian, Surrogate, compiled

__all__ = [
    "ACTIVATIONS",
    "HNN",
    "MLP",
    "CompiledSurrogate",
    "DissipativeHNN",
    "EvenHNN",
    "FeatureScaling",
    "Hamiltonian",
    "Intervals",
    "LearnedLoad",
    "LearnedMap",
    "Network",
    "NetworkMap",
    "NetworkPortHamiltonian",
    "PairScaling",
    "PolynomialHamiltonian",
    "PolynomialMap",
    "PolynomialPortHamiltonian",
    "PortHamiltonian",
    "Scaling",
    "StateScaling",
    "Surrogate",
    "SurrogateFileError",
    "canonical_scaling",
    "compiled",
    "feature_scaling",
    "generalised_force",
    "load",
    "load_map",
    "load_model",
    "min_max_scaling",
    "pair_scaling",
    "save",
    "save_map",
]
