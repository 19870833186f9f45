"""Roots of what is zero but for rounding, as where a contact has just begun, are told with a remedy."""

from __future__ import annotations

import pytest

from contwalk.fields.blame import first_not_finite


def hertz(t, x, p, dx):
    dx[0] = p.k * (-x[0]) ** 1.5


def cut(t, x, p, dx):
    dx[0] = p.k * max(-x[0], 1e-12) ** 1.5


@pytest.mark.parametrize(("x", "rounded"), [(4e-16, True), (0.1, False)])
def test_what_is_negative_by_rounding_has_a_remedy(x, rounded) -> None:
    found = first_not_finite(hertz, 0.0, [x], {"k": 5.0})
    assert found is not None
    assert "pow of" in found
    assert ("write max(..., 1e-12)" in found) == rounded


def test_the_remedy_has_a_value() -> None:
    assert first_not_finite(cut, 0.0, [4e-16], {"k": 5.0}) is None
