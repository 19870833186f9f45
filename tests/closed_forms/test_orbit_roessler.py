"""Roessler's spiral, a = b = 0.2: period doublings whose ratios tend to Feigenbaum's constant.

A doubled branch begins at a branch point, and at another place of its orbit than its parent does: the best
place for the section of a long orbit is where it is slow.
"""

import pytest
from invariants import check_orbit_branch
from orbit_systems import orbits
from small_systems import labelled, small_system

import contwalk as cw

FEIGENBAUM = 4.669201609
# O. E. Roessler, Physics Letters A 57 (1976) 397, doubles at c = 2.83, 3.84, 4.12, 4.19.
PRINTED = (3.84, 4.12, 4.19)
START, PERIOD = [-0.5106358874614251, -6.758094052655368, 0.03773321158082464], 11.56483917784737


def spiral(t, x, p, dx):
    dx[0] = -x[1] - x[2]
    dx[1] = x[0] + 0.2 * x[1]
    dx[2] = 0.2 + x[2] * (x[0] - p.c)


@pytest.mark.drawn(1)
@pytest.mark.slow
@pytest.mark.parametrize("accuracy", [1e-6, 1e-8])
def test_the_cascade_of_the_spiral(accuracy: float) -> None:
    problem = orbits(small_system(spiral, ("x", "y", "z"), {"c": 3.750158598218444}), "c", accuracy=accuracy)
    branch, doublings = cw.continue_branch(problem, START, (3.7, 4.19), period=PERIOD), []
    for number, printed in enumerate(PRINTED):
        assert labelled(branch, "LP", "BP", "NS") == []
        (doubling,) = labelled(branch, "PD")
        assert doubling.status == "located"
        assert doubling.parameters["c"] == pytest.approx(printed, abs=0.005)
        assert doubling.criticality == "supercritical"
        assert branch.outcome.reason == "bound"
        doublings.append(doubling.parameters["c"])
        if number < len(PRINTED) - 1:
            branch = cw.switch_branch(problem, branch, doubling.name, (3.7, 4.19))
            # The doubled orbit, and not its parent gone round twice.
            assert branch["unstable"][-1] == (1 if number < 2 else 0)
    first, second, third = doublings
    assert (second - first) / (third - second) == pytest.approx(FEIGENBAUM, rel=0.03)
    check_orbit_branch(branch, problem)
