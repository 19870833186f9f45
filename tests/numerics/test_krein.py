"""Eigenvalues and multipliers in pairs, however large they are."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

from contwalk.numerics.krein import hamiltonian, symplectic


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        ((2.0, 0.5, 3.0, 1.0 / 3.0), True),
        ((1e240, 1e-240, 1e100, 1e-100), True),
        ((-1e240, 1e-240, 1e100, 1e-100), False),
        ((1e240, 1e-240, 1e238, 1e-100), False),
        ((1e300, 1e-310, 2.0, 0.5), False),  # the partner of the second one is no number
        ((0.0, 1.0, 2.0, 0.5), False),
    ],
)
def test_multipliers_in_pairs(values, expected):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert symplectic(np.array(values, dtype=complex)) is expected


@pytest.mark.parametrize(("unit", "expected"), [(1.0, True), (1e200, True), (1e-200, True), (0.0, True)])
def test_eigenvalues_in_pairs(unit, expected):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert hamiltonian(unit * np.array([3.0, -3.0, 2j, -2j])) is expected
        assert not hamiltonian(unit * np.array([3.0, -3.0, 2j, 1.0]) + 1e-250)
