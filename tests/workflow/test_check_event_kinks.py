"""Guards, resets and fields of machines with events that jump, or whose slopes do, told by the check."""

from __future__ import annotations

import pytest
from arm_machine import ARM
from checked_plugins import line_of

from contwalk.plugin_check import event_kinks
from contwalk.plugin_check.system import check_reference


def told(tmp_path, *changes):
    """Findings of an arm with some texts replaced, by their level, what they say and their line."""
    source = ARM
    for old, new in changes:
        assert old in source
        source = source.replace(old, new)
    path = tmp_path / "arm.py"
    path.write_text(source)
    return source, [(f.level, f.what, f.sentence, f.line) for f in check_reference(str(path))]


@pytest.mark.parametrize(
    ("change", "what", "said", "line"),
    [
        (
            ("speed = x[1]", "speed = x[1] if x[2] > 0.1 else 0.5 * x[1]"),
            "reset of transition 'pad'",
            "It jumps here",
            "speed = x[1] if",
        ),
        (
            ("speed = x[1]", "speed = max(x[1], 0.5 * x[1] + 0.2)"),
            "reset of transition 'pad'",
            "Its slopes jump here",
            "speed = max",
        ),
        (
            ("return 0.6 - x[0]", "return 0.6 + 0.3 * abs(x[2]) - x[0]"),
            "guard of transition 'pad'",
            "Its slopes jump here",
            "return 0.6 + 0.3",
        ),
    ],
)
def test_kinks_at_the_event_are_told(change, what, said, line, tmp_path):
    source, found = told(tmp_path, change)
    assert [
        level
        for level, of, sentence, at in found
        if of == what and said in sentence and at == line_of(source, line)
    ] == ["warning"]


@pytest.mark.parametrize(
    "change",
    [
        ("speed = x[1]", "speed = x[1] if x[0] < 3.0 else 0.2 * x[1]"),
        ("return 0.6 - x[0]", "return (0.6 - x[0]) * (2.0 if x[0] > 5.0 else 1.0)"),
        ("return 0.6 - x[0]", "return 0.6 - min(x[0], 5.0)"),
        # Slopes off the guard's surface, which no motion meets, and another number with the same zeros.
        ("speed = x[1]", "speed = x[1] + abs(x[0] - 0.6)"),
        ("return 0.6 - x[0]", "return (0.6 - x[0]) / (1.0 + abs(x[2]))"),
    ],
)
def test_pieces_that_no_event_meets_are_not(change, tmp_path):
    _, found = told(tmp_path, change)
    assert not [sentence for _, _, sentence, _ in found if "jump" in sentence]


def test_field_that_jumps_in_time_is_told_as_a_run_refuses_it(tmp_path):
    changes = ("p.force * math.cos(t)", "p.force * (1.0 if math.cos(t) > 0.0 else -1.0)")
    source, found = told(tmp_path, changes)
    (level, _, sentence, line), *_ = [each for each in found if "jumps here" in each[2]]
    assert level == "warning"
    assert "an orbit that crosses this place is refused" in sentence
    assert line == line_of(source, "dx[1] = p.force")


def test_places_on_a_guard_are_asked_for_only_where_something_chooses(tmp_path, monkeypatch):
    """They took a fifth of the time of all checks of a machine of 200 modes that is smooth at its events."""
    asked = []
    monkeypatch.setattr(event_kinks, "_pieces", lambda *given: asked.append(given) or [])
    told(tmp_path)
    assert not asked
    told(tmp_path, ("speed = x[1]", "speed = max(x[1], 0.5 * x[1] + 0.2)"))
    assert asked
