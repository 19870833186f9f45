"""What the unknowns of a stored orbit are: pieces of legs, their times, and drifts along held directions."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from peers.machines.relay_feedback import PEER, SYSTEM
from peers.problems import rossler
from peers.running import run_study
from small_systems import labelled, small_system

import contwalk as cw
from contwalk.branch import BranchInfo
from contwalk.system import Neutral
from contwalk.verification.checking import checked, records_of
from contwalk.verification.finding import AGREES
from contwalk.verification.stored_orbit import stored_orbit


def info(**settings) -> BranchInfo:
    return BranchInfo("b1", "periodic_orbit", ("x", "y"), (), ("a",), {"a": 0.0}, 12, 1, settings=settings)


def test_pieces_of_legs_stand_behind_durations_and_drifts():
    told = info(legs=[["m", "e", True], ["n", "f", True]], pins=["along"])
    u = np.arange(12.0)  # legs of 2 and 1 states, two durations, a drift, and two more pieces of each leg
    found = stored_orbit(told, u, [2, 1], False, 1.0)
    np.testing.assert_array_equal(found.starts[0], [[0, 1], [6, 7], [8, 9]])
    np.testing.assert_array_equal(found.starts[1], [[2], [10], [11]])
    np.testing.assert_array_equal(found.durations, [3, 4])
    np.testing.assert_array_equal(found.drifts, [5])
    np.testing.assert_allclose(found.begins[0], [0, 1 / 3, 2 / 3], rtol=1e-15)


@pytest.mark.parametrize("times", [None, [0.1, 0.6]])
def test_pieces_of_one_leg_begin_evenly_or_when_the_record_says(times):
    u = np.concatenate([np.arange(6.0), [7.0, 0.25], [] if times is None else times])
    found = stored_orbit(info(pins=["along"], scheme="collocation"), u, [2], False, 7.0)
    np.testing.assert_array_equal(found.starts[0], [[0, 1], [2, 3], [4, 5]])
    np.testing.assert_array_equal(found.drifts, [0.25])
    np.testing.assert_allclose(found.begins[0], [0, *(times or [1 / 3, 2 / 3])], rtol=1e-15)


def slips(t, x, p, dx):
    """r' = (mu - r^2) r, turning once a second, beside z' = 0.3 + x: z runs on by 0.3 a round."""
    growth, turn = p.mu - x[0] ** 2 - x[1] ** 2, 2.0 * math.pi
    dx[0] = growth * x[0] - turn * x[1]
    dx[1] = turn * x[0] + growth * x[1]
    dx[2] = 0.3 + x[0]


def test_an_orbit_that_closes_but_for_a_drift_agrees():
    def along(t, x, p, v):
        v[0], v[1], v[2] = 0.0, 0.0, 1.0

    system = small_system(slips, "xyz", {"mu": 0.25}, neutral=(Neutral("z", along),))
    orbit = cw.PeriodicOrbit(system, system.defaults(), "mu")
    branch = cw.continue_branch(orbit, [0.5, 0.0, 0.0], (0.2, 1.0), period=1.0)
    assert not labelled(branch, "PD")
    found = checked(system, records_of([branch]), {"mu": (0.2, 1.0)}, math.inf)
    assert found
    assert {each.verdict for each in found} == {AGREES}, found


def test_an_orbit_that_a_leg_of_no_time_begins_agrees(tmp_path):
    """Relay feedback that crosses and slides: the output comes back to zero where it has left it already."""
    (study,) = PEER.studies
    branches = run_study("relay_feedback", study, tmp_path).branches
    assert any(leg[3] for branch in branches for leg in branch.info.settings["legs"] if len(leg) > 3)
    found = checked(SYSTEM, records_of(branches), {"zeta": tuple(study.run["continue"]["range"])}, math.inf)
    assert len(found) > 20
    assert {each.verdict for each in found} == {AGREES}, found


def test_the_coefficient_of_an_orbit_of_four_rounds_agrees(tmp_path):
    """The size of its critical vector is a mean over all of its steps, however many rounds they make."""
    (study,) = rossler.PEER.studies
    shorter = replace(study, run=study.run | {"diagram": {"depth": 2}})
    branch = run_study("rossler", shorter, tmp_path).branches[2]
    (point,) = labelled(branch, "PD")
    (found,) = checked(rossler.SYSTEM, [(branch, point)], {}, math.inf)
    assert found.verdict == AGREES, found
