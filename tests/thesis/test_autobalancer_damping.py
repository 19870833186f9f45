"""Figs 10 to 12 and 15: borders of stability over external damping c, drag delta and load m."""

import pytest
from autobalancer_figures import (
    EQUILIBRIA,
    REFERENCE,
    assert_digits,
    assert_located,
    bifurcations,
    figure_run,
)
from whirl_determinant import exact_hopf

import contwalk as cw

pytestmark = [pytest.mark.thesis, pytest.mark.slow]

FIG_15 = EQUILIBRIA["fig15_leading_pair"]
CONTOURS = [(m, c, points) for m, rows in EQUILIBRIA["zero_contours_fig10"].items() for c, points in rows]


@pytest.fixture(scope="module")
def system():
    return cw.load_system("autobalancer", {"masses": 2})


def assert_exact(point, free, n=2, held=None):
    """The Hopf condition, derived by hand, holds at the point in 40-digit arithmetic."""
    at, frequency = exact_hopf(point.parameters, free, point.coefficients["omega"], n, held)
    # Half a unit of the last bit: the point itself is stored as a double.
    assert abs(float(at - point.parameters[free])) <= point.error + abs(float(at)) * 1.2e-16
    assert point.coefficients["omega"] == pytest.approx(float(frequency), rel=1e-12)


@pytest.mark.drawn(12)
@pytest.mark.parametrize(("load", "damping", "expected"), CONTOURS, ids=lambda v: str(v)[:5])
def test_zero_contours_of_fig_10(system, load, damping, expected):
    parameters = system.defaults() | {"m": float(load), "c": float(damping), "delta": 0.008}
    problem = cw.Equilibrium(system, parameters, "delta")
    branch = cw.continue_branch(problem, "balanced", (1e-7, 0.01), "backward")
    found = [point for _, point in bifurcations([branch])]
    assert [point.label for point in found] == ["HB"] * len(expected)
    for point, (drag, frequency) in zip(found, expected, strict=True):
        assert_located(point, "delta", drag)
        assert_digits(point.coefficients["omega"], frequency)


@pytest.mark.parametrize("drag", ["0.01", "0.0065", "0.0045", "0.003"])
def test_leading_pair_of_fig_15(drag):
    (branch,) = figure_run("autobalancer_drag")
    real, imaginary = FIG_15[f"delta={drag}"]
    (spectrum,) = {p.spectrum[0] for p in branch.special_points if p.parameters["delta"] == float(drag)} or {
        complex(branch["spectrum"][branch["delta"] == float(drag)][0, 0])
    }
    assert spectrum.real == pytest.approx(float(real), rel=1e-12)
    assert abs(spectrum.imag) == pytest.approx(float(imaginary), rel=1e-12)


def test_one_pair_crosses_in_fig_15():
    (branch,) = figure_run("autobalancer_drag")
    ((_, hopf),) = bifurcations([branch])
    assert hopf.label == "HB"
    assert hopf.criticality == "supercritical"
    assert {hopf.unstable_before, hopf.unstable_after} == {0, 2}
    cascade = REFERENCE["cascade_start"]
    assert_located(hopf, "delta", cascade["HB"])
    assert_digits(hopf.coefficients["omega"], cascade["omega0"])
    assert_digits(hopf.coefficients["l1"], cascade["l1"])
    assert_exact(hopf, "delta")


@pytest.mark.drawn(2)
@pytest.mark.parametrize(
    ("name", "free", "sweep"),
    [
        ("autobalancer_damping_map", "c", "sweep.delta={from: 0.001, to: 0.005, count: 3}"),
        ("autobalancer_border", "c", "sweep.delta={from: 0.002, to: 0.014, count: 3}"),
        ("autobalancer_load_drag_map", "m", "sweep.delta={from: 0.0002, to: 0.0011, count: 3}"),
    ],
)
def test_borders_of_the_maps_hold_in_40_digits(name, free, sweep):
    branches = figure_run(name, sweep)
    points = [point for _, point in bifurcations(branches)]
    assert len(points) >= 2
    for point in points:
        assert point.label == "HB"
        assert point.status == "located"
        assert_exact(point, free)


@pytest.mark.parametrize(
    "figure",
    ["autobalancer_border_chart", pytest.param("autobalancer_damping_chart", marks=pytest.mark.long)],
)
def test_the_borders_of_figs_10_and_12_as_curves_of_hopf_points(figure):
    (border,) = (b for b in figure_run(figure) if b.info.settings.get("of") == "HB")
    assert (border["c"].min(), border["c"].max()) == (0.1, 6.0)
    known = border.special_points[0].parameters
    for row in range(0, len(border["c"]), 12):
        there = {**known, "c": border["c"][row], "delta": border["delta"][row]}
        at, frequency = exact_hopf(there, "delta", border["frequency_squared"][row] ** 0.5)
        assert border["delta"][row] == pytest.approx(float(at), rel=1e-12)
        assert border["frequency_squared"][row] == pytest.approx(float(frequency) ** 2, rel=1e-11)


@pytest.mark.drawn(1)
@pytest.mark.parametrize("damping", [0.5, 2.0, 6.0])
def test_heavier_masses_need_more_drag(system, damping):
    # Fig. 12: at every c the border lies the higher the heavier the masses, their moment m1 l1 the same.
    borders = []
    for mass in (0.01, 0.02, 0.05):
        heavy = {"m1": mass, "l1": 0.01 / mass, "J": 0.4 * mass, "m": 0.014, "c": damping, "delta": 0.05}
        problem = cw.Equilibrium(system, system.defaults() | heavy, "delta")
        branch = cw.continue_branch(problem, "balanced", (1e-6, 0.06), "backward")
        ((_, hopf),) = bifurcations([branch])
        assert_exact(hopf, "delta")
        borders.append(hopf.parameters["delta"])
    assert borders == sorted(borders)


@pytest.mark.parametrize(
    ("load", "damping", "criticality"),
    [(0.014, 2.0, "supercritical"), (0.019, 2.0, "subcritical")],
)
def test_hopf_bifurcations_are_not_supercritical_everywhere(system, load, damping, criticality):
    heavy = {"m1": 0.02, "l1": 0.5, "J": 0.008, "m": load, "c": damping, "delta": 0.01}
    problem = cw.Equilibrium(system, system.defaults() | heavy, "delta")
    branch = cw.continue_branch(problem, "balanced", (1e-5, 0.02), "backward")
    ((_, hopf),) = bifurcations([branch])
    assert hopf.criticality == criticality
