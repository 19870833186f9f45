"""What keeps steps short is looked for where something is smooth by pieces only: nothing else can jump."""

from __future__ import annotations

import numpy as np
import pytest

from contwalk.flow.hybrid import blaming
from contwalk.flow.hybrid.motion_segment import Control
from contwalk.flow.hybrid.motions import hybrid_machine, motion_segments
from contwalk.system import Mode, Parameter, State, System, Transition


def decaying(field) -> System:
    """A motion that comes to rest and never meets its event."""
    event = Transition("far", "free", "free", lambda t, x, p: x[0] - 5.0, "rising", reset=halved)
    return System(
        "decaying", (State("x"),), (Parameter("k", 1.0),), modes=(Mode("free", field),), transitions=(event,)
    )


def halved(t, x, p, after):
    after[0] = 0.5 * x[0]


def smooth(t, x, p, dx):
    dx[0] = -p.k * x[0]


def kinked(t, x, p, dx):
    dx[0] = -p.k * abs(x[0] - 1e-3) + 0.0 * x[0]


@pytest.mark.parametrize(("field", "asked"), [(smooth, False), (kinked, True)])
def test_only_functions_with_pieces_are_run_once_more(monkeypatch, field, asked):
    looked: list[object] = []
    found = blaming.first_switched
    monkeypatch.setattr(blaming, "first_switched", lambda *given: looked.append(given) or found(*given))
    system = decaying(field)
    machine = hybrid_machine(system, system.defaults())
    control = Control(1e-9, np.ones(1), "dop853")
    (last,) = motion_segments(machine, 0.0, np.array([1.0]), "free", np.inf, control, None, 50)
    assert last.status == "too_many_steps"
    assert bool(looked) == asked
