"""Ball that bounces on a table, which moves up and down: model and closed forms in
`docs/systems/bouncing_ball.md`.
"""

from __future__ import annotations

import math
from typing import Any

from contwalk.system import Mode, Observable, Parameter, State, Study, System, Transition

Y, V = range(2)


def _flight(t: Any, x: Any, p: Any, dx: Any) -> None:
    dx[Y] = x[V]
    dx[V] = -p.g


def _clearance(t: Any, x: Any, p: Any) -> Any:
    """Height over the table."""
    return x[Y] - p.A * math.sin(p.omega * t)


def _table_speed(t: Any, p: Any) -> Any:
    return p.A * p.omega * math.cos(p.omega * t)


def _bounce(t: Any, x: Any, p: Any, x_plus: Any) -> None:
    """The velocity relative to the table turns round; the table is much heavier than the ball."""
    x_plus[Y] = x[Y]
    x_plus[V] = -p.e * x[V] + (1.0 + p.e) * _table_speed(t, p)


def _period(p: Any) -> Any:
    return 2.0 * math.pi / p.omega


def _highest(t: Any, x: Any, p: Any) -> Any:
    return x[:, Y].max()


def _impact_speed(t: Any, x: Any, p: Any) -> Any:
    return _table_speed(t, p) - x[V]


def _impact_phase(t: Any, x: Any, p: Any) -> Any:
    return math.fmod(p.omega * t, 2.0 * math.pi)


SYSTEM = System(
    name="bouncing_ball",
    about="ball that bounces on a table, which moves up and down",
    states=(
        State("y", "m", about="height, above the middle of the table's motion"),
        State("v", "m/s", about="velocity, upwards"),
    ),
    parameters=(
        Parameter("A", 0.01, "m", (0.0, None), "amplitude of the table"),
        Parameter("omega", 35.0, "rad/s", (0.0, None), "frequency of the table; not zero"),
        Parameter("e", 0.5, "1", (0.0, 1.0), "coefficient of restitution"),
        Parameter("g", 9.81, "m/s2", (0.0, None), "gravity"),
    ),
    modes=(Mode("flight", _flight, about="above the table"),),
    transitions=(
        Transition("bounce", "flight", "flight", _clearance, reset=_bounce, about="the ball hits the table"),
    ),
    period=_period,
    observables=(
        Observable("y_max", _highest, "m", "largest height"),
        Observable(
            "impact_speed", _impact_speed, "m/s", "speed relative to the table at impact", at="bounce"
        ),
        Observable("impact_phase", _impact_phase, "rad", "phase omega t of the table at impact", at="bounce"),
    ),
    # From the fold at which the orbit with one bounce a period is born, past its period doubling.
    study=Study(
        "A",
        (0.008, 0.0125),
        {"simulate": {"state": {"y": 0.0158, "v": -0.7435}, "until": "settled"}},
        {"A": 0.0095},
    ),
    reference="P. J. Holmes (1982), J. Sound Vib. 84, 173-189",
)
