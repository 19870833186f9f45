"""Spikes that run to a pole: how near to it an event may be, and what is said of one that is nearer."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hybrid_runs import machine

from contwalk.continuation.outcomes import Outcome
from contwalk.continuation.settings import Settings
from contwalk.diagram.opening import Opening
from contwalk.studies.opening_orbits import opened_orbit
from contwalk.system import System, Transition


def neuron(top: float) -> System:
    """v runs off like -log(t0 - t): exp(-top) of a second before its pole it is reset."""

    def field(t, x, p, dx):
        dx[0] = p.I - x[0] + math.exp(x[0]) - x[1]
        dx[1] = 0.1 * (0.2 * x[0] - x[1])

    def reset(t, x, p, after):
        after[0] = 0.0
        after[1] = x[1] + 0.2

    spike = Transition("spike", "m", "m", lambda t, x, p: x[0] - top, "rising", reset=reset)
    return machine(["v", "w"], {"I": 1.0}, {"m": field}, [spike])


def opening_of(top: float) -> Opening | Outcome:
    system = neuron(top)
    settings = Settings(range=(0.5, 2.0))
    return opened_orbit(
        system, system.defaults(), "I", np.array([0.0, 0.0]), settings, until="settled", mode="m"
    )


@pytest.mark.parametrize("top", [10.0, 18.0, 24.0])
def test_a_spike_with_room_to_its_pole_is_continued(top: float) -> None:
    assert isinstance(opening_of(top), Opening)


def test_a_spike_next_to_its_pole_is_told_without_a_wrong_number() -> None:
    """Steps end some 1e-9 of the leg before the pole, which is 1e-11 behind the event: neither is said."""
    failed = opening_of(26.0)
    assert isinstance(failed, Outcome)
    assert (
        "The motion ceases to exist right after 'spike', as a spike does that runs to a pole"
        in failed.message
    )
    assert "e-" not in failed.message
    assert "Let the guard act earlier on the way up" in failed.message
