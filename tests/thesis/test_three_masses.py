"""Figs 23 to 25: three masses, a family of balanced states and four other equilibria."""

import math

import mpmath
import pytest
from autobalancer_figures import (
    LOCATED,
    THREE_MASSES,
    assert_located,
    bifurcations,
    counts,
    distinct,
    figure_run,
    points_at,
    start_named,
)
from whirl_determinant import exact_hopf, neutral_directions

import contwalk as cw
from contwalk.continuation.settings import Settings
from contwalk.diagram.opening import Opening
from contwalk.studies.opening import opened

pytestmark = pytest.mark.thesis

LEADING = [
    (label, delta, value)
    for label, values in THREE_MASSES["max_re_without_the_neutral_zero"].items()
    for delta, value in values.items()
]
REGIONS = THREE_MASSES["unstable_regions_delta0.0007"]
FIG_24 = THREE_MASSES["fig24"]


@pytest.fixture(scope="module")
def system():
    return cw.load_system("autobalancer", {"masses": 3})


def continued(system, start, load, range, delta=0.005, angle=2.5, free="m", **more):
    parameters = system.defaults() | {"m": load, "delta": delta, "angle3": angle}
    return cw.continue_branch(cw.Equilibrium(system, parameters, free), start, range, **more)


def pinned(system, parameters, range):
    """The problem with the neutral directions held that are neutral at its balanced state."""
    state = system.named_states("balanced", parameters)[0]
    opening = opened(system, parameters, "m", state, Settings(range=range))
    assert isinstance(opening, Opening)
    return opening.problem


@pytest.mark.drawn(4)
@pytest.mark.parametrize(("label", "delta", "value"), LEADING, ids=lambda v: str(v)[:16])
def test_leading_real_part_without_the_neutral_zero(system, label, delta, value):
    load, angle = (part.split("=")[1] for part in label.split(","))
    m, angle = float(load), math.pi if angle == "pi" else float(angle)
    drag = float(delta.split("=")[1])
    branch = continued(system, "balanced", 0.95 * m, (0.9 * m, 1.05 * m), drag, angle, marks={"m": [m]})
    (mark,) = [p for p in branch.special_points if p.label == "UZ"]
    assert float(branch["max_re"][mark.index]) == pytest.approx(float(value), rel=LOCATED, abs=1e-12)
    assert branch.info.spectrum == 9  # ten states, less the neutral direction


def test_unstable_regions_at_angle_pi(system):
    expected = [REGIONS["region1_m_at_beta3_pi"], *REGIONS["region3_m_at_beta3_pi"]]
    branch = continued(system, "balanced", 0.005, (0.0005, 0.0295), 0.0007, math.pi)
    hopfs = [p for p in branch.special_points if p.label == "HB"]
    assert [p.label for p in branch.special_points] == ["EP", "HB", "BP", "HB", "HB", "EP"]
    for point, m, unstable in zip(hopfs, expected, [(2, 0), (0, 2), (2, 0)], strict=True):
        assert_located(point, "m", m)
        assert (point.unstable_before, point.unstable_after) == unstable
        at, _ = exact_hopf(point.parameters, "m", point.coefficients["omega"], n=3)
        assert abs(float(at - point.parameters["m"])) <= point.error + float(at) * 1.2e-16


def test_hopf_bifurcation_into_region_3_is_subcritical_at_its_lower_border(system):
    # With mass 3 held: along the family itself l1 says nothing.
    branch = continued(system, "balanced", 0.017, (0.0155, 0.0235), 0.0007, math.pi)
    lower, upper = (point for _, point in bifurcations([branch]))
    assert [lower.criticality, upper.criticality] == ["subcritical", "supercritical"]


def test_region_1_is_unstable_for_all_angles(system):
    # The border is lowest where |sum exp(2 i beta)| is largest: mass 3 at the unbalance, or its images.
    lowest = float(REGIONS["region1_m_for_all_beta3"])
    branch = continued(system, "balanced", 0.005, (0.0005, 0.009), 0.0007, 0.0)
    (hopf,) = [p for p in branch.special_points if p.label == "HB"]
    assert_located(hopf, "m", REGIONS["region1_m_for_all_beta3"])
    below = continued(system, "balanced", lowest * (1 - 1e-6), (0.0, math.pi), 0.0007, free="angle3")
    assert set(below["unstable"]) == {2}
    above = continued(system, "balanced", lowest * (1 + 1e-3), (0.0, math.pi), 0.0007, free="angle3")
    assert 0 in set(above["unstable"])


@pytest.mark.long
def test_regions_of_fig_25_inside_curves_of_hopf_points():
    """Regions 2 and 3 are images of one another: the same loads, each closed; 1 is below a curve."""
    curves = [b for b in figure_run("three_masses_stability_chart") if b.info.settings.get("of") == "HB"]
    small, *closed = sorted(curves, key=lambda b: b["m"].min())
    assert small["m"].min() == pytest.approx(float(REGIONS["region1_m_for_all_beta3"]), rel=1e-9)
    ends = {p.parameters["angle3"]: p.parameters["m"] for p in small.special_points if p.label == "EP"}
    assert ends[math.pi] == pytest.approx(float(REGIONS["region1_m_at_beta3_pi"]), rel=1e-9)
    assert [b.outcome.reason for b in closed] == ["closed", "closed"]
    for curve in closed:
        # A closed curve has no point right at its extremes.
        extremes = curve["m"].min(), curve["m"].max()
        assert extremes == pytest.approx([float(m) for m in REGIONS["region3_m_at_beta3_pi"]], rel=1e-3)
    bautin = [p for b in closed for p in b.special_points if p.label == "GH"]
    assert [p.status for p in bautin] == ["located"] * 4


def test_three_regions_of_fig_25():
    rows = figure_run("three_masses_stability_map", "sweep.m={from: 0.0025, to: 0.0205, count: 3}")
    assert set(rows[0]["unstable"]) == {2}  # m = 0.0025, region 1
    assert set(rows[1]["unstable"]) == {0}  # m = 0.0115
    angles = [at for _, at in distinct([rows[2]], "angle3")]
    hopfs = [p for _, p in bifurcations([rows[2]]) if p.label == "HB"]
    borders = sorted({round(p.parameters["angle3"], 9): p for p in hopfs}.items())
    assert len(angles) >= len(borders) == 3  # regions 2 and 3 at m = 0.0205; 3 is cut off at pi
    assert borders[0][0] < math.radians(120.0) < borders[1][0] < borders[2][0] < math.pi
    for _, point in borders:
        assert point.status == "located"
        at, frequency = exact_hopf(point.parameters, "angle3", point.coefficients["omega"], n=3)
        assert abs(float(at - point.parameters["angle3"])) <= point.error + float(at) * 1.2e-16
        assert point.coefficients["omega"] == pytest.approx(float(frequency), rel=1e-12)


@pytest.mark.long
def test_map_of_fig_23_is_stable_everywhere():
    rows = figure_run("three_masses_damped_map", "sweep.m={from: 0.0025, to: 0.0205, count: 3}")
    for branch in rows:
        assert set(branch["unstable"]) == {0}
        assert branch.outcome.status == "complete"


@pytest.mark.slow
def test_loads_from_which_types_2_to_5_exist():
    branches = figure_run("three_masses_load")
    for name, key in (("together", "types_2_5_from_m"), ("opposite", "types_3_4_from_m")):
        for branch in start_named(branches, name):
            for point in branch.special_points:
                if point.label == "LP":
                    assert_located(point, "m", FIG_24[key])
        (fold,) = {round(p.parameters["m"], 12) for _, p in points_at(branches, "LP", "m", FIG_24[key])}
        assert fold == pytest.approx(float(FIG_24[key]), rel=LOCATED)


def test_types_2_to_5_are_unstable_where_the_load_can_be_balanced():
    for name in ("together", "opposite"):
        for branch in start_named(figure_run("three_masses_load"), name):
            rows = (branch["m"] < 0.0299) & ~branch["special"]
            assert branch["unstable"][rows].min(initial=1) > 0


def test_type_5_alone_is_stable_when_overloaded():
    branches = figure_run("three_masses_load")
    overloaded = [
        (math.cos(beta), bool(stable))
        for branch in branches
        for m, beta, stable in zip(branch["m"], branch["beta1"], branch["stable"], strict=True)
        if m > 0.0301
    ]
    assert any(stable for _, stable in overloaded)
    assert all(cosine < 0.0 for cosine, stable in overloaded if stable)


@pytest.mark.drawn(1)
@pytest.mark.parametrize("max_step", [0.02, 0.04, 0.072, 0.1])
def test_full_load_is_a_branch_point_where_type_5_becomes_stable(system, max_step):
    # Two equal eigenvalues pass zero together (the symmetry of three masses), and the walk goes on.
    branch = continued(system, "together", 0.0225, (0.02, 0.035), max_step=max_step)
    assert branch.outcome.status == "complete", branch.outcome.message
    ((_, point),) = bifurcations([branch])
    assert (point.label, point.status) == ("BP", "located")
    assert point.parameters["m"] == pytest.approx(float(FIG_24["type5_stable_above_m"]), rel=LOCATED)
    assert counts(branch, point) == (2, 0)
    with mpmath.workdps(50):
        assert neutral_directions([+mpmath.pi] * 3, point.parameters) == 2


def test_balanced_family_with_mass_3_held_ends_in_a_fold(system):
    # Equality in (48): masses 1 and 2 meet, the load turns, and no eigenvalue passes zero.
    branch = continued(system, "balanced", 0.01, (0.005, 0.03))
    with mpmath.workdps(40):
        cosine = mpmath.cos(mpmath.mpf(2.5))
        limit = mpmath.mpf(0.01) * (mpmath.sqrt(cosine**2 + 3) - cosine)
    ((_, fold),) = bifurcations([branch])
    assert fold.label == "LP"
    assert fold.parameters["m"] == pytest.approx(float(limit), rel=1e-12)
    assert (fold.unstable_before, fold.unstable_after) == (0, 0)
    assert fold.state["beta1"] == pytest.approx(fold.state["beta2"], abs=1e-7)  # the square root of rounding


@pytest.mark.drawn(1)
@pytest.mark.parametrize("max_step", [0.02, 0.04, 0.06, 0.1])
def test_branch_point_of_types_3_and_4_with_the_balanced_family(system, max_step):
    # At m e = m1 l1 masses at pi, pi, 0 are balanced: one real eigenvalue passes zero upward, one downward.
    branch = continued(system, "opposite", 0.013, (0.005, 0.016), max_step=max_step)
    ((_, point),) = bifurcations([branch])
    assert (point.label, point.status) == ("BP", "located")
    assert point.parameters["m"] == pytest.approx(0.01, rel=LOCATED)
    assert counts(branch, point) == (1, 1)
    with mpmath.workdps(50):
        assert neutral_directions([+mpmath.pi, +mpmath.pi, mpmath.mpf(0)], point.parameters) == 2


def test_branch_begins_exactly_at_that_branch_point(system):
    # The default load is just there.
    branch = continued(system, "opposite", 0.01, (0.008, 0.012))
    assert branch["m"].min() == 0.008
    assert branch["m"].max() == 0.012


def test_member_with_mass_3_at_pi_crosses_another_family(system):
    # At m e = m1 l1 and beta3 = pi masses 1 and 2 may be anywhere opposite each other.
    branch = continued(system, "balanced", 0.005, (0.0005, 0.0295), 0.005, math.pi)
    ((_, point),) = bifurcations([branch])
    assert point.label == "BP"
    assert point.parameters["m"] == pytest.approx(0.01, rel=LOCATED)
    assert point.kind != "transcritical"  # the other branch is vertical: neither it nor a pitchfork
    assert math.cos(point.state["beta1"] - point.state["beta2"]) == pytest.approx(-1.0, abs=1e-12)


def test_circle_of_balanced_states_closes(system):
    # The branch that crosses there is a closed circle: beta1 and beta2 go round, the load stays.
    parameters = system.defaults() | {"m": 0.005, "angle3": math.pi}
    range = (0.0005, 0.0295)
    problem = pinned(system, parameters, range)
    parent = cw.continue_branch(problem, "balanced", range)
    circle = cw.switch_branch(problem, parent, "BP1", range)
    # Where all masses are in line the load is only determined to the square root of rounding.
    assert circle["m"] == pytest.approx(0.01, rel=1e-8)
    assert circle.outcome.reason == "closed", circle.outcome.message
