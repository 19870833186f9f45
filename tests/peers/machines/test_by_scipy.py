"""Special points of machines by SciPy's integration and shooting come to the values that are listed.

Beginnings are rough numbers of a motion; what Newton's method and secants converge to depends on neither them
nor contwalk.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from importlib import import_module
from typing import Any

import numpy as np
import pytest
from peers.form import Value
from peers.machines.cam_follower import cam, gap, on_the_cam
from peers.machines.double_pendulum import BY_HAND
from peers.machines.hopper import pushes_on_ground
from peers.machines.shooting_by_scipy import Cycle, multipliers_test, touching
from peers.machines.stribeck_belt import pull
from peers.running import machines

from contwalk.system import System, Transition

MACHINES = machines()


@dataclass(frozen=True)
class Shot:
    """An orbit near a special point: what to solve for, and from where.

    `z` are the state at the beginning of the first leg, the legs' durations, the time at which the first one
    begins if the machine is forced, and the free parameter. `pinned` is the unknown that is varied.
    """

    machine: str
    value: float  # roughly: which of the listed ones is meant
    test: str | Callable[..., float]  # LP, PD, NS; OC: the duration that is pinned is zero; or a function
    legs: Sequence[tuple[str, str | Transition]]
    z: Sequence[float]
    pinned: int = -1
    rest: dict[str, Any] = field(default_factory=dict)
    system: System | None = None

    def listed(self) -> tuple[dict[str, Any], Value]:
        """Run file and value that are meant."""
        studies = MACHINES[self.machine].studies
        near = [
            (study.run, v)
            for study in studies
            for v in study.values
            if abs(v.value - self.value) < 1e-3 * v.size
        ]
        assert len({v.value for _, v in near}) == 1
        return near[0]

    def solve(self, cycle: Cycle) -> np.ndarray:
        """All unknowns at the special point."""
        z = np.array(self.z)
        if self.test == "OC":  # a leg lasts no time
            z[self.pinned] = 0.0
            return cycle.solved(z, self.pinned)
        test = multipliers_test(self.test) if isinstance(self.test, str) else self.test
        return cycle.special(test, z, self.pinned)


def inverted(x: np.ndarray) -> np.ndarray:
    return -x


def plugin(machine: str) -> System:
    """Of a machine."""
    return import_module(f"peers.machines.{machine}").SYSTEM


TURN = Transition("turn", "free", "free", lambda t, x, p: x[1])
TURNED = Transition("turn", "loose", "loose", lambda t, x, p: x[1])
SCROLL = [("right", "in_right"), ("middle", "out_right")]
HALF = {"image": inverted, "periods": 0.5}
CONVERSION = [("off", "switch_on"), ("on", "tick_on")]
SWING = [("free", "strike")]
STUCK_BEFORE_LEFT = [("stick", "goes_left"), ("left", "halts")]
STUCK_BEFORE_RIGHT = [("stick", "goes_right"), ("right", "stops")]
# Where the follower leaves its cam as soon as it has come down.
LANDS = Transition("lands", "lifted", "lifted", gap, reset=on_the_cam)
FASTEST = Transition("fastest", "slower", "slower", lambda t, x, p: p.s - pull(t, x, p))
SHOTS = [
    Shot(
        "compass_gait",
        0.0766,
        "PD",
        [("behind", "legs_pass"), ("ahead", "heel_strike")],
        [0.2319, -0.3852, -1.153, -0.1512, 0.292, 0.462, 0.0766],
    ),
    Shot(
        "double_pendulum",
        8.42,
        "LP",
        SWING,
        [0.7587, -0.0881, 0.294, -3.31, 2.094, 0.084, 8.42],
        1,
        system=BY_HAND,
    ),
    Shot(
        "double_pendulum",
        5.025,
        "PD",
        SWING,
        [1.2135, -0.3435, 0.4542, -2.95, 2.094, 0.204, 5.025],
        system=BY_HAND,
    ),
    Shot(
        "double_pendulum",
        4.074,
        "LP",
        SWING,
        [1.3697, -0.3896, 0.7626, -2.49, 2.094, 0.4, 4.074],
        1,
        system=BY_HAND,
    ),
    Shot(
        "rocking_block",
        3.07,
        "PD",
        [("left", "up")],
        [0.0, -1.206, 1.885, 0.856, 3.07],
        rest={"image": inverted, "periods": 1.5},
    ),
    Shot("buck", 24.5, "PD", CONVERSION, [12.0277, 0.6081, 0.0, 2.04e-4, 1.96e-4, 24.5]),
    Shot(
        "buck",
        31.12,
        "PD",
        CONVERSION * 2,
        [12.051, 0.6854, 0.0, 3.48e-4, 5.2e-5, 1.41e-4, 2.59e-4, 31.1],
    ),
    Shot(
        "buck",
        36.35,
        "OC",
        CONVERSION * 2,
        [12.0072, 0.7147, 0.0, 4e-4, 0.0, 1.333e-4, 2.667e-4, 36.35],
        4,
    ),
    Shot("impact_pair", 5.19, "LP", [("free", "high")], [-1.0, 2.03, 0.6283, 0.96, 5.19], 1, rest=HALF),
    Shot("impact_pair", 19.23, "PD", [("free", "high")], [-1.0, 3.568, 0.6283, 0.72, 19.2], rest=HALF),
    Shot(
        "impact_pair",
        27.08,
        "PD",
        [("free", "low"), ("free", "high")],
        [1.0, -4.468, 0.36, 0.897, 0.245, 27.08],
    ),
    Shot(
        "impact_pair",
        27.89,
        touching(lambda t, x, p: 1.0 + x[0]),
        [("free", TURN), ("free", "high"), ("free", "low")],
        [-1.0, 4.555, 0.505, 0.402, 0.35, 0.601, 27.89],
    ),
    Shot(
        "gear_rattle",
        0.44,
        "PD",
        [("loose", "rattles"), ("loose", "drives")],
        [0.0, 0.4878, 4.229, 2.054, 11.08, 0.4403],
    ),
    Shot(
        "gear_rattle",
        0.622,
        touching(lambda t, x, p: x[0]),
        [("loose", TURNED), ("loose", "rattles"), ("loose", "drives")],
        [0.0, 0.5878, 2.64, 2.07, 1.573, 10.858, 0.622],
    ),
    Shot(
        "hopper",
        0.272,
        touching(pushes_on_ground),
        [("stance", "thrust"), ("thrust", "liftoff"), ("flight", "touchdown")],
        [0.7, -1.896, 0.0, 0.272, 0.067, 0.334, 0.272],
    ),
    Shot(
        "bilinear_oscillator",
        2.2885,
        "PD",
        [("pushed", "release"), ("pulled", "press")],
        [0.0, 0.6289, 0.8628, 1.8827, 0.9103, 2.2885],
    ),
    Shot(
        "boost",
        0.4943,
        "PD",
        [("off", "tick_off"), ("on", "peak")],
        [0.494, 8.6, 4.6e-5, 5.4e-5, 4.6e-5, 0.494],
    ),
    Shot(
        "boost",
        0.6437,
        "OC",
        [("off", "tick_off"), ("on", "tick_on"), ("on", "peak")],
        [0.644, 8.47, 0.0, 1e-4, 1e-4, 0.0, 0.644],
        5,
    ),
    Shot(
        "cam_follower",
        2.178,
        "OC",
        [("lifted", "strikes"), ("rides", "leaves")],
        [0.272, 2.1, 2.88, 0.0, 2.29, 2.18],
        3,
    ),
    Shot("cam_follower", 2.444, "PD", [("lifted", LANDS)], [0.618, 1.92, 2.57, 2.2, 2.444]),
    Shot(
        "cam_follower",
        2.5085,
        "OC",
        [("lifted", "strikes"), ("rides", "leaves"), ("lifted", LANDS)],
        [0.887, 1.157, 2.153, 0.0, 2.856, 2.314, 2.5085],
        3,
        rest={"periods": 2.0},
    ),
    Shot(
        "cam_follower",
        2.7157,
        touching(lambda t, x, p: x[1] - cam(t, p)[1]),
        [("lifted", LANDS), ("lifted", "strikes"), ("rides", "leaves")],
        [0.179, 2.672, 3.173, 0.57, 0.885, 4.115, 2.7157],
        2,
        rest={"periods": 2.0},
    ),
    Shot(
        "shaken_friction",
        0.5973,
        "OC",
        STUCK_BEFORE_LEFT,
        [1.463, 0.0, 0.0, 5.26, 0.458, 0.597],
        2,
        rest=HALF,
    ),
    Shot(
        "shaken_friction",
        0.57683,
        "PD",
        STUCK_BEFORE_LEFT,
        [1.436, 0.0, 0.24, 5.2, 0.38, 0.577],
        rest=HALF,
    ),
    Shot(
        "shaken_friction",
        0.57563,
        "OC",
        STUCK_BEFORE_LEFT + STUCK_BEFORE_RIGHT,
        [1.39, 0.0, 0.45, 5.04, 0.0, 5.43, 0.371, 0.5756],
        4,
    ),
    Shot(
        "stribeck_belt",
        0.39579,
        touching(lambda t, x, p: x[1] - p.v_b),
        [("slower", FASTEST)],
        [0.36, 0.396, 6.37, 0.396],
    ),
    Shot("chua", 8.173, "PD", SCROLL, [1.0, 0.2467, -0.2196, 1.34, 0.94, 8.173]),
    Shot("chua", 8.397, "PD", SCROLL * 2, [1.0, 0.1489, -0.0835, 1.412, 1.164, 1.327, 0.693, 8.397]),
]


# The double pendulum takes long: `make test` tries its doubling.
LONG = {("double_pendulum", "LP")}


@pytest.mark.parametrize(
    "shot",
    [
        pytest.param(
            shot,
            id=f"{shot.machine}-{shot.value}",
            marks=[pytest.mark.long] if (shot.machine, shot.test) in LONG else [],
        )
        for shot in SHOTS
    ],
)
def test_a_listed_value(shot: Shot):
    run, value = shot.listed()
    system = shot.system or plugin(shot.machine)
    cycle = Cycle(system, shot.legs, run.get("parameters", {}), run["continue"]["parameter"], **shot.rest)
    known = shot.solve(cycle)
    assert known[-1] == pytest.approx(value.value, rel=value.rel)
