"""Forced linear oscillator with a rigid stop on one side: model and closed forms in
`docs/systems/impact_oscillator.md`.
"""

from __future__ import annotations

import math
from typing import Any

from contwalk.system import Mode, Observable, Parameter, State, Study, System, Transition

Q, V = range(2)


def _field(t: Any, x: Any, p: Any, dx: Any) -> None:
    dx[Q] = x[V]
    dx[V] = p.force * math.cos(p.omega * t) - 2.0 * p.zeta * x[V] - x[Q]


def _clearance(t: Any, x: Any, p: Any) -> Any:
    return p.gap - x[Q]


def _rebound(t: Any, x: Any, p: Any, x_plus: Any) -> None:
    x_plus[Q] = x[Q]
    x_plus[V] = -p.restitution * x[V]


def _period(p: Any) -> Any:
    return 2.0 * math.pi / p.omega


def _largest(t: Any, x: Any, p: Any) -> Any:
    return x[:, Q].max()


def _impact_speed(t: Any, x: Any, p: Any) -> Any:
    return x[V]


def _impact_phase(t: Any, x: Any, p: Any) -> Any:
    return math.fmod(p.omega * t, 2.0 * math.pi)


SYSTEM = System(
    name="impact_oscillator",
    about="forced linear oscillator that hits a rigid stop",
    states=(State("q", "m", about="displacement"), State("v", "m/s", about="velocity")),
    parameters=(
        Parameter("zeta", 0.1, "1", (0.0, None), "damping ratio"),
        Parameter("omega", 1.3, "rad/s", (0.0, None), "frequency of the force; not zero"),
        Parameter("force", 0.3, "m/s2", about="amplitude of the force per unit mass"),
        Parameter("gap", 1.0, "m", about="displacement at which the stop is hit"),
        Parameter("restitution", 0.8, "1", (0.0, 1.0), "coefficient of restitution"),
    ),
    modes=(Mode("free", _field, about="away from the stop"),),
    transitions=(
        Transition(
            "impact", "free", "free", _clearance, reset=_rebound, about="the mass rebounds from the stop"
        ),
    ),
    period=_period,
    observables=(
        Observable("q_max", _largest, "m", "largest displacement"),
        Observable("impact_speed", _impact_speed, "m/s", "speed at which the stop is hit", at="impact"),
        Observable("impact_phase", _impact_phase, "rad", "phase omega t of the force there", at="impact"),
    ),
    # Through the force at which the mass first touches the stop.
    study=Study(
        "force",
        (0.3, 1.2),
        {"simulate": {"state": {"q": 0.0, "v": 0.0}, "until": "settled"}},
        events={"GR": "switch"},
    ),
    reference="S. W. Shaw, P. J. Holmes (1983), J. Sound Vib. 90, 129-155",
)
