"""Curves in two parameters that leave their ranges and come back are one; isolas close."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hybrid_runs import branch_of
from loci_of_orbits import henon, henon_fixed_point, largest
from small_systems import labelled, small_system

import contwalk as cw
from contwalk.branch import Branch


def isola(t, x, p, dx):
    """Folds on the unit circle."""
    dx[0] = p.a**2 + p.b**2 - 1.0 + x[0] ** 2


def wave(t, x, p, dx):
    """Folds where a = b^3 - b."""
    dx[0] = p.a - p.b**3 + p.b - x[0] ** 2


def followed(
    field, start: dict[str, float], x: float, ranges, along=(-2.0, 2.0), which="LP1", **rest
) -> Branch:
    system = small_system(field, "x", start)
    branch = cw.continue_branch(
        cw.Equilibrium(system, start, "a"), [x], range=along, max_step=0.4, max_share=0.2
    )
    return cw.continue_locus(system, branch, which, ranges, max_step=0.4, max_share=0.2, **rest)


@pytest.mark.drawn(1)
@pytest.mark.parametrize("direction", ["both", "backward"])
def test_an_isola_that_is_cut_by_its_range_closes(direction) -> None:
    ranges = {"a": (-2.0, 2.0), "b": (-2.0, 0.8)}
    curve = followed(isola, {"a": 0.0, "b": 0.3}, -(0.91**0.5), ranges, direction=direction)
    assert curve.outcome.reason == "closed"
    np.testing.assert_allclose(curve["a"] ** 2 + curve["b"] ** 2, 1.0, atol=1e-13)
    assert curve["b"].max() == 0.8
    (gap,) = curve.gaps()
    np.testing.assert_array_equal(curve["b"][gap : gap + 2], 0.8)
    np.testing.assert_allclose(np.sort(curve["a"][gap : gap + 2]), [-0.6, 0.6], rtol=1e-13)
    # Arclength goes on outside.
    assert curve["s"][gap + 1] - curve["s"][gap] > np.abs(np.diff(curve["a"][gap : gap + 2]))


def test_a_curve_that_comes_back_goes_on_to_its_end() -> None:
    ranges = {"a": (-0.5, 0.3), "b": (-1.05, 1.05)}
    curve = followed(wave, {"a": 0.0, "b": 0.4}, 0.58, ranges, along=(-1.0, 0.5))
    assert curve.outcome.reason == "bound"
    assert (curve["b"].min(), curve["b"].max()) == (-1.05, 1.05)
    assert curve["a"].max() == 0.3
    np.testing.assert_allclose(curve["a"], curve["b"] ** 3 - curve["b"], atol=1e-13)
    assert len(curve.gaps()) == 1
    assert len(labelled(curve, "EP")) == 2


def test_what_does_not_come_back_ends_where_it_leaves() -> None:
    ranges = {"a": (-0.5, 0.3), "b": (-0.4, 0.6)}
    curve = followed(wave, {"a": 0.0, "b": 0.4}, 0.58, ranges, along=(-1.0, 0.5))
    assert curve.gaps() == []
    assert (curve["b"].min(), curve["b"].max()) == (-0.28, 0.6) or curve["a"].max() == 0.3


def glycolysis(t, x, p, dx):
    """Sel'kov's model: rests at x = b, y = b / (a + b^2)."""
    used = (p.a + x[0] ** 2) * x[1]
    dx[0], dx[1] = used - x[0], p.b - used


def test_a_curve_that_comes_back_with_another_eigenvalue_does_not_come_back() -> None:
    """Through b = 0 the curve of the eigenvalue -0.2 comes back where the other one is the largest."""
    start = {"a": 0.08, "b": 0.2}
    system = small_system(glycolysis, "xy", start)
    steady = cw.continue_branch(
        cw.Equilibrium(system, start, "b"), [0.2, 1.7], range=(0.05, 1.2), marks={"max_re": [-0.2]}
    )
    curve = cw.continue_locus(system, steady, "UZ1", {"b": (0.05, 1.2), "a": (0.01, 0.2)})
    # Each point is solved for to rounding, of numbers of order 1; the other eigenvalue is 0.12 away.
    np.testing.assert_allclose(curve["re_1"], -0.2, atol=1e-12)
    assert "Reached the end of the range, b = 0.05" in curve.outcome.message


PLUGIN = """
from contwalk.system import Mode, Parameter, State, System

def field(t, x, p, dx):
    dx[0] = {field}

SYSTEM = System(
    "leaving",
    states=(State("x"),),
    parameters=(Parameter("a", 0.0), Parameter("b", {b})),
    modes=(Mode("only", field),),
)
"""
RUN = """
system: ./leaving.py
start: {{state: {{x: {x}}}}}
continue: {{parameter: a, range: {first}}}
engine: {{max_step: 0.4, max_share: 0.2}}
loci: {{with: b, range: {second}, of: [LP]}}
output: whole.h5
"""


def computed(place: Path, output: str, *changes: str, **options: bool) -> list[Branch]:
    read = cw.read_run_file(place / "run.yaml", changes, str(place / output))
    with cw.open_database(cw.run(read, **options).path) as db:
        return db.branches()


@pytest.mark.long
def test_both_folds_of_a_study_have_one_curve(tmp_path) -> None:
    (tmp_path / "leaving.py").write_text(PLUGIN.format(field="p.a**2 + p.b**2 - 1.0 + x[0] ** 2", b=0.3))
    (tmp_path / "run.yaml").write_text(RUN.format(x=-0.95, first=[-2.0, 2.0], second=[-2.0, 0.8]))
    first, second = computed(tmp_path, "whole.h5")
    assert len(labelled(first, "LP")) == 2
    assert (second.info.problem, second.outcome.reason) == ("locus", "closed")


def test_a_curve_that_was_cut_where_it_leaves_goes_on_to_the_last_bit(tmp_path) -> None:
    (tmp_path / "leaving.py").write_text(PLUGIN.format(field="p.a - p.b**3 + p.b - x[0] ** 2", b=0.4))
    (tmp_path / "run.yaml").write_text(RUN.format(x=0.58, first=[-0.5, 0.3], second=[-1.05, 1.05]))
    whole = computed(tmp_path, "whole.h5")[1]
    (gap,) = whole.gaps()
    ahead = np.sign(whole["s"][gap])
    before = int(
        np.sum((whole["s"] * ahead >= 0.0) & (np.abs(whole["s"]) <= np.abs(whole["s"][[gap, gap + 1]]).min()))
    )
    computed(tmp_path, "cut.h5", f"continue.max_points={before}")
    again = computed(tmp_path, "cut.h5", resume=True)[1]
    for column in whole.points.dtype.names or ():
        if column != "seconds":
            np.testing.assert_array_equal(whole.points[column], again.points[column], err_msg=column)


@pytest.mark.long
def test_a_curve_of_orbits_comes_back() -> None:
    """Henon's folds at alpha = -(1 + beta)^2 / 4; LPPD at its turn lies outside, and is not told."""
    x = henon_fixed_point(0.5, 0.3)
    branch = branch_of(henon(), "alpha", (-0.5, 0.6), [x, x], {"alpha": 0.5, "beta": 0.3})
    ranges = {"alpha": (-0.5, -0.05), "beta": (-3.0, 0.4)}
    curve = cw.continue_locus(henon(), branch, "LP1", ranges, max_step=0.4, max_share=0.1)
    assert len(curve.gaps()) == 1
    assert curve["alpha"].max() == -0.05
    assert largest(curve["alpha"] + (1.0 + curve["beta"]) ** 2 / 4.0) < 1e-6
    assert curve["beta"].min() < -2.0
    assert {p.label for p in curve.special_points} == {"EP"}
