"""What is said where a branch ends at a limit: sentences, and the settings that go on."""

from __future__ import annotations

import pytest

from contwalk.branch import SpecialPoint
from contwalk.continuation.outcomes import limit
from contwalk.problems.orbit.points.catalogue import LIMIT_TYPES
from contwalk.problems.problem import LimitType
from contwalk.workflow.stored.hybrid_words import _meaning

WORDS = "'impact' is touched."


class OfACurve(LimitType):
    """As those of curves in two parameters: told under another label."""

    label, reason, like = "GRGR", "grazing", "GR"


def kind(label):
    return next(each for each in LIMIT_TYPES if each.label == label)


def test_each_way_on_is_a_sentence_of_its_own():
    message = limit(kind("GR"), False, "stop", WORDS).message
    assert message == (
        "'impact' is touched. --set events.GR=ignore goes on past it. "
        "--set events.GR=switch goes on to orbits of another signature."
    )


def test_nothing_goes_past_a_terminal_one():
    message = limit(kind("GR"), True, "stop", WORDS).message
    assert "passes that guard earlier" in message
    assert message.endswith("--set events.GR=switch goes on to orbits of another signature.")
    assert "ignore" not in message


@pytest.mark.parametrize("final", [False, True])
def test_no_way_is_promised_where_there_is_none(final):
    """A terminal limit of a curve in two parameters once ended in "To go on ."."""
    message = limit(OfACurve(), final, "stop", WORDS).message
    assert "To go on" not in message
    assert message.endswith(".")
    assert not message.endswith(" .")


def test_a_guard_whose_name_is_not_known_is_not_named():
    point = SpecialPoint("GR", 0.0, kind="terminal")
    assert _meaning(point, None, None).startswith("the guard that ends a segment is touched before its end")
