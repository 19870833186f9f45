"""What is neutral for some parameters, or at equilibria, only is no mistake, and is said."""

from __future__ import annotations

import pytest
from hostile_machines import WHEEL

from contwalk.errors import SystemDefinitionError
from contwalk.plugin_check.at_load import load_system
from contwalk.plugin_check.system import check_reference


@pytest.fixture
def told(tmp_path):
    """What is said of the neutral direction of a wheel with pieces replaced."""

    def findings(*changes):
        text = WHEEL
        for old, new in changes:
            assert old in text
            text = text.replace(old, new, 1)
        path = tmp_path / "wheel.py"
        path.write_text(text, encoding="utf-8")
        load_system(path)
        return [(f.level, f.sentence) for f in check_reference(str(path)) if "neutral" in f.what]

    return findings


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ([("x[2] + 0.5", "p.k * x[2]")], "at the defaults; with k = 1 it does."),
        ([("math.sin(x[0])", "math.sin(x[0]) - p.k * x[2]")], "is neutral with k = 0; at the defaults dx[1]"),
        ([("0.4 - x[0]", "0.4 - x[0] + p.k * x[2]")], "its guard changes along it, by 0.5 at the defaults"),
    ],
)
def test_what_may_be_neutral_for_some_parameters_only(told, changes, said):
    findings = told(*changes)
    assert {level for level, _ in findings} == {"ok"}
    assert any(said in sentence for _, sentence in findings), findings


# An oscillator's phase plane, turned about its origin.
TURNED = """\
import math
from contwalk.system import Mode, Neutral, Parameter, State, System

def swing(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -p.k * x[0] + p.mu * (1.0 - x[0] ** 2) * x[1]

def turn(t, x, p, v):
    v[0], v[1] = -x[1], x[0]

SYSTEM = System(
    name="oscillator",
    states=(State("x"), State("y")),
    parameters=(Parameter("k", 2.5), Parameter("mu", 0.5)),
    modes=(Mode("swinging", swing),),
    neutral=(Neutral("phase", turn),),
)
"""


@pytest.fixture
def told_of_turning(tmp_path):
    """What is said of the neutral direction of a turned phase plane with pieces replaced."""

    def findings(*changes):
        text = TURNED
        for old, new in changes:
            assert old in text
            text = text.replace(old, new, 1)
        path = tmp_path / "turned.py"
        path.write_text(text, encoding="utf-8")
        return [(f.level, f.sentence) for f in check_reference(str(path)) if "neutral" in f.what], path

    return findings


def test_what_two_parameters_make_neutral_together_is_found(told_of_turning):
    """k = 1 and mu = 0: the circle; neither alone will do."""
    findings, _ = told_of_turning()
    assert {level for level, _ in findings} == {"ok"}
    assert any("is neutral with k = 1, mu = 0; at the defaults" in sentence for _, sentence in findings), (
        findings
    )


@pytest.mark.parametrize(
    "changes",
    [
        [("-p.k * x[0]", "-2.5 * x[0]")],
        [("v[0], v[1] = -x[1], x[0]", "v[0], v[1] = x[0], 3.0 * x[1] + 1.0"), ("(1.0 - x", "(1.0 - p.k * x")],
    ],
    ids=["another frequency", "states scaled"],
)
def test_a_direction_that_depends_on_the_state_and_is_neutral_nowhere_is_doubted(told_of_turning, changes):
    findings, _ = told_of_turning(*changes)
    doubts = [sentence for level, sentence in findings if level == "warning"]
    assert len(doubts) == 1
    assert "Nothing shows it to be neutral" in doubts[0]


def test_a_direction_that_depends_on_the_state_is_refused_where_its_bracket_is_never_zero(told_of_turning):
    """Df v - Dv f has -1 - exp x0 as its first entry, whatever the state is."""
    findings, path = told_of_turning(
        ("dx[0] = x[1]", "dx[0] = 1.0"),
        ("v[0], v[1] = -x[1], x[0]", "v[0], v[1] = x[0] + math.exp(x[0]), 1.0"),
    )
    assert [level for level, _ in findings if level != "ok"] == ["error"]
    assert any("It is neutral nowhere: moved along it, dx[0] (state x) changes" in s for _, s in findings)
    with pytest.raises(SystemDefinitionError, match="neutral nowhere"):
        load_system(path)


def test_a_direction_that_is_neutral_at_one_equilibrium_only_is_found(told_of_turning):
    """y = 0 is a line of equilibria where mu = 0 and k = 0; along v = (1 + x^2, 0) it is neutral."""
    findings, _ = told_of_turning(
        ("dx[0] = x[1]", "dx[0] = x[1] ** 2 * x[0]"),
        ("-p.k * x[0] + p.mu", "x[1] + p.mu"),
        ("v[0], v[1] = -x[1], x[0]", "v[0], v[1] = 1.0 + x[0] ** 2, 0.0"),
    )
    assert {level for level, _ in findings} == {"ok"}
    assert any("at the equilibrium x = " in sentence for _, sentence in findings), findings


def test_a_constant_direction_that_is_neutral_nowhere_is_doubted(told):
    """The angle's sine decides: where it is zero, moving along s changes the rate most."""
    findings = told(("math.sin(x[0])", "math.sin(x[0] + x[2])"))
    assert [level for level, _ in findings if level != "ok"] == ["warning"]
    assert any("Nothing shows it to be neutral: dx[1]" in sentence for _, sentence in findings), findings


def test_what_is_neutral_at_equilibria_only(told):
    """The direction rests nowhere but where nothing moves: a line of equilibria that the plugin names."""
    start = 'starts=(Start("rest", lambda p: [[0.0, 0.0, 0.3]]),),\n    neutral='
    findings = told(
        ("import Mode", "import Start, Mode"),
        ("neutral=", start),
        ("x[1] * math.cos(x[0])", "x[1] * math.cos(x[2])"),
    )
    assert {level for level, _ in findings} == {"ok"}
    assert any("is neutral at equilibria that are named" in sentence for _, sentence in findings), findings


def test_a_mirror_turns_a_direction_round(told):
    """After it the direction points the other way: the same family."""
    assert {level for level, _ in told(("x[2] + 0.5", "0.5 - x[2]"))} == {"ok"}


def test_what_cancels_but_for_rounding_is_neutral(told):
    """0.1 + 0.2 - 0.3 is not zero in floats, and is no change."""
    cancels = "math.sin(x[0]) + 0.1 * x[2] + 0.2 * x[2] - 0.3 * x[2]"
    assert {level for level, _ in told(("math.sin(x[0])", cancels))} == {"ok"}
