"""Two crossings at a drawn distance within a drawn range, 1e-1 to 1e-9 of it: neither is lost.

`run_pairs.py` walks past more of them.
"""

from __future__ import annotations

import numpy as np
import pairs_of_equilibria
import pytest
from pairs_form import FREE, Crossing, Draw
from pairs_judged import BETWEEN, judged, walked
from pairs_kinds import DIPS, KINDS, case

# Of two eigenvalues, or of an eigenvalue and the parameter: each passes by itself, at any distance.
APART = [kind for kind in KINDS if kind not in DIPS]
# Of equilibria parabolas as well, whose depth is decided by more digits where it is rounding.
FAST = [*pairs_of_equilibria.EQUILIBRIA, "machines BE BE"]
# Parabolas of multipliers and of margins of orbits: nearer than this the depth is what they are known to.
KNOWN, KNOWN_MARGIN = 1e-6, 2e-5


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("kind", FAST)
def test_both_are_located_however_near(kind, seed):
    """A window of a pair beside a third point is one unlocated point where it is nothing but rounding."""
    drawn = case(kind, seed)
    verdict = judged(drawn, walked(drawn))
    window = kind in ("LP HB HB", "BP HB HB") and drawn.distance < KNOWN
    assert verdict.outcome in ("located", *(["unlocated"] if window else [])), verdict.text


@pytest.mark.parametrize("near_miss", [False, True])
def test_a_dip_that_is_within_errors_is_one_unlocated_point_with_its_interval(near_miss):
    """Of a miss as well: what is known does not tell both from each other."""
    drawn = case("maps BP BP", 5, near_miss)
    assert drawn.distance < 1e-8
    branch = walked(drawn)
    (point,) = [point for point in branch.special_points if point.label != "EP"]
    low, high = (float(end) for end in BETWEEN.search(point.note).groups())
    half = 0.5 * drawn.distance * (drawn.range[1] - drawn.range[0])
    assert point.status == "unlocated"
    assert low < point.parameters[FREE] - half < point.parameters[FREE] + half < high


@pytest.mark.slow
@pytest.mark.drawn(1)
@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("kind", [kind for kind in APART if kind.startswith("maps")])
def test_both_multipliers_of_a_map_are_located(kind, seed):
    drawn = case(kind, seed)
    verdict = judged(drawn, walked(drawn))
    assert verdict.outcome == "located", verdict.text


@pytest.mark.long
@pytest.mark.parametrize("kind", KINDS)
def test_no_pair_that_is_farther_apart_than_its_depth_is_rounding_is_lost(kind):
    nearest = KNOWN_MARGIN if kind == "machines GR GR" else KNOWN
    for seed in range(10):
        drawn = case(kind, seed)
        if drawn.distance > nearest:
            verdict = judged(drawn, walked(drawn))
            assert verdict.outcome == "located", (seed, verdict.text)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("kind", ["BP BP", "HB HB", "HB HB of flutter", "LP LP", "UZ UZ", "machines BE BE"])
def test_what_comes_as_near_and_turns_back_is_no_point(kind, seed):
    drawn = case(kind, seed, near_miss=True)
    verdict = judged(drawn, walked(drawn))
    assert verdict.outcome == "nothing", verdict.text


@pytest.mark.parametrize("seed", range(20))
def test_frames_are_exact(seed):
    """What is told is compared with the closed form in y: the plugin's x is y to the last digit."""
    frame = Draw("frame", seed, False).frame(5)
    assert np.array_equal(frame.matrix @ frame.inverse, np.eye(5))


def test_a_lost_crossing_is_noticed():
    drawn = case("BP BP of two eigenvalues", 0)
    branch = walked(drawn)
    more = Crossing("HB", drawn.crossings[0].place)
    lost = judged(type(drawn)(**{**vars(drawn), "crossings": (*drawn.crossings, more)}), branch)
    assert lost.outcome == "lost"
    false = judged(type(drawn)(**{**vars(drawn), "crossings": drawn.crossings[:1]}), branch)
    assert false.outcome == "false"
