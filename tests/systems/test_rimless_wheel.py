"""The rimless wheel against the closed form of its rolling, and verified numbers."""

import json
import math
from pathlib import Path

import numpy as np
import pytest
from contwalk_systems.rimless_wheel import SYSTEM
from hybrid_motion import joined, parameters, phase, phases, vector

WHEEL = json.loads(
    (Path(__file__).resolve().parents[1] / "thesis/planar_walker_reference.json").read_text(encoding="utf-8")
)["rimless_wheel"]
CASES = {name: case for name, case in WHEEL["cases"].items() if isinstance(case, dict)}
TRANSITIONS = {transition.name: transition for transition in SYSTEM.transitions}
OBSERVABLES = {observable.name: observable for observable in SYSTEM.observables}


def wheel(name):
    """Parameters of a case, which its name tells: slope, number of spokes, lambda^2."""
    slope, spokes, lambda2 = name.split("_", 2)
    return parameters(
        SYSTEM,
        g=1.0,
        l=1.0,
        gamma=float(slope),
        a=math.pi / int(spokes[1:]),
        lambda2=float(lambda2.removeprefix("lam2_")),
    )


def kept(p):
    return 1.0 - p.lambda2 * (1.0 - math.cos(2.0 * p.a))


def speed_after(p):
    """Speed after the impact of the steady rolling."""
    eta2 = kept(p) ** 2
    return math.sqrt(eta2 / (1.0 - eta2) * 4.0 * p.lambda2 * p.g / p.l * math.sin(p.a) * math.sin(p.gamma))


def step(p, speed):
    return phase(SYSTEM, p, "rolling", np.array([p.gamma - p.a, speed]))


@pytest.mark.parametrize("name", CASES)
def test_rolling_repeats_itself(name):
    p, case = wheel(name), CASES[name]
    assert speed_after(p) == pytest.approx(float(case["wplus"]), rel=1e-14)
    part = step(p, speed_after(p))
    assert part.duration == pytest.approx(float(case["T"]), abs=1e-9)
    assert part.before == pytest.approx([p.gamma + p.a, float(case["wminus"])], abs=1e-10)
    assert part.after == pytest.approx([p.gamma - p.a, float(case["wplus"])], abs=1e-10)
    length = OBSERVABLES["step_length"].function(part.end, part.before, p)
    assert length == pytest.approx(float(case["step"]), rel=1e-14)


@pytest.mark.parametrize("name", CASES)
def test_multiplier_is_the_square_of_what_an_impact_leaves(name):
    p, h = wheel(name), 1e-4
    speed = speed_after(p)
    ends = [step(p, speed + sign * h).after[1] for sign in (-1.0, 1.0)]
    assert (ends[1] - ends[0]) / (2.0 * h) == pytest.approx(float(CASES[name]["mult"]), abs=1e-7)


@pytest.mark.parametrize("spokes", [6, 8])
def test_slope_below_which_the_wheel_does_not_get_over_a_spoke(spokes):
    """There the hub just comes to rest over the foot: theta = 0, where the guard `turns_back` is zero."""
    p = parameters(
        SYSTEM, g=1.0, a=math.pi / spokes, lambda2=1.0, gamma=float(WHEEL["cases"][f"gamma_min_n{spokes}"])
    )
    over = speed_after(p) ** 2 - 2.0 * p.lambda2 * (1.0 - math.cos(p.a - p.gamma))
    assert over == pytest.approx(0.0, abs=1e-15)


def test_wheel_that_is_too_slow_turns_back():
    p = wheel("0.1_n8_lam2_1")
    guard = TRANSITIONS["turns_back"].guard
    x = np.array([p.gamma - p.a, 0.1])
    rates = vector(SYSTEM.modes[0].field, 0.0, x, p)
    assert guard(0.0, x, p) > 0.0
    assert rates[1] < 0.0


def test_normal_force_is_gravity_at_rest_and_less_when_rolling():
    p = parameters(SYSTEM)
    guard = TRANSITIONS["contact_lost"].guard
    assert guard(0.0, np.array([0.0, 0.0]), p) == pytest.approx(p.g * math.cos(p.gamma), rel=1e-15)
    # The hub moves along a circle: at theta = gamma it is at its top, seen from the slope.
    top = guard(0.0, np.array([p.gamma, 2.0]), p)
    assert top == pytest.approx(p.g * math.cos(p.gamma) - 4.0 * p.l, rel=1e-14)


def test_speed_is_steps_over_time():
    p = wheel("0.2_n8_lam2_1")
    parts = phases(SYSTEM, p, "rolling", np.array([p.gamma - p.a, 0.9 * speed_after(p)]), 3)
    expected = 3.0 * 2.0 * p.l * math.sin(p.a) / parts[-1].end
    assert OBSERVABLES["speed"].function(*joined(parts), p) == pytest.approx(expected, rel=1e-10)
    assert OBSERVABLES["speed"].function(np.zeros(1), np.zeros((1, 2)), p) == 0.0
    assert OBSERVABLES["impact_loss"].function(0.0, parts[0].before, p) == pytest.approx(0.5, rel=1e-14)
