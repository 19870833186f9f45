"""Records that were changed by hand, all of which are told; and the same records as they are, which agree."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hybrid_runs import branch_of, machine
from small_systems import labelled, small_system

import contwalk as cw
from contwalk.branch import Branch, SpecialPoint
from contwalk.system import System, Transition
from contwalk.verification.checking import checked, records_of
from contwalk.verification.finding import AGREES, CANNOT_TELL, DISAGREES, Finding

RANGES = {"b": (-0.24, 1.0), "mu": (-0.3, 0.2), "a": (-3.0, 3.0), "lift": (1.1, 2.4)}


def takens(t, x, p, dx):
    """Cycles of a Hopf point at b = 0 that end at a saddle's loop near b = 0.21."""
    dx[0] = x[1]
    dx[1] = -p.b - x[0] + x[0] ** 2 - x[0] * x[1]


def folding(t, x, p, dx):
    """r' = r (mu + r^2 - r^4): cycles from a Hopf point at 0, which fold at mu = -1/4."""
    r2 = x[0] ** 2 + x[1] ** 2
    growth = p.mu + r2 - r2**2
    dx[0] = growth * x[0] - x[1]
    dx[1] = x[0] + growth * x[1]


def ring(t, x, p, dx):
    """x^2 + a^2 = 1: a closed branch with two folds."""
    dx[0] = x[0] ** 2 + p.a**2 - 1.0


def fall(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -1.0


def height(t, x, p):
    return x[0] - p.lift * math.sin(t)


def bounce(t, x, p, x_plus):
    x_plus[0] = x[0]
    x_plus[1] = p.lift * math.cos(t) - 0.5 * (x[1] - p.lift * math.cos(t))


BALL = machine(
    "yv",
    {"lift": 1.2},
    {"flight": fall},
    [
        Transition("impact", "flight", "flight", height, reset=bounce),
        Transition("ceiling", "flight", "flight", lambda t, x, p: 6.0 - x[0], role="watched"),
        Transition("speed", "flight", "flight", lambda t, x, p: 40.0 - x[1], role="watched"),
    ],
    period=lambda p: 2.0 * math.pi,
)


@pytest.fixture(scope="module")
def studies() -> list[tuple[System, list[Branch]]]:
    """Equilibria with their cycles, a closed branch, and a ball on a table that doubles its period."""
    found = []
    for field, states, free, start in ((takens, "xy", "b", 2 * [0.0]), (folding, "xy", "mu", 2 * [0.0])):
        system = small_system(field, states, {free: -0.1})
        rest = cw.Equilibrium(system, system.defaults(), free)
        branch = cw.continue_branch(rest, start, RANGES[free])
        found.append((system, [branch, cw.switch_branch(rest, branch, "HB1", range=RANGES[free])]))
    system = small_system(ring, "x", {"a": 0.0})
    rings = cw.continue_branch(cw.Equilibrium(system, system.defaults(), "a"), [-1.0], RANGES["a"])
    balls = branch_of(BALL, "lift", RANGES["lift"], [1.0, 3.0], until="settled", events={"GR": "ignore"})
    return [*found, (system, [rings]), (BALL, [balls])]


def verdicts(system: System, branch: Branch, record: SpecialPoint | int) -> list[Finding]:
    """What is found of one record."""
    return checked(system, [(branch, record)], RANGES, math.inf)


def moved(branch: Branch, point: SpecialPoint, errors: float) -> SpecialPoint:
    """A point at another value of the free parameter, so many errors, or roundings of its size, away."""
    value, free = point.unknowns[-1], branch.info.free[0]
    size = max(abs(value), float(branch.points["weights"][point.index][len(point.unknowns) - 1]))
    value += errors * max(point.error or 0.0, 4.0 * float(np.spacing(size)))
    unknowns = (*point.unknowns[:-1], value)
    return replace(point, unknowns=unknowns, parameters={**point.parameters, free: value})


def falsified(branch: Branch, point: SpecialPoint) -> dict[str, SpecialPoint]:
    """What may be wrong of a special point, by what was done to it."""
    found = {"moved up": moved(branch, point, 100.0), "moved down": moved(branch, point, -100.0)}
    if point.criticality:
        other = {"supercritical": "subcritical", "subcritical": "supercritical"}[point.criticality]
        found["criticality"] = replace(point, criticality=other)
    for name in {"l1", "c", "d"} & set(point.coefficients) if point.criticality else ():
        turned = {**point.coefficients, name: -point.coefficients[name]}
        found["criticality and coefficient"] = replace(found["criticality"], coefficients=turned)
    if "l1" in point.coefficients:
        omega = {**point.coefficients, "omega": 2.0 * point.coefficients["omega"]}
        found["another pair's omega"] = replace(point, coefficients=omega)
    if point.label in ("HB", "PD", "NS"):
        spectrum = (1.5 * point.spectrum[0] + 0.1, *point.spectrum[1:])
        found["an eigenvalue"] = replace(point, spectrum=spectrum)
        before, after = point.unstable_before or 0, point.unstable_after or 0
        found["counts"] = replace(point, unstable_before=before + 1, unstable_after=after + 1)
        found["labelled LP"] = replace(point, label="LP", criticality=None, coefficients={})
    if "'ceiling'" in (point.note or ""):
        note = (point.note or "").replace("ceiling", "speed")
        found["another touch"] = replace(
            point, note=note, kind="speed" if point.kind == "ceiling" else point.kind
        )
    return found


def test_records_as_they_are_agree(studies):
    for system, branches in studies:
        for each in checked(system, records_of(branches), RANGES, 3.0):
            assert each.verdict == AGREES, each


def test_falsified_points_are_told(studies):
    done = 0
    for system, branches in studies:
        for branch in branches:
            for point in branch.special_points:
                for what, wrong in {} if point.label in ("EP", "UZ") else falsified(branch, point).items():
                    (found,) = verdicts(system, branch, wrong)
                    # Of what was moved by some roundings it is told, too, that these cannot be told apart.
                    allowed = (DISAGREES, CANNOT_TELL) if what.startswith("moved") else (DISAGREES,)
                    assert found.verdict in allowed, (what, found)
                    done += 1
    assert done > 20


def test_ends_with_a_wrong_word_are_told(studies):
    for system, branches in studies:
        for branch in branches:
            for end in labelled(branch, "EP"):
                for word in {"bound", "closed", "homoclinic", "shrunk", "unbounded", "grazing"} - {end.kind}:
                    (found,) = verdicts(system, branch, replace(end, kind=word))
                    assert found.verdict != AGREES, (word, found)


def test_rows_that_were_changed_are_told(studies):
    for system, branches in studies:
        for branch in branches:
            row = next(k for k in range(len(branch) // 3, len(branch)) if not branch.points["special"][k])
            for column, change in (
                ("stable", lambda row: 1 - row["stable"]),
                ("unstable", lambda row: row["unstable"] + 1),
                ("spectrum", lambda row: 1.001 * row["spectrum"] + 0.1),
                ("unknowns", lambda row: row["unknowns"] + 1e-3 * row["weights"][: len(row["unknowns"])]),
            ):
                points = branch.points.copy()
                points[column][row] = change(points[row])
                found = verdicts(system, replace(branch, points=points), row)
                assert any(each.verdict == DISAGREES for each in found), (column, found)


def test_multipliers_that_mean_nothing_are_not_agreed_with(studies):
    system, (branch,) = studies[-1]
    (point,) = labelled(branch, "PD")
    (found,) = verdicts(system, branch, replace(point, trivial_error=0.77))
    assert (found.verdict, "off by 0.77" in found.reason) == (CANNOT_TELL, True)
