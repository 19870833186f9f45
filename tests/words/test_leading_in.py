"""Which event leads into a leg of a word."""

from __future__ import annotations

from hybrid_systems import DAMPER

from contwalk.problems.orbit.itinerary import Itinerary, Leg


def test_it_is_the_one_that_ends_the_leg_before():
    legs = tuple(Leg(transition.source, transition) for transition in DAMPER.transitions)
    word = Itinerary(legs)
    names = [leg.name for leg in legs]
    assert len(set(names)) == len(names) > 1
    assert [word.leading_in(DAMPER, i) for i in range(len(legs))] == [names[-1], *names[:-1]]
