"""All curves of a study of maps as machines, with the normal forms of their resonances.

Henon's map preserves areas at beta = 1, where all its resonances are: their normal forms degenerate as told.
It is written in beta - 1, which is zero to rounding on the curve of tori that both R1 and R2 lead to.
"""

from __future__ import annotations

import pytest
from hybrid_runs import branch_of
from loci_of_orbits import FINE, henon_fixed_point, labels, map_as_machine, map_plugin, studied
from small_systems import labelled

import contwalk as cw

pytestmark = pytest.mark.slow

IMAGES = ("x[1]", "p.alpha - (1.0 + p.loss) * x[0] - x[1] ** 2")
PLUGIN = map_plugin("henon", IMAGES, {"alpha": 0.5, "loss": -0.7})
X = henon_fixed_point(0.5, 0.3)
RUN = f"""
system: ./henon.py
accuracy: 1e-10
start: {{simulate: {{state: {{x: {X}, y: {X}}}, until: 0}}}}
continue: {{parameter: alpha, range: [-1.5, 3.5]}}
engine: {{max_share: 0.03125}}
loci: {{with: loss, range: [-2.5, 0.8], of: all, follow: all}}
diagram: none
output: henon.h5
"""


@pytest.fixture(scope="module")
def curves(tmp_path_factory) -> dict[str, cw.branch.Branch]:
    _, branches, _ = studied(tmp_path_factory.mktemp("maps"), "henon", PLUGIN, RUN)
    loci = [b for b in branches if b.info.problem == "locus"]
    assert len({b.info.settings["of"] for b in loci}) == len(loci)  # none is followed twice
    return {b.info.settings["of"]: b for b in loci}


def test_each_point_is_found_on_both_of_its_curves_and_no_other(curves) -> None:
    """Right at loss = -2 the curves of folds and doublings touch, where alpha turns on both."""
    assert {of: labels(curve) for of, curve in curves.items()} == {
        "LP": ["LPPD", "R1"],
        "PD": ["LPPD", "R2"],
        "NS": ["R1", "R2", "R3", "R4"],
    }


def test_normal_forms_where_areas_are_preserved(curves) -> None:
    forms = {p.label: p.coefficients for p in curves["NS"].special_points}
    assert forms["R1"]["b"] == pytest.approx(2.0 * forms["R1"]["a"], rel=1e-9)
    assert forms["R1"]["s"] == 0.0
    assert forms["R2"]["d"] == pytest.approx(-3.0 * forms["R2"]["c"], rel=1e-9)
    assert forms["R3"]["a"] == pytest.approx(0.0, abs=1e-9)
    assert (forms["R4"]["A_real"], forms["R4"]["A_imag"]) == pytest.approx((0.0, -1.0), abs=1e-9)


def test_normal_forms_are_the_same_from_both_curves(curves) -> None:
    for label, one, other in (("R1", "LP", "NS"), ("R2", "PD", "NS"), ("LPPD", "LP", "PD")):
        (a,), (b,) = (labelled(curves[of], label) for of in (one, other))
        assert len(a.coefficients) > 2
        for name, value in a.coefficients.items():
            if name != "convention":
                assert b.coefficients[name] == pytest.approx(value, rel=1e-7, abs=1e-9)


@pytest.mark.long
def test_a_cusp_at_zero_is_known_no_better_than_the_multiplier_one() -> None:
    system = map_as_machine(
        lambda x, p: (x[0] + p.mu + p.nu * x[0] - x[0] ** 3,), "x", {"mu": 0.0, "nu": 0.3}
    )
    branch = branch_of(system, "mu", (-0.5, 0.5), [0.3**0.5])
    curve = cw.continue_locus(system, branch, "LP1", {"mu": (-0.5, 0.5), "nu": (-0.1, 0.6)}, **FINE)
    (point,) = labelled(curve, "CPC")
    assert abs(point.parameters["nu"]) <= point.errors["nu"]
    assert 2.0**-53 <= point.errors["nu"] < 1e-14
