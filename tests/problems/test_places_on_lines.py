"""Places on lines through the space of parameters, in words."""

from __future__ import annotations

import pytest
from small_systems import small_system

import contwalk as cw
from contwalk.errors import SystemDefinitionError
from contwalk.problems.locus.lines import along_parameter, along_tangent
from contwalk.problems.orbit.discretization import Discretization
from contwalk.problems.parameter_line import ParameterLine


def test_a_place_is_told_by_what_a_user_has_named():
    values = {"a": 0.5, "b": 2.0, "c": 1.0}
    assert ParameterLine("a", values).described(0.75) == "a = 0.75"
    path = ParameterLine("path", values, ({"a": 0.0, "b": 0.0, "c": 0.0}, values))
    assert path.described(0.25) == "path = 0.25"


def test_a_place_on_a_line_through_a_plane_is_told_by_both_parameters():
    values = {"a": 0.5, "b": 2.0, "c": 1.0}
    assert along_tangent(values, ("a", "b"), (0.5, -2.0)).described(0.5) == "a = 0.75, b = 1"
    assert along_parameter(values, ("a", "b"), 1).described(3.0) == "a = 0.5, b = 3"


def test_another_argument_in_the_place_of_a_path_is_told_in_a_sentence():
    system = small_system(lambda t, x, p, dx: dx.__setitem__(0, p.a - x[0]), "x", {"a": 1.0})
    for kind in (cw.PeriodicOrbit, cw.Equilibrium):
        with pytest.raises(SystemDefinitionError, match=r"this is a Discretization\. .*discretization="):
            kind(system, system.defaults(), "a", Discretization())
