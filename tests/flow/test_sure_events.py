"""Where guards pass zero with a rate, the compiled integrator finds the events itself.

Where it is not sure, a slower way takes over that looks along the path: the results are the same.
"""

from __future__ import annotations

import numpy as np
import pytest
from hybrid_systems import BALL, COUNTERS, STOP

from contwalk.flow.hybrid import segment_events
from contwalk.flow.hybrid.motion_segment import Control
from contwalk.flow.hybrid.motions import hybrid_machine, motion_segments


@pytest.mark.parametrize("method", ["dop853", "verner98"])
@pytest.mark.parametrize(
    ("system", "start", "until"),
    [(BALL, [1.0, 0.0], 1.2), (COUNTERS, [0.7, 1.2, 0.0], 3.0), (STOP, [0.1, 0.6], 12.0)],
    ids=lambda given: getattr(given, "name", ""),
)
def test_the_slower_way_is_not_asked(monkeypatch, system, start, until, method):
    monkeypatch.setattr(segment_events, "by_paths", lambda *_: pytest.fail("It was not sure."))
    control = Control(1e-11, np.ones(len(start)), method)
    machine = hybrid_machine(system, system.defaults())
    found = list(motion_segments(machine, 0.0, np.array(start), system.modes[0].name, until, control))
    assert sum(segment.transition is not None for segment in found) >= 3
