"""Mappings are chosen by their kernel's class, in compiled code."""

from typing import NamedTuple

import numpy as np
import pytest

from flexsurr.simulation.mapping import evaluate_mapping, implements_mapping, mapping


class Unknown(NamedTuple):
    """No mapping is registered for this."""

    scale: float


def test_from_python_it_says_what_to_do():
    with pytest.raises(TypeError, match="Unknown; call mapping from compiled code"):
        mapping(Unknown(1.0), np.zeros(1), np.zeros(1), np.zeros(1))


def test_a_class_without_a_mapping_does_not_compile():
    with pytest.raises(Exception, match="mapping"):
        evaluate_mapping(Unknown(1.0), np.zeros((1, 1)), np.zeros((1, 1)), np.zeros(1))


def test_classes_from_outside_ask_for_a_folder_of_their_own():
    with pytest.raises(RuntimeError, match="defined outside flexsurr"):
        implements_mapping(Unknown)
