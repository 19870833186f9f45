"""A simulation that begins beside an equilibrium that attracts comes to rest there; it is no small orbit."""

from __future__ import annotations

import numpy as np
import pytest

from contwalk.problems.initial.recurrence import AtRest, recurrent
from contwalk.system import Mode, Parameter, State, System


def _shimizu_morioka(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = x[0] - p.la * x[1] - x[0] * x[2]
    dx[2] = -p.al * x[2] + x[0] ** 2


SYSTEM = System(
    "shimizu_morioka",
    states=(State("X"), State("Y"), State("Z")),
    parameters=(Parameter("la", 1.5), Parameter("al", 0.5)),
    modes=(Mode("smooth", _shimizu_morioka),),
)


@pytest.mark.parametrize("begin", [0.2, 0.5, 0.7, 0.7071, 1.0])
def test_it_comes_to_rest(begin) -> None:
    """The first stretch is long beside it: its later part is what rounding leaves of the motion."""
    with pytest.raises(AtRest) as told:
        recurrent(SYSTEM, {"la": 1.5, "al": 0.5}, np.array([begin, 0.0, 1.0]))
    np.testing.assert_allclose(told.value.state, [0.5**0.5, 0.0, 1.0], atol=1e-11)
