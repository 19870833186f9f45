"""Which pushes change what a machine conserves."""

from __future__ import annotations

import numpy as np
import pytest

from contwalk.studies.margins.conserved import changed_quantities
from contwalk.studies.margins.solution import Instant, Solution
from contwalk.system import Conserved, Mode, Parameter, State, System


def field(t, x, p, dx):
    dx[0] = x[1] - x[0]
    dx[1] = x[0] - x[1]
    dx[2] = -x[2]


def total(t, x, p):
    return p.scale * (x[0] + x[1])


def logarithm(t, x, p):
    return np.log(x[0] + x[1]) if x[0] + x[1] > 0.0 else 1.0 / 0.0


SYSTEM = System(
    "two_vessels",
    states=(State("a"), State("b"), State("c")),
    parameters=(Parameter("scale", 1e-7),),
    modes=(Mode("flows", field),),
    conserved=(Conserved("total", total), Conserved("logarithm", logarithm)),
)


@pytest.mark.parametrize(
    ("push", "names"),
    [
        ((1.0, 0.0, 0.0), ["total", "logarithm"]),
        ((0.1, -0.1, 0.0), []),
        ((0.0, 0.0, 3.0), []),
        ((-5.0, 0.0, 0.0), ["total"]),
    ],
)
def test_pushes_along_a_level_change_nothing(push, names):
    instant = Instant(0.0, 0.0, "flows", np.array([0.3, 0.7, 0.1]), (0, 1, 2))
    solution = Solution({"scale": 1e-7}, 1.0, (instant,), (), np.ones(3), np.zeros((2, 3)))
    assert changed_quantities(SYSTEM, solution, [(instant, np.array(push))]) == names
