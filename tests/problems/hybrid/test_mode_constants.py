"""Modes that share a field and differ by constants and by the states that exist in them.

An oscillator that meets a second spring at a gap, and a follower that lives while there is contact: once with
a field for each mode, once with one field that reads what the mode is.
"""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest
from hybrid_runs import ACCURACY, diagram

import contwalk as cw
from contwalk.branch import Branch
from contwalk.errors import SystemDefinitionError
from contwalk.flow import Restricted, adaptive
from contwalk.flow.compiled.traced import field_of
from contwalk.plugin_check.system import check_system
from contwalk.problems.hybrid.source_text import equations_text
from contwalk.system import Mode, Observable, Parameter, State, System, Transition

OMEGA, GAP = 0.9, 0.5
STATES = ("q", "v", "y")


def free(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = p.force * math.cos(OMEGA * t) - 0.2 * x[1] - x[0]


def contact(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = p.force * math.cos(OMEGA * t) - 0.2 * x[1] - x[0] - 8.0 * (x[0] - GAP)
    dx[2] = x[0] - x[2]


def either(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = p.force * math.cos(OMEGA * t) - 0.2 * x[1] - x[0] - p.touching * 8.0 * (x[0] - GAP)
    dx[2] = p.touching * (x[0] - x[2])


def gap(t, x, p):
    return GAP - x[0]


def apart(t, x, p):
    return x[0] - GAP


def from_rest(t, x, p, x_plus):
    x_plus[0], x_plus[1], x_plus[2] = x[0], x[1], 0.0


def machine(shared: bool) -> System:
    fields = (either, either) if shared else (free, contact)
    constants = ({"touching": 0.0}, {"touching": 1.0}) if shared else ({}, {})
    return System(
        name="hanging",
        states=tuple(State(name) for name in STATES),
        parameters=(Parameter("force", 0.3),),
        modes=(
            Mode("free", fields[0], states=("q", "v"), constants=constants[0]),
            Mode("contact", fields[1], constants=constants[1]),
        ),
        transitions=(
            Transition("touch", "free", "contact", gap, reset=from_rest),
            Transition("leave", "contact", "free", apart),
        ),
        observables=(Observable("q_max", lambda t, x, p: x[:, 0].max()),),
        period=lambda p: 2.0 * math.pi / OMEGA,
    )


@cache
def branches(shared: bool) -> list[Branch]:
    start = {"mode": "free", "until": "settled", "marks": {"force": [0.4]}}
    return diagram(machine(shared), "force", (0.3, 0.5), [0.0, 0.0, 0.0], **start)


@pytest.mark.long
def test_their_orbits_are_those_of_modes_with_fields_of_their_own():
    one, two = ([point for b in branches(shared) for point in b.special_points] for shared in (True, False))
    assert [point.label for point in one] == [point.label for point in two]
    assert "UZ" in [point.label for point in one]
    for ours, other in zip(one, two, strict=True):
        assert ours.parameters["force"] == pytest.approx(other.parameters["force"], rel=3.0 * ACCURACY)
        np.testing.assert_allclose(ours.spectrum, other.spectrum, rtol=30 * ACCURACY, atol=30 * ACCURACY)


def test_rates_and_derivatives_are_those_of_the_states_that_exist():
    ours, other = (field_of(machine(shared), "free") for shared in (True, False))
    assert isinstance(ours, Restricted)
    x, c, d = np.array([0.2, -0.4]), ours.constants([0.3]), other.constants([0.3])
    np.testing.assert_array_equal(ours(0.7, x, c), other(0.7, x, d))
    np.testing.assert_array_equal(ours.jacobian(0.7, x, c), other.jacobian(0.7, x, d))
    paths = [adaptive(f, k, 0.0, x, 2.0, 1e-10, np.ones(2)) for f, k in ((ours, c), (other, d))]
    np.testing.assert_array_equal(paths[0].states[-1], paths[1].states[-1])


def test_modes_share_what_is_compiled():
    system = machine(True)
    one, two = (field_of(system, mode) for mode in ("free", "contact"))
    assert one.whole is two.whole


def test_a_plugin_is_checked_with_them():
    findings = check_system(machine(True))
    assert [finding.sentence for finding in findings if finding.level == "error"] == []
    shared = "field of mode 'free', which 2 modes share"
    assert [finding.level for finding in findings if finding.what == shared] == ["ok"]


def test_the_equations_change_with_the_constants():
    def text(**changed: float) -> str:
        system = machine(True)
        modes = (system.modes[0], Mode("contact", either, constants={"touching": 1.0, **changed}))
        return equations_text(cw.system.System(**{**vars_of(system), "modes": modes}), "force")

    assert text() != text(touching=0.5)


def vars_of(system: System) -> dict:
    names = ("name", "states", "parameters", "modes", "transitions", "period")
    return {name: getattr(system, name) for name in names}


def test_constants_have_names_of_their_own():
    system = machine(True)
    modes = (Mode("free", either, constants={"force": 1.0}), system.modes[1])
    with pytest.raises(SystemDefinitionError, match="'force', which is a parameter"):
        System(**{**vars_of(system), "modes": modes})


@pytest.mark.parametrize(
    ("constants", "said"), [({"touching": math.nan}, "finite"), ({"not a name": 1.0}, "constant")]
)
def test_constants_are_named_finite_numbers(constants, said):
    with pytest.raises(SystemDefinitionError, match=said):
        Mode("contact", either, constants=constants)


def test_a_mode_without_states_is_refused_with_what_to_do():
    with pytest.raises(SystemDefinitionError, match=r"Mode 'rest' has no states") as told:
        System(
            "waiting",
            states=(State("v"),),
            parameters=(Parameter("force", 0.3),),
            modes=(Mode("up", free), Mode("rest", free, states=())),
        )
    assert "a rate of zero" in told.value.remedy


def test_a_mode_with_constants_does_not_write_what_does_not_exist_in_it():
    """Of a field of its own, too: the follower's rate is missing from `free`."""
    system = machine(False)
    modes = (Mode("free", free, states=("q", "v"), constants={"touching": 0.0}), system.modes[1])
    start = {"mode": "free", "until": "settled", "marks": {"force": [0.4]}}
    found = diagram(
        System(**{**vars_of(system), "modes": modes}), "force", (0.3, 0.5), [0.0, 0.0, 0.0], **start
    )
    points = [[p.parameters["force"] for p in b.special_points] for b in found]
    assert points == [[p.parameters["force"] for p in b.special_points] for b in branches(False)]
