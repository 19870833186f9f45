"""What a curve would have been that could not be begun."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from contwalk.problems.unbegun import born_of

CYCLES, HYBRID, RESTS = "periodic_orbit", "hybrid_orbit", "equilibrium"


@pytest.mark.parametrize(
    ("own", "of_problem", "label", "of", "of_which"),
    [
        ("HB", RESTS, "GH", "LP", CYCLES),
        ("HB", RESTS, "HH", "NS", CYCLES),
        ("LP", RESTS, "ZH", "NS", CYCLES),
        ("LP", RESTS, "BT", "HB", RESTS),
        ("HB", RESTS, "BT", "LP", RESTS),
        ("BP", RESTS, "BP", "BP", RESTS),
        ("LP", HYBRID, "R1", "NS", HYBRID),
        ("BP", HYBRID, "R1", "NS", HYBRID),
        ("PD", HYBRID, "R2", "NS", HYBRID),
        ("PD", CYCLES, "GPD", "LP", CYCLES),
        ("GR", HYBRID, "GRPD", "PD", HYBRID),
        ("NS", CYCLES, "NSNS", "NS", CYCLES),
    ],
)
def test_the_curve_that_begins_at_a_point(own, of_problem, label, of, of_which) -> None:
    facts = {"free": ("a", "b"), "settings": {"of": own, "of_problem": of_problem}}
    problem = SimpleNamespace(
        kind="locus", branch_facts=lambda: facts, system=SimpleNamespace(has_events=False)
    )
    assert born_of(problem, label) == {
        "problem": "locus",
        "free": ("a", "b"),
        "settings": {"of": of, "of_problem": of_which},
    }
    assert born_of(SimpleNamespace(kind="equilibrium"), label) == {}
