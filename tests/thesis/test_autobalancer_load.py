"""Figs 8, 9 and 13: all equilibria over the load, up to and beyond what can be balanced."""

import math

import numpy as np
import pytest
from autobalancer_figures import (
    EQUILIBRIA,
    LOCATED,
    assert_digits,
    assert_located,
    bifurcations,
    counts,
    distinct,
    figure_run,
    points_at,
    start_named,
)

pytestmark = pytest.mark.thesis

FIG_8, FIG_9 = EQUILIBRIA["load_fig8"], EQUILIBRIA["load_fig9"]
STUDIES = [("autobalancer_load", FIG_8), ("autobalancer_load_unstable", FIG_9)]


@pytest.mark.parametrize(("name", "study"), STUDIES)
def test_special_points_are_those_of_the_reference_and_no_others(name, study):
    expected = sorted((e["label"], float(e["m"])) for e in study["events"])
    found = sorted(distinct(figure_run(name), "m"))
    assert [label for label, _ in found] == [label for label, _ in expected]
    assert [at for _, at in found] == pytest.approx([at for _, at in expected], rel=LOCATED)


@pytest.mark.parametrize(("name", "study"), STUDIES)
def test_special_points_are_located_to_their_own_error(name, study):
    for event in study["events"]:
        for _, point in points_at(figure_run(name), event["label"], "m", event["m"]):
            assert_located(point, "m", event["m"])


@pytest.mark.parametrize(("name", "study"), STUDIES)
def test_full_load_is_a_supercritical_pitchfork_of_exchanged_masses(name, study):
    (event,) = [e for e in study["events"] if e["label"] == "BP"]
    ((_, full),) = points_at(figure_run(name), "BP", "m", event["m"])
    assert (full.kind, full.criticality) == ("pitchfork", "supercritical")
    assert full.note is not None
    assert "exchange_1_2" in full.note


def test_overloaded_autobalancer_works_as_well_as_possible():
    # Beyond full load type 2 (both masses opposite the unbalance) is the only stable equilibrium.
    overloaded = [(b, b["m"] > 0.0201) for b in figure_run("autobalancer_load")]
    stable = [math.cos(x) for b, rows in overloaded for x in b["beta1"][rows & (b["stable"] == 1)]]
    assert stable
    assert max(stable) < 0.0
    for branch, rows in overloaded:
        assert set(branch["unstable"][rows & ~branch["special"]]) <= {0, 1, 2}


def test_hopf_points_of_fig_9():
    events = [e for e in FIG_9["events"] if e["label"] == "HB"]
    for event, unstable in zip(events, [(0, 2), (2, 0)], strict=True):
        for branch, point in points_at(figure_run("autobalancer_load_unstable"), "HB", "m", event["m"]):
            assert_digits(point.coefficients["omega"], event["imag"])
            assert_digits(point.coefficients["l1"], event["l1"])
            assert point.criticality == "supercritical"
            assert counts(branch, point) == unstable


@pytest.mark.parametrize(("name", "study"), STUDIES)
def test_folds_give_birth_to_types_2_and_3(name, study):
    ((_, fold),) = [(b, p) for b, p in bifurcations(figure_run(name)) if p.label == "LP"]
    assert {fold.unstable_before, fold.unstable_after} == {1, 2}


@pytest.mark.parametrize(("name", "study"), STUDIES)
def test_local_maximum_of_the_leading_real_part(name, study):
    expected = study["local_maximum_of_max_re"]
    found = [
        (p.parameters["m"], float(b["max_re"][p.index]), p.error)
        for b in start_named(figure_run(name), "balanced")
        for p in b.special_points
        if p.label == "UZ"
    ]
    assert found
    for m, value, error in found:
        assert m == pytest.approx(float(expected["m"]), abs=1e-8)  # as exact as the reference says it is
        assert_digits(value, expected["value"])
        assert error is not None
        assert error < 1e-9 * m


def test_kinks_of_the_leading_real_part_are_not_special_points():
    (balanced,) = start_named(figure_run("autobalancer_load"), "balanced")
    kinks = [float(m) for m in FIG_8["double_eigenvalue_kinks"]]
    for point in balanced.special_points:
        assert min(abs(point.parameters["m"] - kink) for kink in kinks) > 1e-4
    # They are there: on either side the leading eigenvalue is real, or one of a complex pair.
    for kink in kinks:
        rows = np.argsort(np.abs(balanced["m"] - kink))[:8]
        leading = balanced["spectrum"][rows, 0].imag != 0.0
        assert leading.any()
        assert not leading.all()


@pytest.mark.parametrize("kink", FIG_8["double_eigenvalue_kinks"], ids=str)
def test_kinks_lie_where_the_reference_has_them(kink):
    # Two marks 1e-6 of the load apart must fall on either side of the change from real to complex.
    at = float(kink)
    values = [at * (1 - 1e-6) - 1e-8, at * (1 + 1e-6) + 1e-8]
    (balanced,) = start_named(figure_run("autobalancer_load", f"mark={{m: {values}}}"), "balanced")
    marks = [p for p in balanced.special_points if p.label == "UZ"]
    sides = {m: {p.spectrum[0].imag != 0.0 for p in marks if p.parameters["m"] == m} for m in values}
    assert all(len(side) == 1 for side in sides.values()), sides
    assert sides[values[0]] != sides[values[1]]


def test_heavier_masses_are_more_stable_at_every_load():
    light, heavy = figure_run("autobalancer_heavy_masses")
    assert light.info.parameters["m1"] * light.info.parameters["l1"] == pytest.approx(
        heavy.info.parameters["m1"] * heavy.info.parameters["l1"], rel=1e-15
    )
    # The range ends at full load, where types 1 and 2 meet.
    assert distinct((light, heavy), "m") == [("BP", 0.02)]
    loads = np.linspace(0.001, 0.0198, 50)
    assert np.all(
        np.interp(loads, heavy["m"], heavy["max_re"]) < np.interp(loads, light["m"], light["max_re"])
    )
