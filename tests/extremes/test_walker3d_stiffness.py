"""A leg of the 3D walker stands on ground, and on a knee, that are up to a thousand times as stiff.

Stiffness and damping of both grow together; the leg begins as deep in the ground, and held as far aside, as
the same forces take. Rates of the field reach 2e6 per second where the motion takes tenths of a second.
"""

from __future__ import annotations

import json
import re
from functools import cache
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from contwalk_systems.walker3d.model import Model
from contwalk_systems.walker3d.motion import toe_place

from contwalk import flow
from contwalk.flow.compiled.compiled_field import CompiledField
from contwalk.flow.hybrid.motions import hybrid_machine
from contwalk.flow.method import choose
from contwalk.system import System, load_system

GAIT = json.loads(
    (Path(__file__).parents[1] / "systems" / "walker3d_reference.json").read_text(encoding="utf-8")
)["gaits"]["overlap"]
MODE = "swing1_toe21_toe22_knee2"
SCALES = (1, 10, 100, 1000)
STANCE = 0.3  # s
# The largest rate of the walker as it is, and how many steps Radau IIA may take for all that.
RATE, MOST_STEPS = 1.9e3, 60


@cache
def walker() -> System:
    return load_system("walker3d")


def stiffened(scale: float) -> dict[str, float]:
    values = walker().defaults() | dict(walker().presets["overlap"]) | {"alpha": 0.08}
    contact = re.compile("[kc]_(x|y|z|knee)")
    return {name: v * scale if contact.fullmatch(name) else v for name, v in values.items()}


def standing(scale: float) -> np.ndarray:
    """The printed gait's state with its contacts pressed in by as much as the same forces take."""
    names, x, soft = walker().state_names, np.array(GAIT["x"]), SimpleNamespace(**stiffened(1.0))

    def toe(state: np.ndarray, which: int) -> tuple[float, float, float]:
        return toe_place(state, soft, 2, which, Model())

    before = [toe(x, which) for which in (1, 2)]
    there = x.copy()
    there[names.index("q10")] /= scale
    depth = np.mean([place[1] for place in before])
    there[names.index("q2")] += depth / scale - np.mean([toe(there, which)[1] for which in (1, 2)])
    for which, anchors in ((1, ("p5", "p6")), (2, ("p7", "p8"))):
        for axis, name in zip((0, 2), anchors, strict=True):
            k = names.index(name)
            there[k] = toe(there, which)[axis] - (before[which - 1][axis] - x[k]) / scale
    return there


@cache
def stance(scale: float) -> tuple[CompiledField, np.ndarray, np.ndarray, np.ndarray]:
    """The field of the mode with its constants, the first state, and typical magnitudes."""
    mode = hybrid_machine(walker(), stiffened(scale)).mode(MODE)
    magnitudes = np.array([state.scale or 0.1 for state in walker().states])[mode.states]
    return mode.field, mode.c, standing(scale)[mode.states], magnitudes


@cache
def through(scale: float, method: str, tolerance: float) -> tuple[int, np.ndarray, np.ndarray]:
    """Number of steps, the state after the stance in units of its magnitudes, and its derivatives."""
    field, c, x, weights = stance(scale)
    control = flow.ErrorControl(tolerance, weights, 2_000_000)
    path = flow.controlled(field, c, 0.0, x, STANCE, control, method)
    assert path.status == "ok"
    end, moved = flow.tangents(field, c, path.times, x, np.diag(weights), [-1] * len(x), method)
    return len(path.times) - 1, end / weights, moved / weights[:, None]


@pytest.mark.parametrize("scale", SCALES)
def test_rates_grow_with_the_stiffness(scale):
    field, c, x, _ = stance(scale)
    fastest = -np.linalg.eigvals(field.jacobian(0.0, x, c)).real.min()
    assert fastest == pytest.approx(RATE * scale, rel=0.1)


@pytest.mark.parametrize("scale", SCALES)
@pytest.mark.parametrize("tolerance", [1e-6, 1e-9])
def test_state_and_derivatives_are_right(scale, tolerance):
    _, exact, derivatives = through(scale, "radau5", 1e-12)
    steps, end, moved = through(scale, "radau9", tolerance)
    assert steps < MOST_STEPS
    assert np.abs(end - exact).max() < tolerance
    assert np.abs(moved - derivatives).max() < 1e3 * tolerance * np.abs(derivatives).max()


@pytest.mark.parametrize("scale", [1, 10])
def test_explicit_steps_agree_where_they_can_be_afforded(scale):
    _, exact, derivatives = through(scale, "radau9", 1e-12)
    _, end, moved = through(scale, "dop853", 1e-9)
    assert np.abs(end - exact).max() < 1e-9
    assert np.abs(moved - derivatives).max() < 1e-6 * np.abs(derivatives).max()


def test_explicit_steps_grow_in_number_and_implicit_ones_hardly():
    explicit = [through(scale, "dop853", 1e-6)[0] for scale in SCALES[:2]]
    implicit = [through(scale, "radau9", 1e-6)[0] for scale in SCALES]
    assert 8.0 < explicit[1] / explicit[0] < 12.0
    assert implicit[-1] < 5 * implicit[0]


@pytest.mark.parametrize("scale", SCALES[1:])
def test_the_stiff_method_takes_over(scale):
    field, c, x, weights = stance(scale)
    choice = choose(field, c, 0.0, x, STANCE, flow.ErrorControl(1e-8, weights))
    assert choice.method == "radau9"
    assert "stability" in choice.reason
