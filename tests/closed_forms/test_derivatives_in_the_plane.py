"""Conditions of curves of orbits: derivatives by both parameters at once are those along each by itself."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import test_loci_through_soft_transitions as soft
from hybrid_runs import diagram
from loci_of_orbits import FINE, cusped, doubling, turning, walked

import contwalk as cw
from contwalk.branch import Branch
from contwalk.problems.locus.orbit_places import Held

pytestmark = pytest.mark.slow


def folds() -> Branch:
    state, ranges = [1.3**0.5, 0.0], {"lam": (-0.5, 0.5), "nu": (0.1, 0.5)}
    return walked(cusped(), "lam", state, (-0.3, 0.3), "LP1", ranges, np.pi)


def doublings() -> Branch:
    ranges = {"lam": (0.2, 1.2), "sigma": (-1.2, -0.8)}
    return walked(doubling(), "lam", [1.0, 0.0, 0.0, 0.0], (0.6, 0.9), "PD1", ranges, np.pi)


def tori() -> Branch:
    ranges = {"lam": (0.5, 1.5), "nu": (0.25, 0.35)}
    return walked(turning(), "lam", [1.0, 0.0, 0.0, 0.0], (0.5, 1.2), "NS1", ranges, 2.0 * np.pi / 1.5)


def soft_transitions(
    label: str, range_: tuple[float, float], ranges: dict[str, tuple[float, float]]
) -> Branch:
    """An oscillator that meets a second spring and, at 0.8, a stop: what lies between hard transitions is
    eliminated.
    """
    values, events = {"omega": 1.3 if label == "LP1" else 1.2, "force": 0.5}, {"GR": "ignore"}
    free, machine = ("omega", soft.system("soft")) if label == "LP1" else ("force", soft.stopped())
    start = {"until": "settled", "events": events, "max_step": 0.3}
    (branch, *_) = diagram(machine, free, range_, [0.0, 0.0], values, **start)
    return cw.continue_locus(machine, branch, label, ranges, events=events, **FINE)


def soft_folds() -> Branch:
    return soft_transitions("LP1", (1.2, 1.6), {"omega": (1.3, 1.5), "force": (0.4, 0.6)})


def soft_grazings() -> Branch:
    return soft_transitions("GR1", (0.05, 1.5), {"omega": (1.1, 1.25), "force": (0.05, 1.5)})


@pytest.mark.drawn(1)
@pytest.mark.parametrize("follow", [folds, doublings, tori, soft_folds, soft_grazings])
def test_one_direction_gives_what_all_give(
    follow: Callable[[], Branch], monkeypatch: pytest.MonkeyPatch
) -> None:
    """At all places that a walk asks for, on the curve and beside it."""
    over, asked = Held.over, []

    def compared(self: Held, plane: Any, z: np.ndarray, own: np.ndarray) -> tuple[np.ndarray, ...]:
        found = over(self, plane, z, own)
        system: Any = self.system
        if getattr(system, "in_plane", None) is not None:
            each = over(Held(replace(system, in_plane=None), self.further), plane, z, own)
            for one, other in zip(found, each, strict=True):
                assert np.allclose(
                    one, other, rtol=1e-11, atol=1e-11 * (1.0 + np.abs(other).max(initial=0.0))
                )
            asked.append(z)
        return found

    monkeypatch.setattr(Held, "over", compared)
    assert len(follow()) > 3
    assert len(asked) > 10
