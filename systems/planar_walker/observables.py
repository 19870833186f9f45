"""Numbers read off a step: at its impacts, or of the whole motion (t of shape (k,), x of shape (k, 7))."""

from __future__ import annotations

from typing import Any

import numpy as np

from contwalk.system import Observable, Signal

from .impacts import heel_strike, knee_strike
from .limbs import foot_centre_to_hip, leg_moment, shank_moment, thigh_moment, total_mass
from .plane import combined
from .states import Q1, Q2, Q3


def rolled(q: Any, p: Any) -> Any:
    """Position of the hip along the slope (12), as the stance foot has rolled at the angle q."""
    return -(p.l1 + p.l2) * np.sin(q) - p.lf * np.cos(q) - p.rf * q


def _step_length(t: Any, x: Any, p: Any) -> Any:
    """Way of the hip along the slope over a step that ends as it began: distance of the feet, and rolling."""
    return rolled(x[Q1], p) - rolled(x[Q2], p)


def _speed(t: Any, x: Any, p: Any) -> Any:
    if len(t) == 1:
        return 0.0
    hip = rolled(x[:, Q1], p)
    # At an impact two instants have one time; there the legs change names, and the hip stays where it is.
    way = np.where(np.diff(t) > 0.0, np.diff(hip), 0.0)
    return way.sum() / (t[-1] - t[0])


def _step_time(t: Any, x: Any, p: Any) -> Any:
    """Mean time of a step: each has two impacts, and the motion ends right before the last of them."""
    if len(t) == 1:
        return 0.0
    impacts = np.count_nonzero(np.diff(t) == 0.0) + 1
    return 2.0 * (t[-1] - t[0]) / impacts


def _friction_heel(t: Any, x: Any, p: Any) -> Any:
    along, away = heel_strike(x, p).foot
    return abs(along / away)


def _friction_knee(t: Any, x: Any, p: Any) -> Any:
    along, away = knee_strike(x, p).foot
    return abs(along / away)


def _impulse_heel(t: Any, x: Any, p: Any) -> Any:
    return heel_strike(x, p).foot[1]


def _impulse_knee(t: Any, x: Any, p: Any) -> Any:
    return knee_strike(x, p).foot[1]


def _impact_loss(t: Any, x: Any, p: Any) -> Any:
    impact = heel_strike(x, p)
    return impact.lost / impact.energy


def _knee_loss(t: Any, x: Any, p: Any) -> Any:
    impact = knee_strike(x, p)
    return impact.lost / impact.energy


OBSERVABLES = (
    Observable(
        "step_length",
        _step_length,
        "m",
        "way along the slope in a step that repeats",
        at="heel_strike",
    ),
    Observable("step_time", _step_time, "s", "mean time of a step"),
    Observable("speed", _speed, "m/s", "mean speed along the slope"),
    Observable(
        "friction_heel", _friction_heel, "1", "friction needed at heel strike, |R_x / R_y|", at="heel_strike"
    ),
    Observable(
        "friction_knee", _friction_knee, "1", "friction needed at knee strike, |R_x / R_y|", at="knee_strike"
    ),
    Observable("impulse_heel", _impulse_heel, "N s", "impulse R_y on the landing foot", at="heel_strike"),
    Observable("impulse_knee", _impulse_knee, "N s", "impulse R_y on the stance foot", at="knee_strike"),
    Observable(
        "impact_loss", _impact_loss, "1", "share of the kinetic energy that is lost", at="heel_strike"
    ),
    Observable("knee_loss", _knee_loss, "1", "share of the kinetic energy that is lost", at="knee_strike"),
)


def _hip_height(t: Any, x: Any, p: Any) -> Any:
    return foot_centre_to_hip(x[:, Q1], p)[1] + p.rf


def _com_height(t: Any, x: Any, p: Any) -> Any:
    swings = (1.0, thigh_moment(x[:, Q2], p)), (1.0, shank_moment(x[:, Q2] - x[:, Q3], p))
    below = combined((1.0, leg_moment(x[:, Q1], p)), *swings)[1] / total_mass(p)
    return _hip_height(t, x, p) + below


SIGNALS = (
    Signal("hip_height", _hip_height, "m", "height of the hip above the slope"),
    Signal("com_height", _com_height, "m", "height of the centre of mass above the slope", extremes=True),
)
