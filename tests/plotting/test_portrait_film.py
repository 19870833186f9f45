"""A point on a phase portrait is where the motion is."""

from __future__ import annotations

import numpy as np
import pytest

from contwalk.plotting.playback import Playback
from contwalk.plotting.portrait_film import PortraitFilm
from contwalk.system import Mode, Parameter, State, System


def turning(t, x, p, dx):
    dx[0] = -x[1]
    dx[1] = x[0]


CIRCLE = System(
    "circle",
    states=(State("x", "m"), State("y", "m")),
    parameters=(Parameter("r", 1.0),),
    modes=(Mode("turning", turning),),
)
TIMES = np.linspace(0.0, 2.0 * np.pi, 401)
STATES = np.stack([np.cos(TIMES), np.sin(TIMES)], axis=1)


def film(**options):
    motion = Playback(CIRCLE, TIMES, STATES, {})
    return PortraitFilm(motion, [(np.pi, "half")], "title", "", size=(6.0, 6.0), dpi=100, **options)


@pytest.mark.parametrize("time", [0.0, 0.3, np.pi, 2.0 * np.pi])
def test_the_point_is_where_the_motion_is(time):
    shown = film(beside=Playback(CIRCLE, TIMES, 2.0 * STATES, {}))
    shown.show(time)
    # Between two instants the motion is a straight line: h**2 / 8 from the circle.
    within = (TIMES[1] - TIMES[0]) ** 2 / 8.0 + 1e-12
    at, pale = (np.ravel(each.get_xydata()) for each in (shown.point, shown.pale))
    assert np.abs(at - [np.cos(time), np.sin(time)]).max() <= within
    assert np.abs(pale - 2.0 * at).max() <= 2.0 * within
    assert np.abs(np.ravel(shown.hand.get_xydata()) - [time, np.cos(time)]).max() <= within


def test_frames_draw_nothing_anew():
    shown = film()
    before = [len(ax.get_children()) for ax in shown.figure.axes]
    for time in (0.5, 1.0, 1.5):
        shown.show(time)
    assert [len(ax.get_children()) for ax in shown.figure.axes] == before
