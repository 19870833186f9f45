"""Figs 6 and 7: all equilibria over the speed of rotation."""

import math

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

FIG_6, FIG_7 = EQUILIBRIA["omega_c0.7"], EQUILIBRIA["omega_c0.1"]
LIGHT = "autobalancer_omega_light_damping"
STUDIES = [("autobalancer_omega", FIG_6), pytest.param(LIGHT, FIG_7, marks=pytest.mark.long)]
SPEEDS = [float(row[0]) for row in FIG_6["max_re"]]
MARKED = (f"mark={{omega: {SPEEDS}}}", "continue.range=[0.2, 6.5]")


@pytest.mark.slow
@pytest.mark.parametrize(("name", "study"), STUDIES)
def test_special_points_are_those_of_the_reference_and_no_others(name, study):
    expected = sorted((e["label"], float(e["omega"])) for e in study["events"])
    found = sorted(distinct(figure_run(name), "omega"))
    assert [label for label, _ in found] == [label for label, _ in expected]
    assert [at for _, at in found] == pytest.approx([at for _, at in expected], rel=LOCATED)


@pytest.mark.parametrize(("name", "study"), STUDIES)
def test_special_points_are_located_to_their_own_error(name, study):
    for event in study["events"]:
        for _, point in points_at(figure_run(name), event["label"], "omega", event["omega"]):
            assert_located(point, "omega", event["omega"])


@pytest.mark.parametrize(("name", "study"), STUDIES)
def test_hopf_points_have_the_frequency_and_normal_form_of_the_reference(name, study):
    events = [e for e in study["events"] if e["label"] == "HB"]
    assert events
    for event in events:
        for branch, point in points_at(figure_run(name), "HB", "omega", event["omega"]):
            assert_digits(point.coefficients["omega"], event["imag"])
            assert point.criticality == "supercritical"
            if "l1" in event:
                assert_digits(point.coefficients["l1"], event["l1"])
            if "unstable" in event:
                assert counts(branch, point) == tuple(int(n) for n in event["unstable"])


@pytest.mark.parametrize(("name", "study"), STUDIES)
def test_balanced_becomes_stable_at_its_hopf_point_and_stays_so(name, study):
    (balanced,) = start_named(figure_run(name), "balanced")
    (border,) = [p.parameters["omega"] for p in balanced.special_points if p.label == "HB"]
    regular = ~balanced["special"]
    below, above = balanced["omega"] < border, balanced["omega"] > border
    assert set(balanced["unstable"][regular & below]) == {2}
    assert set(balanced["unstable"][regular & above]) == {0}
    # The thesis's point: lower damping moves the border away from the natural frequency, not towards it.
    assert border > float(EQUILIBRIA["natural_frequency"])


def border_of(name: str) -> float:
    return float(figure_run(name)[0].special("HB1").parameters["omega"])


def test_natural_frequency_is_not_the_border_of_stability():
    (balanced,) = start_named(figure_run("autobalancer_omega"), "balanced")
    p = balanced.info.parameters
    natural = math.sqrt(p["k"] / (p["M"] + p["m"] + 2 * p["m1"]))
    assert_digits(natural, EQUILIBRIA["natural_frequency"])
    assert natural < border_of("autobalancer_omega")


@pytest.mark.long
def test_less_damping_moves_the_border_away():
    assert border_of("autobalancer_omega") < border_of(LIGHT)


def test_unstable_counts_of_types_2_to_4():
    branches = figure_run("autobalancer_omega")
    for branch in start_named(branches, "opposite"):
        assert set(branch["unstable"]) == {1}
    for branch in start_named(branches, "together"):
        (fold,) = [p for p in branch.special_points if p.label == "LP"]
        slow = fold.parameters["omega"] < 1.0
        # Type 3 is stable below the gap and has two unstable eigenvalues above it; type 2 has one everywhere.
        assert {fold.unstable_before, fold.unstable_after} == ({0, 1} if slow else {2, 1})
        regular = ~branch["special"]
        assert set(branch["unstable"][regular]) == {fold.unstable_before, fold.unstable_after}


def test_light_damping_folds_have_one_and_three_unstable():
    branches = figure_run("autobalancer_omega_light_damping")
    folds = {p.parameters["omega"]: p for _, p in bifurcations(branches) if p.label == "LP"}
    low, high = (folds[at] for at in sorted(folds))
    assert {low.unstable_before, low.unstable_after} == {0, 1}
    # The pair that HB1 of type 2 sets free at 1.160 is still unstable at the fold.
    assert {high.unstable_before, high.unstable_after} == {2, 3}


@pytest.mark.parametrize("row", FIG_6["max_re"], ids=lambda row: f"omega={row[0]}")
def test_leading_real_part_of_all_four_types(row):
    speed, type1, type2, type3, type4 = row
    branches = figure_run("autobalancer_omega", *MARKED)

    def marked(name):
        found = [
            (math.cos(p.state["beta1"]), float(b["max_re"][p.index]))
            for b in start_named(branches, name)
            for p in b.special_points
            if p.label == "UZ" and p.parameters["omega"] == float(speed)
        ]
        # Type 2 is away from the unbalance (cos beta < 0), type 3 near it.
        return [value for _, value in sorted(found)]

    def expected(*values):
        # 14 to 17 digits are given; 1e-12 allows for eigenvalues in double precision.
        return pytest.approx([float(v) for v in values if v is not None], rel=1e-12, abs=1e-15)

    assert marked("balanced") == expected(type1)
    assert marked("together") == expected(type2, type3)
    assert marked("opposite") == expected(type4)
