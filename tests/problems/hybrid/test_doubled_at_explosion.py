"""A doubled orbit that is born in an explosion: beside its point its multiplier is one to its error.

Izhikevich's neuron with c free doubles at c = -49.70658222, and the doubled orbit's spikes go along what
repels them: within 5e-6 of c its multiplier goes from 1 to 500 and back, to a fold.
"""

from __future__ import annotations

from functools import cache
from types import SimpleNamespace

import pytest
from hybrid_runs import diagram, machine

from contwalk.problems.orbit import growth_told
from contwalk.system import Transition


def membrane(t, x, p, dx):
    dx[0] = 0.04 * x[0] ** 2 + 5.0 * x[0] + 140.0 - x[1] + 10.0
    dx[1] = 0.02 * (0.2 * x[0] - x[1])


def after_spike(t, x, p, x_plus):
    x_plus[0], x_plus[1] = p.c, x[1] + 8.0


@cache
def spikes():
    neuron = machine(
        ["v", "u"],
        {"c": -49.8},
        {"membrane": membrane},
        [Transition("spike", "membrane", "membrane", lambda t, x, p: 30.0 - x[0], reset=after_spike)],
    )
    return diagram(neuron, "c", (-49.8, -49.7), [-49.8, -13.0], until="settled", follow=["PD"], accuracy=1e-8)


@pytest.mark.long
def test_its_count_follows_from_the_criticality_of_its_point():
    parent, doubled = spikes()
    (point,) = (p for p in parent.special_points if p.label == "PD")
    assert point.criticality == "subcritical"
    before_fold = doubled["c"] < doubled["c"][0] + 1e-12
    fold = next(p for p in doubled.special_points if p.label == "LP")
    assert list(doubled["unstable"][: fold.index]) == [1] * fold.index
    assert before_fold[: fold.index].all()
    assert set(doubled["unstable"][fold.index + 1 :]) == {0}


def test_nothing_is_special_but_its_fold():
    _, doubled = spikes()
    assert [(p.label, p.status) for p in doubled.special_points if p.label != "EP"] == [("LP", "located")]
    # With accuracy 1e-10, told to 4e-12.
    assert doubled.special_points[0].parameters["c"] == pytest.approx(-49.706586934318, abs=2e-11)


@pytest.mark.parametrize(("growth", "told"), [(600.0, True), (2.0, False)])
def test_growth_over_all_segments_of_a_leg_is_told(growth, told):
    segments = [SimpleNamespace(leg=leg) for leg in (0, 1) for _ in range(8)]
    orbit = SimpleNamespace(
        mesh=SimpleNamespace(grown=(1.0,) * 8 + (growth,) * 8),
        layout=SimpleNamespace(legs=2, segments=segments),
        itinerary=SimpleNamespace(legs=[SimpleNamespace(mode="m", name=n) for n in ("one", "other")]),
    )
    sentence = growth_told.over_legs(orbit)
    assert ("2e+22 over the segment in mode 'm' that ends with 'other'" in sentence) == told
    assert bool(sentence) == told
