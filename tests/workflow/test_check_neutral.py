"""What is neutral for some parameters, or at equilibria, only is no mistake, and is said."""

from __future__ import annotations

import pytest
from hostile_machines import WHEEL

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
        (
            [("math.sin(x[0])", "math.sin(x[0] + x[2])")],
            "nothing shows it to be neutral; at the defaults dx[1]",
        ),
        ([("x[2] + 0.5", "p.k * x[2]")], "at the defaults; with k = 1 it does."),
        ([("math.sin(x[0])", "math.sin(x[0]) - p.k * x[2]")], "is neutral with k = 0; at the defaults dx[1]"),
        ([("0.4 - x[0]", "0.4 - x[0] + p.k * x[2]")], "its guard changes along it, by 0.5 at the defaults"),
    ],
)
def test_what_may_be_neutral_for_some_parameters_only(told, changes, said):
    findings = told(*changes)
    assert {level for level, _ in findings} == {"ok"}
    assert any(said in sentence for _, sentence in findings), findings


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
