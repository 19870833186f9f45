"""Orbits through events that a start has gone round several times, beside the plane of their mirror.

The machine of test_hybrid_mirror: Lorenz's equations, with a place to the side that the mirror reverses. It
begins seven to one side, so that whoever drifts along, so that three halves close up to an image, drifts a
third as fast as for one; and settles far up, where differences of places are rounded as these are.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from test_hybrid_mirror import START, two_sided

import contwalk as cw
from contwalk.continuation.settings import Settings
from contwalk.diagram.opening import Opening
from contwalk.problems.hybrid.hybrid_orbit import HybridOrbit
from contwalk.problems.hybrid.hybrid_recurrence import HybridRecurrence
from contwalk.problems.images import imaged
from contwalk.problems.initial.event_recurrence import recurrence_from
from contwalk.problems.parameter_line import ParameterLine
from contwalk.studies.opening_eventful import eventful
from contwalk.studies.orbit_start import OrbitStart
from contwalk.system.declarations import ParameterValues

HALF = 0.20168477
SYSTEM = two_sided(True)
STATE = np.array([*START, 7.0, -2.0])


@cache
def six_halves() -> HybridRecurrence:
    found = recurrence_from(SYSTEM, SYSTEM.defaults(), STATE, "right", until="settled", least=5.5 * HALF)
    assert (len(found.stretches), found.image) == (6, "")
    return found


def gone_round(rounds: int) -> HybridRecurrence:
    """So many halves; an odd number of them closes up to the mirror's image."""
    whole = six_halves()
    following = whole.stretches[rounds].state if rounds < 6 else whole.returned
    image = "mirror" if rounds % 2 else ""
    if image:
        following = imaged(SYSTEM.symmetry(image), following, ParameterValues(**SYSTEM.defaults()))
    return replace(whole, stretches=whole.stretches[:rounds], returned=following, image=image)


@pytest.mark.drawn(2)
@pytest.mark.parametrize("rounds", [1, 2, 3, 4, 5, 6])
@pytest.mark.parametrize("accuracy", [1e-7, 1e-9])
def test_several_halves_are_told_as_one(
    rounds: int, accuracy: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(
        "contwalk.studies.opening_eventful.recurrence_from", lambda *given, **_: gone_round(rounds)
    )
    line = ParameterLine.of(SYSTEM, SYSTEM.defaults(), "rho", None)
    asked = cw.Discretization(accuracy=accuracy)
    opening = eventful(OrbitStart(SYSTEM, line, None, STATE, Settings(), asked, "settled", mode="right"))
    assert isinstance(opening, Opening)
    problem, z = opening.problem, opening.state.sample.z
    assert isinstance(problem, HybridOrbit)
    assert (problem.itinerary.image, len(problem.itinerary)) == ("mirror", 1)
    assert opening.message == ""
    assert problem.duration(z) == pytest.approx(HALF, rel=1e-6)
