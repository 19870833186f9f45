"""How an orbit closes, in words."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from small_systems import small_system

import contwalk as cw
from contwalk.branch import Branch
from contwalk.cli.summary import _orbits
from contwalk.system import Symmetry
from contwalk.workflow.stored.point_words import _of_orbit


def driven(t, x, p, dx):
    dx[0] = p.a * np.cos(t) - x[0]


def mirrored(t, x, p, y):
    y[0] = -x[0]


@pytest.fixture(scope="module")
def branch() -> Branch:
    """Orbits that are their own mirror images half a period of the forcing later."""
    mirror = Symmetry("mirror", "spatial", mirrored)
    system = small_system(driven, ("x",), {"a": 1.0}, symmetries=(mirror,), period=lambda p: 2.0 * math.pi)
    problem = cw.PeriodicOrbit(system, system.defaults(), "a")
    return cw.continue_branch(problem, [0.5], range=(0.9, 1.1), until="settled")


@pytest.mark.parametrize(("closure", "fold"), [("mirror", 2), ("full", 1)])
def test_periods_of_the_forcing_are_told_whatever_the_closure(branch, closure, fold):
    assert (branch.info.closure, branch.info.settings["fold"]) == ("mirror", 2)
    settings = {**branch.info.settings, "fold": fold}
    info = replace(branch.info, closure=closure, subharmonic=3, settings=settings)
    longer = replace(branch, info=info)
    assert "3 of the forcing" in _orbits(longer, "seconds")
    page = " ".join(_of_orbit(longer, 1.0, None, {}))
    assert ("3 of the forcing" in page) == (closure == "mirror")
    assert ("3 periods of the forcing" in page) == (closure == "full")
    once = replace(longer, info=replace(info, subharmonic=1))
    assert "forcing" not in _orbits(once, "seconds") + " ".join(_of_orbit(once, 1.0, None, {}))


def test_a_name_that_a_branch_has_not_is_told_with_those_that_it_has(branch):
    with pytest.raises(KeyError) as caught:
        branch["b"]
    known = str(caught.value).partition("Known: ")[2].rstrip('."').split(", ")
    assert "a" in known
    assert len(known) == len(set(known))
    with pytest.raises(KeyError, match=r"no special point 'HB9'\. Known: .*\.\"$"):
        branch.special("HB9")
