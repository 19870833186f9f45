"""The planar walker where it has got to: pictures of several steps fit together."""

from __future__ import annotations

import numpy as np
import pytest
from contwalk_systems.planar_walker import SYSTEM
from contwalk_systems.planar_walker.drawing import walked
from contwalk_systems.planar_walker.observables import rolled
from contwalk_systems.planar_walker.states import LEGS, Q1
from matplotlib.figure import Figure

from contwalk.plotting.machine import plot_machine, walks
from contwalk.system.declarations import ParameterValues

P = ParameterValues(**SYSTEM.defaults())
# Just before heel strike in the gait of Table I of the paper: both legs straight, both feet on the ground.
BEFORE = np.array([-0.5196, 0.1528388, 0.0, 0.0, -1.933, -2.037, 0.0])
AFTER = np.zeros(7)
LEGS.map(0.0, BEFORE, P, AFTER)


def drawn(so_far):
    axes = Figure().subplots()
    SYSTEM.draw(axes, 0.0, so_far[1][-1], P, so_far)
    return axes


def outlines(axes):
    """Lines by their colour, the joints left out."""
    found = {}
    for line in axes.lines:
        if line.get_gid() != "scenery" and line.get_marker() == "None":
            found.setdefault(line.get_color(), []).append(line.get_xydata())
    return {color: np.concatenate(parts) for color, parts in found.items()}


def test_the_walker_gets_somewhere():
    assert walks(SYSTEM)


def test_at_heel_strike_nothing_moves_and_each_leg_keeps_its_colour():
    one = outlines(drawn((np.zeros(1), BEFORE[None])))
    two = outlines(drawn((np.zeros(2), np.array([BEFORE, AFTER]))))
    assert set(one) == set(two)
    for color in one:
        # The printed state has seven digits: its feet are on the ground to 1e-7 m.
        np.testing.assert_allclose(one[color], two[color], atol=1e-6)


def test_the_way_of_a_step_is_that_of_the_hip():
    steps = 3
    times = np.repeat(np.arange(steps + 1.0), 2)[1:-1]
    states = np.array([AFTER, BEFORE] * steps)
    shift, swapped = walked(times, states, P)
    assert swapped == (steps % 2 == 0)
    length = rolled(BEFORE[Q1], P) - rolled(AFTER[Q1], P)  # the observable step_length
    assert shift == pytest.approx((steps - 1) * length)
    across = [np.mean(drawn((times[:k], states[:k])).get_xlim()) for k in (2, 4, 6)]
    np.testing.assert_allclose(np.diff(across), length * np.cos(P.alpha))


def test_a_knee_strike_changes_nothing_of_place_and_names():
    bent, straight = BEFORE.copy(), BEFORE.copy()
    bent[6], straight[4] = -3.0, -1.0
    assert walked(np.zeros(2), np.array([bent, straight]), P) == (0.0, False)


def test_a_picture_without_a_motion_has_the_standing_leg_blue():
    ax = plot_machine(SYSTEM, AFTER, {})
    labels = {line.get_label(): line.get_color() for line in ax.lines if not line.get_label().startswith("_")}
    assert labels == {"leg 1, standing": "#1f4e79", "leg 2, swinging": "#c0392b"}
    texts = [text for text in ax.texts if text.get_visible()]
    assert "0 m" in [text.get_text() for text in texts]
    frame = ax.get_window_extent()
    for text in texts:  # none is cut by the side of the picture
        box = text.get_window_extent()
        assert frame.x0 <= box.x0 <= box.x1 <= frame.x1
