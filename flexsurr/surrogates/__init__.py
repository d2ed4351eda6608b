"""Learned right-hand sides: architectures, scaling, compiled and saved forms."""

from flexsurr.surrogates.activations import ACTIVATIONS
from flexsurr.surrogates.archive import SurrogateFileError
from flexsurr.surrogates.compiled import CompiledSurrogate, compiled
from flexsurr.surrogates.dissipative_hnn import DissipativeHNN
from flexsurr.surrogates.hnn import HNN
from flexsurr.surrogates.learned_load import LearnedLoad
from flexsurr.surrogates.learned_map import LearnedMap, NetworkMap, PolynomialMap, load_map, save_map
from flexsurr.surrogates.mlp import MLP
from flexsurr.surrogates.network import Network
from flexsurr.surrogates.polynomial import PolynomialHamiltonian
from flexsurr.surrogates.port_hamiltonian import PortHamiltonian
from flexsurr.surrogates.port_hamiltonian_network import NetworkPortHamiltonian
from flexsurr.surrogates.port_hamiltonian_polynomial import PolynomialPortHamiltonian
from flexsurr.surrogates.saved import load, load_model, save
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
from flexsurr.surrogates.surrogate import Hamiltonian, Surrogate

__all__ = [
    "ACTIVATIONS",
    "HNN",
    "MLP",
    "CompiledSurrogate",
    "DissipativeHNN",
    "FeatureScaling",
    "Hamiltonian",
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
    "load",
    "load_map",
    "load_model",
    "min_max_scaling",
    "pair_scaling",
    "save",
    "save_map",
]
