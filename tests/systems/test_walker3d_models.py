"""Paper 7's other models of knee and ground: the printed functions beside the machine's forces."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from contwalk_systems.walker3d.equations import SHANK, THIGH, Equations
from contwalk_systems.walker3d.forces import act_of_knee, ground_force
from contwalk_systems.walker3d.model import Model
from contwalk_systems.walker3d.observables import force_of_ground
from contwalk_systems.walker3d.states import KNEE, KNEE_RATE, anchor
from walker3d_motion import walker

from contwalk.workflow.run_file.simulate import read_simulation
from contwalk.workflow.simulating import moved

RUNS = Path(__file__).parents[2] / "runs"
RANDOM = np.random.default_rng(8)


def toefy(y, vy, k, d, d_rebound):
    """The second one: the damper acts both ways, and the force is positive."""
    force = -k * y - (d if vy < 0 else d_rebound) * vy
    return max(force, 0.0)


def knee(q, u, k, d, d_rebound):
    """Positive angles are hyperextension there, negative ones here."""
    return k * q + (d * u if u <= 0.0 else d_rebound * u)


def test_a_clipped_force_is_the_printed_one():
    model = Model(ground_damper="clipped")
    met = set()
    for y, vy in zip(-RANDOM.uniform(0.0, 0.01, 40), RANDOM.uniform(-0.5, 0.5, 40), strict=True):
        p = SimpleNamespace(k_x=0, c_x=0, k_z=0, c_z=0, k_y=5000.0, c_y=500.0, c_y_rebound=60.0)
        expected = toefy(y, vy, p.k_y, p.c_y, p.c_y_rebound)
        state = "damped" if vy < 0.0 else "rising" if expected > 0.0 else "slack"
        met.add(state)
        flags = {
            "on": 1,
            "damped": state == "damped",
            "rising": state == "rising",
            "pressed": state != "slack",
        }
        for name, flag in flags.items():
            setattr(p, f"{name}11", float(flag))
        found = ground_force((0.0, y, 0.0), (0.0, vy, 0.0), (0.0, 0.0), p, "11", model)[1]
        assert found == pytest.approx(expected, rel=1e-14, abs=1e-14)
    assert met == {"damped", "rising", "slack"}


def test_a_toe_that_slackens_is_held_down_by_nothing():
    system = walker(ground_damper="clipped")
    slackens = next(each for each in system.transitions if each.name == "toe11_slackens")
    before, after = (system.mode(name).constants for name in (slackens.source, slackens.target))
    told = [
        [flags[f"{name}11"] for name in ("on", "pressed", "rising", "damped")] for flags in (before, after)
    ]
    assert told == [[1.0, 1.0, 1.0, 0.0], [1.0, 0.0, 0.0, 0.0]]


def test_the_force_that_figures_show_never_pulls():
    model, system = Model(ground_damper="clipped"), walker(ground_damper="clipped")
    p = SimpleNamespace(**system.defaults())
    p.c_y_rebound = 400.0
    x = RANDOM.uniform(-0.3, 0.3, (300, 28))
    x[:, 1] = 0.66 + RANDOM.uniform(-0.01, 0.01, 300)
    x[:, list(anchor(1, 1))] = 0.1
    force = force_of_ground(x, p, 1, 1, model)[1]
    one_sided = force_of_ground(x, p, 1, 1, Model())[1]
    below = one_sided > 0.0
    assert (force[below] >= 0.0).all()
    assert 0 < np.count_nonzero(force[below] == 0.0) < np.count_nonzero(below)


@pytest.mark.parametrize("u", [-0.7, 0.7])
def test_a_knee_that_rebounds_has_the_printed_torque(u):
    p = SimpleNamespace(k_knee=500.0, c_knee=20.0, c_knee_rebound=3.0, stop1=1.0, rebound1=float(u > 0.0))
    x, equations = np.zeros(28), Equations({}, [0.0] * 10)
    x[KNEE[1]], x[KNEE_RATE[1]] = -0.02, u
    act_of_knee(equations, x, p, 1, Model(knee_damper="rebound"))
    expected = knee(-0.02, u, p.k_knee, p.c_knee, p.c_knee_rebound)
    assert (equations.forces[THIGH[1]], equations.forces[SHANK[1]]) == pytest.approx((expected, -expected))


@pytest.mark.long
def test_a_rebound_that_is_damped_alike_changes_nothing(tmp_path):
    """Half a second of the gait of Table V: the same motion with twice as many events of knees."""
    ends = []
    for model in ("two_sided", "rebound"):
        given = [f"model.knee_damper={model}", "simulate={until: 0.5, tolerance: 1e-12}"]
        run = read_simulation(RUNS / "walker3d_overlap.yaml", given, str(tmp_path / "x.h5"))
        motion = moved(run)
        ends.append((motion.values[-1], {event.name for event in motion.events}))
    np.testing.assert_allclose(ends[0][0], ends[1][0], atol=1e-9)
    assert ends[1][1] - ends[0][1] == {"knee1_rebounds", "knee2_rebounds", "knee2_returns"}
