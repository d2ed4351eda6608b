"""The activation functions that a configuration may name (flexsurr.surrogates.activations has them)."""

from typing import Literal

Activation = Literal["elu", "tanh", "softplus", "silu", "squareplus", "half_log", "atan"]
