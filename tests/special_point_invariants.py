"""What is true of the special points of any branch, against the branch's own rows."""

from __future__ import annotations

import math

import numpy as np

from contwalk.branch import LABELS, Branch, SpecialPoint

# Limits may be where a branch ends, and do nothing to the count.
LIMITS = ("GR", "OC", "AZ")


def check_special_points(branch: Branch) -> None:
    """Assert the invariants of a branch's special points."""
    _check_names(branch)
    for point in branch.special_points:
        _check_special_point(branch, point)


def _check_names(branch: Branch) -> None:
    counts = dict.fromkeys(LABELS, 0)
    places = [point.s for point in branch.special_points]
    assert places == sorted(places)
    for point in branch.special_points:
        counts[point.label] += 1
        assert point.name == f"{point.label}{counts[point.label]}"
    kinds = [point.kind for point in branch.special_points if point.label == "EP"]
    assert branch.outcome.reason in kinds
    named = {point.index for point in branch.special_points if point.label != "EP"}
    assert set(np.flatnonzero(branch["special"])) <= named, "a special row without its special point"


def _marks_the_start(point: SpecialPoint) -> bool:
    """A mark that the start itself has is on the start's own row."""
    return point.label == "UZ" and point.s == 0.0


def _check_special_point(branch: Branch, point: SpecialPoint) -> None:
    row = branch.points[point.index]
    assert row["s"] == point.s
    free = branch.info.free[0]
    value = point.parameters[free] if free in point.parameters else float(row["free"][0])
    assert row["free"][0] == value
    assert np.array_equal(row["state"], [point.state[name] for name in branch.info.states])
    assert point.status == "located", f"{point.name} is unlocated: {point.note}"
    assert point.error is not None
    assert math.isfinite(point.error)
    assert point.error >= 0.0
    assert (point.criticality in ("supercritical", "subcritical")) == _decided(point)
    if point.label != "EP" and not _marks_the_start(point):
        assert row["special"]
        _check_interval(branch, point, value)
    _check_counts(branch, point)


def _decided(point: SpecialPoint) -> bool:
    """Whether a point has a criticality."""
    if point.label == "NS":  # at a strong resonance the normal form is another one
        return "d" in point.coefficients
    if point.label == "BP":  # a vertical branch has none: its cubic coefficient vanishes
        # One at which the branch is its parent's again has no coefficients, but the parent's criticality.
        return point.kind in ("pitchfork", "symmetry-breaking") and point.coefficients.get("c", 1.0) != 0.0
    return point.label == "HB" or (point.label == "PD" and point.coefficients.get("c", 0.0) != 0.0)


def _check_interval(branch: Branch, point: SpecialPoint, value: float) -> None:
    """The parameter lies between the neighbours' ones; a fold, or the fold-like side of a pitchfork, beyond
    them.
    """
    free, i = branch["free"][:, 0], point.index
    ends = point.label in ("UZ", *LIMITS) or "the branch ends on it" in (point.note or "")
    assert 0 < i < len(branch) - 1 or ends, "a bifurcation at an end"
    if not 0 < i < len(branch) - 1:
        return
    slack = float(point.error or 0.0) + 4.0 * float(np.spacing(abs(value)))
    low, high = sorted((free[i - 1], free[i + 1]))
    if point.label == "LP":
        assert value >= high - slack or value <= low + slack, "a fold between its neighbours' parameters"
    elif point.label != "BP":
        assert low - slack <= value <= high + slack


def _check_counts(branch: Branch, point: SpecialPoint) -> None:
    """Counts on both sides are those of the neighbouring points."""
    before, after = point.unstable_before, point.unstable_after
    if point.label in ("EP", "UZ", *LIMITS):
        assert before == after
    else:
        assert (
            abs(after - before) in {"HB": (2,), "LP": (1,), "BP": (0, 1), "PD": (1,), "NS": (2,)}[point.label]
        )
    if point.label == "EP":
        return
    at = {other.index: other for other in branch.special_points if other.label != "EP"}
    i = point.index
    if i > 0:
        left = at[i - 1].unstable_after if i - 1 in at else branch["unstable"][i - 1]
        assert left in (before, -1), f"{point.name}: {before} before, {left} at its neighbour"
    if i < len(branch) - 1:
        right = at[i + 1].unstable_before if i + 1 in at else branch["unstable"][i + 1]
        assert right in (after, -1), f"{point.name}: {after} after, {right} at its neighbour"
