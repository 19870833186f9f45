"""Kinds of special points that a system declares: what is refused, and which problems ask for them."""

from __future__ import annotations

import pytest
from reversing_map import ReversingMap
from saddle_quantity import SaddleQuantity
from small_systems import circle, small_system

import contwalk as cw
from contwalk.errors import SystemDefinitionError


def declared(*kinds):
    return small_system(circle, "xy", {"mu": 1.0}, point_types=kinds)


def labelled_as(name):
    """A kind with this label."""
    return type("Named", (SaddleQuantity,), {"label": name})()


def test_equilibria_and_orbits_are_asked_for_their_own():
    system = declared(SaddleQuantity(), ReversingMap())
    resting = cw.Equilibrium(system, system.defaults(), "mu").point_types
    moving = cw.PeriodicOrbit(system, system.defaults(), "mu").point_types
    assert [kind.label for kind in resting if kind.label in ("SQ", "ZM")] == ["SQ"]
    assert [kind.label for kind in moving if kind.label in ("SQ", "ZM")] == ["ZM"]


def test_others_have_none_of_them():
    declared(SaddleQuantity())
    assert "SQ" not in {kind.label for kind in cw.Equilibrium(declared(), {"mu": 1.0}, "mu").point_types}


@pytest.mark.parametrize(
    ("kinds", "said"),
    [
        ((SaddleQuantity,), "Each entry must be a KindOfPoint"),
        ((SaddleQuantity(), SaddleQuantity()), "has 'SaddleQuantity' twice"),
        ((labelled_as("sq"),), "the label of Named is 'sq'"),
        ((labelled_as("LP"),), "LP, the label of Named, is that of every fold"),
        ((labelled_as("BT"),), "BT, the label of Named, is that of every Bogdanov-Takens point"),
    ],
)
def test_what_is_no_kind_is_refused(kinds, said):
    with pytest.raises(SystemDefinitionError, match=said):
        declared(*kinds)
