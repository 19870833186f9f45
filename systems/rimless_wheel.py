"""Wheel of spokes without a rim that rolls down a slope, spoke by spoke: model and closed forms in
`docs/systems/rimless_wheel.md`.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from contwalk.system import Mode, Observable, Parameter, State, Study, System, Transition

THETA, OMEGA = range(2)


def _rolling(t: Any, x: Any, p: Any, dx: Any) -> None:
    """An inverted pendulum about the foot of the spoke that stands."""
    dx[THETA] = x[OMEGA]
    dx[OMEGA] = p.lambda2 * p.g / p.l * math.sin(x[THETA])


def _next_spoke(t: Any, x: Any, p: Any) -> Any:
    """Angle that is left until the next spoke is on the slope."""
    return p.gamma + p.a - x[THETA]


def _kept(p: Any) -> Any:
    """Share eta of the speed that an impact leaves: the moment of momentum about the landing foot is kept."""
    return 1.0 - p.lambda2 * (1.0 - math.cos(2.0 * p.a))


def _heel_strike(t: Any, x: Any, p: Any, x_plus: Any) -> None:
    """The next spoke stands; from here on theta is its angle."""
    x_plus[THETA] = x[THETA] - 2.0 * p.a
    x_plus[OMEGA] = _kept(p) * x[OMEGA]


def _forward(t: Any, x: Any, p: Any) -> Any:
    return x[OMEGA]


def _normal_force(t: Any, x: Any, p: Any) -> Any:
    """Force of the slope on the foot, away from the slope, per unit mass."""
    tilt = x[THETA] - p.gamma
    tangential = p.lambda2 * p.g * math.sin(x[THETA]) * math.sin(tilt)
    return p.g * math.cos(p.gamma) - tangential - p.l * x[OMEGA] * x[OMEGA] * math.cos(tilt)


def _speed(t: Any, x: Any, p: Any) -> Any:
    if len(t) == 1:
        return 0.0
    hub = p.l * np.sin(x[:, THETA] - p.gamma)
    # At an impact two instants have one time: another foot stands, and the hub stays where it is.
    way = np.where(np.diff(t) > 0.0, np.diff(hub), 0.0)
    return way.sum() / (t[-1] - t[0])


def _step_length(t: Any, x: Any, p: Any) -> Any:
    return 2.0 * p.l * math.sin(p.a)


def _impact_loss(t: Any, x: Any, p: Any) -> Any:
    return 1.0 - _kept(p) * _kept(p)


SYSTEM = System(
    name="rimless_wheel",
    about="wheel of spokes without a rim that rolls down a slope",
    states=(
        State("theta", "rad", about="angle of the standing spoke from the vertical, forwards"),
        State("omega_", "rad/s", about="rate of theta"),
    ),
    parameters=(
        Parameter("g", 9.81, "m/s2", (0.0, None), "gravity"),
        Parameter("l", 1.0, "m", (0.0, None), "length of a spoke; not zero"),
        Parameter(
            "a", math.pi / 8.0, "rad", (0.0, None), "half the angle between spokes, pi / n of n spokes"
        ),
        Parameter("lambda2", 1.0, "1", (0.0, 1.0), "m l^2 / (m l^2 + I), I: moment of inertia about the hub"),
        Parameter("gamma", 0.1, "rad", about="inclination of the slope"),
    ),
    modes=(Mode("rolling", _rolling, about="on one spoke"),),
    transitions=(
        Transition(
            "heel_strike", "rolling", "rolling", _next_spoke, reset=_heel_strike, about="a spoke lands"
        ),
        Transition(
            "turns_back",
            "rolling",
            "rolling",
            _forward,
            role="watched",
            about="it does not get over the spoke",
        ),
        Transition(
            "contact_lost",
            "rolling",
            "rolling",
            _normal_force,
            role="watched",
            about="the foot leaves the slope",
        ),
    ),
    observables=(
        Observable("speed", _speed, "m/s", "mean speed along the slope"),
        Observable("step_length", _step_length, "m", "distance of two feet", at="heel_strike"),
        Observable(
            "impact_loss", _impact_loss, "1", "share of the kinetic energy that is lost", at="heel_strike"
        ),
    ),
    # Downwards to the slope at which it no longer gets over its spokes.
    study=Study(
        "gamma", (0.02, 0.3), {"simulate": {"state": {"theta": -0.2, "omega_": 1.5}, "until": "settled"}}
    ),
    reference="T. McGeer (1990), Int. J. Robotics Research 9(2), 62-82",
)
