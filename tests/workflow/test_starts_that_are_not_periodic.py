"""A motion that comes near to where it was, with no orbit there: it may not be periodic, and that is told."""

from __future__ import annotations

import pytest
from small_systems import small_system

import contwalk as cw
from contwalk.continuation.correction import Correction
from contwalk.continuation.settings import Settings
from contwalk.diagram.not_begun import PERHAPS_NOT_PERIODIC
from contwalk.studies import opening_eventful, opening_smooth
from contwalk.studies.opening_orbits import opened_orbit


def turning(t, x, p, dx):
    r = x[0] ** 2 + x[1] ** 2
    dx[0] = x[0] * (p.mu - r) - x[1]
    dx[1] = x[1] * (p.mu - r) + x[0]


def nothing(problem, z, *given, **named):
    return Correction(problem, z, None, 8, "no_convergence", "Newton's method does not get there.")


@pytest.mark.parametrize("until", ["settled", 1.0])
def test_of_smooth_motions(monkeypatch, until):
    monkeypatch.setattr(opening_smooth, "begin", nothing)
    system = small_system(turning, "xy", {"mu": 1.0})
    found = opened_orbit(system, {"mu": 1.0}, "mu", [1.0, 0.0], Settings(range=(0.5, 2.0)), until=until)
    assert (found.status, found.reason) == ("failed", "no_convergence")
    assert (PERHAPS_NOT_PERIODIC in found.message) == (until == "settled")


def test_of_motions_with_events(monkeypatch):
    monkeypatch.setattr(opening_eventful, "begin", nothing)
    wheel = cw.load_system("rimless_wheel")
    values = {parameter.name: parameter.default for parameter in wheel.parameters} | {"gamma": 0.1}
    settings = Settings(range=(0.08, 0.12))
    found = opened_orbit(wheel, values, "gamma", [-0.2, 1.5], settings, until="settled")
    assert (found.status, found.reason) == ("failed", "no_convergence")
    assert PERHAPS_NOT_PERIODIC in found.message
