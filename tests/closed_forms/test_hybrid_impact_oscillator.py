"""The impact oscillator: grazing of the motion without impacts, and the motion with one impact in a period.

Without impacts the displacement is a cosine of amplitude force / |(1 - omega^2, 2 zeta omega)|. With one
impact in the time T the free motion is that cosine w and a decaying part, which E = exp(A T) carries from
just after an impact, (gap, v) - w, to just before the next one, (gap, -v / restitution) - w. So w is
linear in v, and its amplitude gives a quadratic equation for v: two motions, which meet in a fold.
"""

from __future__ import annotations

import math
from functools import cache

import mpmath
import numpy as np
import pytest
from contwalk_systems.impact_oscillator import SYSTEM
from hybrid_invariants import check_hybrid_branch
from hybrid_runs import ACCURACY, branch_of, diagram
from one_impact import OneImpact, forced, parameters, stiffness
from orbit_systems import assert_met

from contwalk.branch import Branch, SpecialPoint

WALKED = 100.0 * ACCURACY
# omega, zeta and restitution. In the first four the impacting motion has a fold below the grazing; in the
# others it doubles its period.
IMPACTING = [
    (1.3, 0.1, 0.8),
    (1.3, 0.05, 0.5),
    (1.15, 0.1, 0.3),
    (0.5, 0.2, 0.6),
    (0.7, 0.1, 0.8),
    (2.2, 0.1, 0.8),
]
FOLDED = IMPACTING[:4]
DIGITS = 30


@cache
def study(omega: float, zeta: float, restitution: float) -> tuple[Branch, ...]:
    """From the motion without impacts through its grazing to the one with an impact."""
    p = parameters(omega, zeta, restitution)
    p.force = 0.7 * stiffness(p)
    return tuple(
        diagram(
            SYSTEM,
            "force",
            (0.2 * stiffness(p), 2.4 * stiffness(p)),
            forced(p, 0.0),
            vars(p),
            events={"GR": "switch"},
            max_points=200,
        )[:2]
    )


def only(branch: Branch, label: str) -> SpecialPoint:
    (point,) = [p for p in branch.special_points if p.label == label]
    return point


class TestWithoutImpacts:
    @pytest.mark.drawn
    @pytest.mark.parametrize("zeta", [0.01, 0.1, 0.5, 1.5])
    @pytest.mark.parametrize("omega", [0.1, 0.6, 1.0, 1.7, 4.0, 12.0])
    def test_stop_is_grazed_where_the_amplitude_is_the_gap(self, omega, zeta):
        """Over the force; strong damping and both sides of the resonance, and on it."""
        p = parameters(omega, zeta)
        p.force = 0.9 * stiffness(p)
        branch = branch_of(
            SYSTEM, "force", (0.85 * stiffness(p), 1.2 * stiffness(p)), forced(p, 0.0), vars(p)
        )
        assert branch.info.signature == ()
        assert branch.info.closure == "full"
        point = only(branch, "GR")
        assert_met(point, "force", stiffness(p))
        assert point.kind == "interior"
        assert point.period == pytest.approx(2.0 * math.pi / omega, rel=1e-14)
        at_top = math.atan2(2.0 * zeta * omega, 1.0 - omega**2) % (2.0 * math.pi) / omega
        seconds = float(point.note.split("touched ")[1].split(" s ")[0])
        # Ten digits are told; the top is flat, but found where the rate is zero.
        assert seconds == pytest.approx(at_top, abs=1e-8 * point.period)
        # A linear machine: multipliers are those of free motion.
        rates = np.roots([1.0, 2.0 * zeta, 1.0])
        expected = np.poly(np.exp(rates * point.period))
        np.testing.assert_allclose(np.poly(np.array(point.spectrum)), expected, rtol=0, atol=ACCURACY)
        assert (branch.outcome.status, branch.outcome.reason) == ("stopped", "grazing")
        assert branch["force"].max() == point.parameters["force"]
        assert branch["q_max"] == pytest.approx(branch["force"] / stiffness(p), rel=WALKED)

    @pytest.mark.drawn(1)
    @pytest.mark.parametrize(("zeta", "force"), [(0.1, 0.5), (0.05, 0.3), (0.2, 0.9)])
    def test_stop_is_grazed_on_both_sides_of_the_resonance(self, zeta, force):
        """Over the frequency: a quadratic equation for omega^2."""
        middle = 1.0 - 2.0 * zeta**2
        half = math.sqrt(middle**2 - (1.0 - force**2))
        low, high = math.sqrt(middle - half), math.sqrt(middle + half)
        p = parameters(0.5 * low, zeta, force=force)
        branch = branch_of(
            SYSTEM, "omega", (0.4 * low, 2.0 * high), forced(p, 0.0), vars(p), events={"GR": "ignore"}
        )
        assert branch.outcome.reason == "bound"
        first, second = [q for q in branch.special_points if q.label == "GR"]
        assert_met(first, "omega", low)
        assert_met(second, "omega", high)
        between = (branch["omega"] > low * (1.0 + 1e-9)) & (branch["omega"] < high * (1.0 - 1e-9))
        assert not np.any(branch["admissible"][between])
        outside = (branch["omega"] < low * (1.0 - 1e-9)) | (branch["omega"] > high * (1.0 + 1e-9))
        assert np.all(branch["admissible"][outside])
        assert between.sum() >= 3
        check_hybrid_branch(branch, SYSTEM)


@pytest.mark.parametrize("policy", ["stop", "ignore", "switch"])
def test_policies_at_an_interior_grazing(policy):
    p = parameters(1.3, 0.1)
    p.force = 0.7 * stiffness(p)
    span = (0.6 * stiffness(p), 1.4 * stiffness(p))
    first, *others = diagram(
        SYSTEM, "force", span, forced(p, 0.0), vars(p), events={"GR": policy}, direction="up"
    )
    point = only(first, "GR")
    assert_met(point, "force", stiffness(p))
    if policy == "ignore":
        assert (first.outcome.status, first.outcome.reason) == ("complete", "bound")
        assert first["force"].max() == span[1]
        assert np.array_equal(
            first["admissible"][~first["special"]],
            first["force"][~first["special"]] < point.parameters["force"],
        )
        assert others == []
        return
    assert first.outcome.reason == "grazing"
    assert first.outcome.status == ("stopped" if policy == "stop" else "complete")
    assert np.all(first["admissible"][~first["special"]])
    assert len(others) == (1 if policy == "switch" else 0)
    if policy == "switch":
        (impacting,) = others
        assert impacting.info.origin == "b1/GR1"
        assert impacting.info.parent == ("b1", point.s)
        assert impacting.info.signature == ("impact",)
        (born,) = impacting.points[impacting["s"] == 0.0]
        assert born["free"][0] == pytest.approx(point.parameters["force"], rel=ACCURACY)


@pytest.mark.parametrize("case", IMPACTING)
class TestOneImpact:
    @pytest.mark.drawn(2)
    def test_branch_leaves_the_grazing(self, case):
        free, impacting = study(*case)
        assert free.outcome.reason == "grazing"
        assert "signature [impact] leave there" in free.outcome.message
        assert impacting.info.signature == ("impact",)
        assert impacting.info.origin == "b1/GR1"
        (born,) = impacting.points[impacting["s"] == 0.0]
        assert born["free"][0] == pytest.approx(stiffness(parameters(*case)), rel=ACCURACY)
        # It arrives with no speed.
        assert abs(born["state"][1]) < 1e-6

    @pytest.mark.drawn(3)
    def test_every_point_is_the_closed_form(self, case):
        """Velocity after the impact, its time, and trace and determinant of the derivative."""
        branch, exact = study(*case)[1], OneImpact(parameters(*case))
        rows = branch.points[(branch["s"] > 0.0) & ~branch["special"]]
        assert len(rows) >= 8
        known = float(exact.determinant())
        for row in rows:
            force, (q, v, lasting, begin) = float(row["free"][0]), row["unknowns"]
            # Where multipliers are large, so is what a walked error makes of the orbit.
            size = 1.0 + float(np.abs(row["spectrum"][0]))
            assert abs(q - 1.0) <= WALKED * size
            assert abs(lasting - float(exact.duration)) <= 1e-12 * lasting
            wave = [float(w) for w in exact.wave(mpmath.mpf(v))]
            turn = [force / stiffness(parameters(*case)), 0.0]
            assert abs(math.hypot(wave[0], wave[1] / case[0]) / turn[0] - 1.0) <= 10.0 * WALKED * size
            p = parameters(*case, force=force)
            assert np.allclose(forced(p, begin), wave, rtol=0, atol=30.0 * WALKED * size)
            values = np.array(row["spectrum"])
            assert abs(values.prod() - known) <= WALKED * size
            trace = float(exact.trace(mpmath.mpf(v)))
            assert abs(values.sum() - trace) <= 10.0 * WALKED * size**2

    def test_observables(self, case):
        branch = study(*case)[1]
        rows = branch.points[(branch["s"] > 0.0) & ~branch["special"]]
        names = branch.info.observables
        for row in rows:
            _, v, _, begin = row["unknowns"]
            found = dict(zip(names, row["observables"].tolist(), strict=True))
            size = WALKED * (1.0 + float(np.abs(row["spectrum"][0])))
            assert found["impact_speed"] == pytest.approx(-v / case[2], abs=10.0 * size)
            assert found["q_max"] == pytest.approx(1.0, abs=10.0 * size)
            turned = abs(np.exp(1j * found["impact_phase"]) - np.exp(1j * case[0] * begin))
            assert turned <= 10.0 * size

    @pytest.mark.drawn(2)
    def test_invariants(self, case):
        for branch in study(*case):
            check_hybrid_branch(branch, SYSTEM, every=12)


@pytest.mark.parametrize("case", FOLDED)
def test_fold_of_the_impacting_motion(case):
    point = only(study(*case)[1], "LP")
    with mpmath.workdps(DIGITS):
        exact = OneImpact(parameters(*case))
        assert_met(point, "force", float(exact.fold()))
        a, b, _ = exact.quadratic(mpmath.mpf(0))
        assert point.unknowns[1] == pytest.approx(float(-b / (2 * a)), abs=ACCURACY)
    # Above the fold there are two motions: the one that begins at the grazing is the unstable one.
    assert (point.unstable_before, point.unstable_after) == (1, 0)
    assert point.spectrum[0] == pytest.approx(1.0, abs=ACCURACY)


@pytest.mark.parametrize("case", [(0.7, 0.1, 0.8), (2.2, 0.1, 0.8)])
def test_doubling_of_the_impacting_motion(case):
    point = only(study(*case)[1], "PD")
    with mpmath.workdps(DIGITS):
        exact = OneImpact(parameters(*case))
        assert_met(point, "force", float(exact.doubling(point.parameters["force"], faster=True)))
    assert point.criticality is not None


@pytest.mark.parametrize("case", [(0.7, 0.1, 0.8), (0.5, 0.2, 0.6)])
def test_a_second_touch_ends_the_impacting_motion(case):
    """Terminal: beyond it the impact happens earlier, and a branch with two impacts leaves."""
    branch = study(*case)[1]
    point = only(branch, "GR")
    assert point.kind == "terminal"
    seconds = float(point.note.split("touched ")[1].split(" s ")[0])
    with mpmath.workdps(DIGITS):
        exact = OneImpact(parameters(*case))
        force = exact.touching((point.parameters["force"], seconds), faster=True)
        assert_met(point, "force", float(force))
    assert branch.outcome.reason == "grazing"
    assert "signature [impact impact] leave there" in branch.outcome.message


class TestBack:
    """From the impacting motion to the one without impacts."""

    @staticmethod
    @cache
    def study(policy: str) -> tuple[Branch, ...]:
        p = parameters(1.3, 0.1)
        return tuple(
            diagram(
                SYSTEM,
                "force",
                (0.2, 1.1),
                [0.0, 0.0],
                vars(p),
                events={"GR": policy},
                until="settled",
                direction="down",
            )
        )

    @pytest.mark.drawn(1)
    @pytest.mark.parametrize("policy", ["stop", "ignore", "switch"])
    def test_impact_arrives_with_no_speed(self, policy):
        """A terminal grazing: no orbit of this itinerary lies beyond, so `ignore` stops as well."""
        first, *others = self.study(policy)
        graze = stiffness(parameters(1.3, 0.1))
        (point,) = [q for q in first.special_points if q.label == "GR"]
        assert point.kind == "terminal"
        assert "arrives with no rate" in point.note
        assert_met(point, "force", graze)
        with mpmath.workdps(DIGITS):
            assert_met(only(first, "LP"), "force", float(OneImpact(parameters(1.3, 0.1)).fold()))
        assert first.outcome.reason == "grazing"
        assert len(others) == (1 if policy == "switch" else 0)

    def test_branch_without_impacts(self):
        first, quiet = self.study("switch")
        graze = stiffness(parameters(1.3, 0.1))
        assert quiet.info.signature == ()
        assert quiet.info.parent == ("b1", only(first, "GR").s)
        assert quiet["force"].max() <= graze * (1.0 + ACCURACY)
        assert quiet["force"].min() == 0.2
        assert np.all(quiet["unstable"] == 0)
        rows = quiet.points[quiet["s"] > 0.0]
        for row in rows:
            expected = forced(parameters(1.3, 0.1, force=float(row["free"][0])), 0.0)
            assert np.allclose(row["state"], expected, rtol=0, atol=WALKED)
        check_hybrid_branch(quiet, SYSTEM)

    def test_multipliers_grow_as_the_inverse_of_the_speed(self):
        """Towards the grazing: largest multiplier times impact speed goes to a finite number."""
        first = self.study("stop")[0]
        (point,) = [q for q in first.special_points if q.label == "GR"]
        fold = only(first, "LP").index
        step = 1 if point.index > fold else -1
        products = [
            float(np.abs(first.points["spectrum"][i, 0]) * first["impact_speed"][i])
            for i in range(point.index - 4 * step, point.index, step)
        ]
        assert np.ptp(products) < 0.2 * abs(np.mean(products))
        assert first["max_abs"][point.index - step] > 10.0
