"""Machines with a picture, and motions of theirs that are known in closed form."""

from __future__ import annotations

import math

import numpy as np

from contwalk.system import Mode, Parameter, State, System


def still(t, x, p, dx):
    dx[0] = 1.0


def draw_hopper(axes, t, x, p, so_far=None):
    """A point that lands ever farther away: x is its place in the hop, each of length one."""
    hops = 0.0 if so_far is None else float((np.diff(so_far[0]) == 0.0).sum())
    place = x[0] + hops
    axes.plot([-10.0, 10.0], [0.0, 0.0], gid="scenery")
    axes.text(place, -0.1, f"{place:g}", gid="scenery", clip_on=True)
    axes.plot([place, place], [0.0, p.height], "o-", label="leg", gid="leg")
    axes.fill([place - 0.1, place + 0.1, place], [0.0, 0.0, 0.1], gid="foot")
    axes.set_xlim(place - 1.0, place + 1.0)
    axes.set_ylim(-0.2, 1.2 * p.height)


def draw_hand(axes, t, x, p):
    """The hand of a clock, with the limits that matplotlib chooses."""
    axes.plot([0.0, p.height * math.cos(x[0])], [0.0, p.height * math.sin(x[0])], gid="hand")


def machine(draw, name="machine"):
    return System(
        name,
        states=(State("x", "m"),),
        parameters=(Parameter("height", 0.5, "m"),),
        modes=(Mode("moving", still),),
        draw=draw,
    )


HOPPER, CLOCK = machine(draw_hopper, "hopper"), machine(draw_hand, "clock")

# Two hops of a second each: in each of them x grows from 0 to 1.
TIMES = np.concatenate([np.linspace(0.0, 1.0, 11), np.linspace(1.0, 2.0, 11)])
STATES = np.concatenate([np.linspace(0.0, 1.0, 11)] * 2)[:, None]
EVENTS = [(0.0, "landing"), (1.0, "landing"), (2.0, "landing")]
# A turn of the hand.
TURN_TIMES = np.linspace(0.0, 4.0, 41)
TURN_STATES = np.linspace(0.0, 2.0 * np.pi, 41)[:, None]
