"""What lies between two solutions of made-up branches: found, counted, or refused with a reason."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from made_up import MadeUp, at, circle, line, parabola, pitchfork, unrefined
from small_systems import small_problem

import contwalk as cw
from contwalk.continuation import detection
from contwalk.continuation.detection import _check_apart, bifurcations
from contwalk.continuation.locating import Disagreement, Subsegment
from contwalk.continuation.special_points import at_the_end


def told(found):
    return [(f.label, f.before, f.after) for f in found]


# -- folds ---------------------------------------------------------------------------------------------------


def test_a_fold_is_found_where_the_parameter_turns():
    found = bifurcations(parabola().segment((-0.3, 0.09), (0.4, 0.16)))
    assert told(found) == [("LP", 1, 0)]
    assert found[0].theta == pytest.approx(3.0 / 7.0, abs=0.05)
    assert found[0].located.z.tolist() == [0.0, 0.0]


def test_no_fold_where_the_parameter_only_slows_down():
    """lam = x^3 stands still at zero and goes on; its eigenvalue touches zero."""
    problem = MadeUp(lambda z: [z[0] ** 3 - z[1]], lambda z: [[3.0 * z[0] ** 2, -1.0]], lambda z: [-1.0])
    assert bifurcations(problem.segment((-0.3, -0.027), (0.4, 0.064))) == []


def test_a_fold_that_is_not_found_is_a_disagreement():
    for special in ({}, {"LP": [at(0.6, 0.36)]}, {"LP": [at(0.05, 0.0)]}, {"LP": [unrefined((0.0, 0.0))]}):
        problem = parabola(special=special)
        with pytest.raises(Disagreement, match="The parameter turns, but no fold is found") as raised:
            bifurcations(problem.segment((-0.3, 0.09), (0.4, 0.16)))
        assert raised.value.type.label == "LP"


class OnSteps(MadeUp):
    """The same as if it were solved on steps: solutions are off by what is told."""

    location_tolerance, off = 1e-6, 1e-7

    @property
    def meshed(self):
        return self

    def examine(self, *given):
        return replace(super().examine(*given), error=self.off)


def hardly_turning(turn, value, off):
    """lam = turn x^2, with an eigenvalue that is told: F_u alone would pass zero."""
    problem = OnSteps(lambda z: [z[1] - turn * z[0] ** 2], lambda z: [[-2.0 * turn * z[0], 1.0]], value)
    problem.off = off
    return problem.segment((-0.3, turn * 0.09), (0.4, turn * 0.16))


def test_a_parameter_that_errors_of_the_steps_alone_turn_has_no_fold():
    """As along an explosion of cycles: no eigenvalue is near its critical value."""
    assert bifurcations(hardly_turning(1e-8, lambda z: [-0.9], 1e-7)) == []


@pytest.mark.parametrize(
    ("turn", "value", "off"),
    [
        (1e-8, lambda z: -0.9, 1e-9),
        (1e-3, lambda z: -0.9, 1e-7),
        (1e-8, lambda z: -1e-15 if z[0] < 0.0 else -0.9, 1e-7),
    ],
    ids=["more than errors", "a turn to be seen", "an eigenvalue that becomes critical"],
)
def test_any_other_turn_without_a_fold_is_a_disagreement(turn, value, off):
    with pytest.raises(Disagreement, match="The parameter turns, but no fold is found"):
        bifurcations(hardly_turning(turn, lambda z: [value(z)], off))


def test_a_family_that_stands_still_has_no_fold():
    """As where a machine conserves something at one value of its parameter: one eigenvalue is critical on."""
    assert bifurcations(hardly_turning(1e-8, lambda z: [-1e-15], 1e-7)) == []


@pytest.mark.parametrize("turn", [1e-9, 1e-3])
def test_where_the_parameter_stands_still_eigenvalues_tell_the_fold(turn):
    """It turns at 0.2, by rounding, and the eigenvalue passes at -0.1."""
    problem = OnSteps(
        lambda z: [turn * (z[0] - 0.2) ** 2 - z[1]],
        lambda z: [[2.0 * turn * (z[0] - 0.2), -1.0]],
        lambda z: [z[0] + 0.1],
        special={"LP": [at(-0.1, 0.09 * turn)]},
    )
    segment = problem.segment((-0.3, 0.25 * turn), (0.4, 0.04 * turn))
    if turn > 1e-7:  # it is to be believed then
        with pytest.raises(Disagreement, match="The parameter turns, but no fold is found"):
            bifurcations(segment)
        return
    (fold,) = bifurcations(segment)
    assert told([fold]) == [("LP", 0, 1)]
    assert fold.theta == pytest.approx(2.0 / 7.0, abs=1e-6)


@pytest.mark.parametrize(("apart", "refused"), [(1e-5, True), (0.1, False)])
def test_one_point_that_two_tests_see_is_a_disagreement(apart, refused):
    """A fold was told twice in a step, and the doubling beside it was lost."""
    segment = parabola().segment((-0.3, 0.09), (0.4, 0.16))
    (fold,) = bifurcations(segment)
    again = replace(fold, located=replace(fold.located, z=np.array([apart, 0.0])))
    if not refused:
        return _check_apart(segment, [fold, again])
    with pytest.raises(Disagreement, match="What two tests see is one point LP") as raised:
        _check_apart(segment, [fold, again])
    assert raised.value.type.label == "LP"
    return None


def test_both_folds_of_a_segment_that_turns_twice_need_a_shorter_one():
    """lam = x - x^3 between its far ends: the parameter goes the same way at both, and turns twice between.

    The eigenvalue, 3 x^2 - 1, is what tells: it is positive at both ends and negative in between.
    """
    fold = 1.0 / math.sqrt(3.0)
    special = {"LP": [at(s * fold, s * (fold - fold**3)) for s in (1.0, -1.0)]}
    problem = MadeUp(
        lambda z: [z[0] ** 3 - z[0] + z[1]], lambda z: [[3.0 * z[0] ** 2 - 1.0, 1.0]], special=special
    )
    found = bifurcations(problem.segment((-0.8, -0.8 + 0.512), (0.8, 0.8 - 0.512)))
    assert told(found) == [("LP", 1, 0), ("LP", 0, 1)]


def test_a_fold_of_which_the_eigenvalue_says_otherwise_is_a_disagreement():
    problem = parabola(eigenvalues=lambda z: [-2.0 * z[0], 1.0 if z[0] < 0.1 else -1.0])
    with pytest.raises(Disagreement):
        bifurcations(problem.segment((-0.3, 0.09), (0.4, 0.16)))


# -- branch points -------------------------------------------------------------------------------------------


def test_a_branch_point_is_found_where_the_orientation_changes():
    found = bifurcations(pitchfork().segment((0.0, -0.3), (0.0, 0.4)))
    assert told(found) == [("BP", 0, 1)]
    assert found[0].theta == pytest.approx(3.0 / 7.0, abs=1e-12)


def test_along_the_branch_that_turns_there_the_count_stays():
    """lam = x^2: the pitchfork's other branch, which turns at the branch point without a fold."""
    problem = MadeUp(
        lambda z: [z[0] * (z[1] - z[0] ** 2)],
        lambda z: [[z[1] - 3.0 * z[0] ** 2, z[0]]],
        special={"BP": [at(0.0, 0.0)], "LP": [at(0.0, 0.0)]},
        tangents={"BP": np.array([1.0, 0.0])},
    )
    for a, b in ((-0.03, 0.04), (0.05, -0.02)):
        assert told(bifurcations(problem.segment((a, a * a), (b, b * b)))) == [("BP", 0, 0)]


@pytest.mark.parametrize(
    "special",
    [[], [at(0.0, 0.7)], [at(0.01, 0.0)], [unrefined((0.0, 0.0))]],
    ids=["none", "beyond", "beside", "not refined"],
)
def test_a_branch_point_that_is_not_there_is_a_disagreement(special):
    with pytest.raises(Disagreement, match="no branch point is found") as raised:
        bifurcations(pitchfork(special={"BP": special}).segment((0.0, -0.3), (0.0, 0.4)))
    assert raised.value.type.label == "BP"


def test_a_point_on_this_place_but_of_another_way_is_refused():
    """The defining system cannot tell which branch it is asked about; the way through the point does."""
    problem = pitchfork(tangents={"BP": np.array([1.0, 0.3])})
    with pytest.raises(Disagreement):
        bifurcations(problem.segment((0.0, -0.3), (0.0, 0.4)))


def test_an_unfolded_pitchfork_has_no_branch_point():
    """lam x - x^3 + 1e-3: along the branch that goes on, nothing passes zero, and nothing is asked for."""
    problem = pitchfork(1e-3)

    def there(lam):
        return float(np.roots([-1.0, 0.0, lam, 1e-3])[np.argmax(np.roots([-1.0, 0.0, lam, 1e-3]).real)].real)

    for a, b in ((-0.3, -0.1), (-0.1, 0.1), (0.1, 0.3)):
        assert bifurcations(problem.segment((there(a), a), (there(b), b))) == []


# -- eigenvalues that nothing else sees ----------------------------------------------------------------------


def pair(center: float, slope: float = 1.0):
    """A complex pair that passes the imaginary axis at `center`."""
    return lambda z: [slope * (z[1] - center) + 2j, slope * (z[1] - center) - 2j]


def test_a_hopf_point_is_found_where_a_pair_crosses():
    problem = line(pair(0.25), special={"HB": [at(0.0, 0.25)]})
    found = bifurcations(problem.segment((0.0, 0.0), (0.0, 1.0)))
    assert told(found) == [("HB", 0, 2)]
    assert found[0].theta == pytest.approx(0.25, abs=1e-12)
    back = bifurcations(problem.segment((0.0, 1.0), (0.0, 0.0)))
    assert told(back) == [("HB", 2, 0)]


def test_two_hopf_points_of_two_pairs_are_both_found_and_counted_in_order():
    problem = line(
        lambda z: [*pair(0.3)(z), *pair(0.7, 0.5)(z)], special={"HB": [at(0.0, 0.3), at(0.0, 0.7)]}
    )
    found = bifurcations(problem.segment((0.0, 0.0), (0.0, 1.0)))
    assert told(found) == [("HB", 0, 2), ("HB", 2, 4)]


def test_a_pair_of_crossings_within_a_step_is_not_lost():
    """The real part passes zero at 0.4 and at 0.6; at both ends it is -0.24."""
    bump = lambda z: 0.01 - (z[1] - 0.5) ** 2  # noqa: E731
    problem = line(lambda z: [bump(z) + 2j, bump(z) - 2j], special={"HB": [at(0.0, 0.4), at(0.0, 0.6)]})
    assert told(bifurcations(problem.segment((0.0, 0.0), (0.0, 1.0)))) == [("HB", 0, 2), ("HB", 2, 0)]


def test_a_pair_of_crossings_that_the_ends_only_hint_at_is_not_lost():
    """From both ends the real part rises from -0.24 with the slope 0.47, towards a corner just below zero.

    It rises a little faster on the way, and passes zero at 0.457 and 0.543.
    """

    def corner(z):
        d = 0.5 - abs(z[1] - 0.5)
        return -0.24 + 0.47 * d + 0.12 * d * d

    root = (-0.47 + math.sqrt(0.47**2 + 4.0 * 0.12 * 0.24)) / 0.24
    special = {"HB": [at(0.0, root), at(0.0, 1.0 - root)]}
    problem = line(lambda z: [corner(z) + 2j, corner(z) - 2j], special=special)
    assert told(bifurcations(problem.segment((0.0, 0.0), (0.0, 1.0)))) == [("HB", 0, 2), ("HB", 2, 0)]


def test_a_pair_that_comes_near_and_goes_back_is_none():
    bump = lambda z: -0.001 - (z[1] - 0.5) ** 2  # noqa: E731
    problem = line(lambda z: [bump(z) + 2j, bump(z) - 2j], special={"HB": [at(0.0, 0.5)]})
    assert bifurcations(problem.segment((0.0, 0.0), (0.0, 1.0))) == []


@pytest.mark.parametrize(
    "special",
    [[], [at(0.0, 1.4)], [at(0.1, 0.25)], [unrefined((0.0, 0.25))]],
    ids=["none", "far", "off", "not refined"],
)
def test_a_pair_that_crosses_without_a_hopf_point_is_a_disagreement(special):
    problem = line(pair(0.25), special={"HB": special})
    with pytest.raises(Disagreement, match="no point HB is found") as raised:
        bifurcations(problem.segment((0.0, 0.0), (0.0, 1.0)))
    assert raised.value.type.label == "HB"


def test_a_real_eigenvalue_that_passes_zero_alone_is_a_disagreement():
    """It would be a fold or a branch point, and there is neither."""
    problem = line(lambda z: [z[1] - 0.3])
    with pytest.raises(Disagreement, match="no fold and no branch point") as raised:
        bifurcations(problem.segment((0.0, 0.0), (0.0, 1.0)))
    assert raised.value.type.label == "BP"


def test_two_real_eigenvalues_that_pass_together_are_one_point():
    """Their orientation does not change: a sign for each."""
    located = at(0.0, 0.3, multiplicity=2)
    problem = line(
        lambda z: [z[1] - 0.3, 2.0 * (z[1] - 0.3)],
        special={"MULTIPLE": [located]},
        tangents={"MULTIPLE": np.array([0.0, 1.0])},
    )
    assert told(bifurcations(problem.segment((0.0, 0.0), (0.0, 1.0)))) == [("BP", 0, 2)]


def test_two_real_eigenvalues_that_are_zero_to_the_last_bit_where_they_are_looked_at_are_one_point():
    """The secant through the ends meets them there at once, in a bracket that is no narrower for it."""
    problem = line(
        lambda z: [z[1] - 0.25, z[1] - 0.25],
        special={"MULTIPLE": [at(0.0, 0.25, multiplicity=2)]},
        tangents={"MULTIPLE": np.array([0.0, 1.0])},
    )
    assert told(bifurcations(problem.segment((0.0, 0.0), (0.0, 1.0)))) == [("BP", 0, 2)]


def test_two_real_eigenvalues_that_pass_one_after_the_other_are_not_one_point():
    located = at(0.0, 0.3, multiplicity=2)
    problem = line(
        lambda z: [z[1] - 0.3, z[1] - 0.31],
        special={"MULTIPLE": [located]},
        tangents={"MULTIPLE": np.array([0.0, 1.0])},
    )
    with pytest.raises(Disagreement):
        bifurcations(problem.segment((0.0, 0.0), (0.0, 1.0)))


def test_an_eigenvalue_that_is_doubtful_counts_as_at_its_neighbour():
    """It is 1e-3 or -1e-3 by turns, and known to 1e-2: nothing is told, whatever its sign at the ends."""
    problem = line(lambda z: [1e-3 * math.sin(40.0 * z[1])], error=1e-2)
    segment = problem.segment((0.0, 0.02), (0.0, 0.1))
    assert segment.a.measures[0] * segment.b.measures[0] < 0.0
    assert bifurcations(segment) == []


def test_a_fold_and_a_hopf_point_on_one_step_are_told_apart():
    """lam = x^2 from x = -0.5: the real eigenvalue passes zero at the fold, the pair at x = 0.2."""
    problem = parabola(
        eigenvalues=lambda z: [-2.0 * z[0], z[0] - 0.2 + 3j, z[0] - 0.2 - 3j],
        special={"LP": [at(0.0, 0.0)], "HB": [at(0.2, 0.04)]},
    )
    found = bifurcations(problem.segment((-0.5, 0.25), (0.6, 0.36)))
    assert told(found) == [("LP", 1, 0), ("HB", 0, 2)]


def test_a_nearly_crossing_equilibrium_has_no_branch_point():
    """(x - 0.3 mu) (mu - x) + 1e-12 = 0: two branches that pass each other 2e-6 apart at mu = 0.

    Followed closely, the branch turns within 1e-6; the guess across is another branch. Either the step is
    refused, or nothing is told; a branch point would be a lie.
    """

    def field(t, x, p, dx):
        dx[0] = (x[0] - 0.3 * p.mu) * (p.mu - x[0]) + 1e-12

    problem = small_problem(field, "x", {"mu": -1.0}, "mu")
    branch = cw.continue_branch(problem, [-0.3], (-1.0, 1.0))
    assert [p.label for p in branch.special_points if p.label != "EP"] in ([], ["LP"])
    # The product of the distances from both lines is 1e-12 all along.
    x, mu = branch["x"], branch["mu"]
    product = (x - 0.3 * mu) * (mu - x)
    # x is known to some roundings of itself, and moves the product by as much.
    assert np.abs(product + 1e-12).max() <= 2e-15


# -- the end of a range --------------------------------------------------------------------------------------


def test_a_point_that_the_end_of_a_segment_is_itself():
    problem = line(pair(1.0), special={"HB": [at(0.0, 1.0)]})
    found = at_the_end(problem.segment((0.0, 0.5), (0.0, 1.0)))
    assert told(found) == [("HB", 0, 2)]
    assert found[0].theta == 1.0


def test_an_end_beside_a_point_is_none():
    problem = line(pair(1.0), special={"HB": [at(0.0, 1.0)]})
    assert at_the_end(problem.segment((0.0, 0.5), (0.0, 0.999))) == []


def test_an_end_that_looks_critical_without_a_point_is_none():
    for special in ([], [at(0.0, 1.2)], [unrefined((0.0, 1.0))]):
        problem = line(pair(1.0), special={"HB": special})
        assert at_the_end(problem.segment((0.0, 0.5), (0.0, 1.0))) == []


def test_an_end_that_is_a_branch_point_is_told_as_one():
    problem = pitchfork()
    segment = problem.segment((0.0, -0.3), (0.0, -0.1))
    crossing = problem.examine(
        np.zeros(2), np.array([0.0, 1.0]), np.ones(2), problem.linearize(np.zeros(2)), 0
    )
    segment = type(segment)(problem, segment.a, crossing)
    assert told(at_the_end(segment)) == [("BP", 0, 1)]


# -- locating ------------------------------------------------------------------------------------------------


def test_a_point_on_another_branch_is_not_taken_for_one_of_this():
    """The circle's upper half, and a fold that is offered at the right position but off the circle."""
    z = [(math.cos(t), math.sin(t)) for t in (1.2, 1.9)]
    right = circle(special={"LP": [at(0.0, 1.0)]}, eigenvalues=lambda z: [z[0]])
    assert told(bifurcations(right.segment(*z))) == [("LP", 1, 0)]
    wrong = replace(right, special={"LP": [at(0.0, 1.0 + 1e-4)]})
    with pytest.raises(Disagreement):
        bifurcations(wrong.segment(*z))


def test_a_located_point_is_told_on_its_segment():
    """A point that rounding puts a little before the start is at the start, never before it."""
    problem = line(pair(0.0), special={"HB": [at(0.0, -1e-15)]}, error=1e-17)
    found = bifurcations(problem.segment((0.0, -1e-14), (0.0, 1.0)))
    assert told(found) == [("HB", 0, 2)]
    assert 0.0 <= found[0].theta <= 1.0


# -- what errors of steps hide -------------------------------------------------------------------------------


def _two_pairs():
    special = {"HB": [at(0.0, 0.3), at(0.0, 0.7)]}
    return line(lambda z: [*pair(0.3)(z), *pair(0.7, 0.5)(z)], special=special)


def _hidden_on(monkeypatch, segment, finer):
    """As if a multiplier changed sides unseen on `segment`, and `finer` were there on the finest steps."""
    usual = detection.knots_of

    def knots_of(part, branch_points):
        if part is segment:
            raise Disagreement(part.problem.point_types[0], "Neither is seen.", (0.3, 0))
        return usual(part, branch_points)

    monkeypatch.setattr(detection, "knots_of", knots_of)
    monkeypatch.setattr(detection, "on_finest_steps", lambda *_: finer)


def test_what_errors_hide_is_found_on_finest_steps_and_the_rest_beside_it(monkeypatch):
    problem = _two_pairs()
    segment = problem.segment((0.0, 0.0), (0.0, 1.0))
    finer = Subsegment(problem.segment((0.0, 0.28), (0.0, 0.32)), (0.28, 0.32))
    _hidden_on(monkeypatch, segment, finer)
    found = bifurcations(segment)
    assert told(found) == [("HB", 0, 2), ("HB", 2, 4)]
    assert [f.theta for f in found] == pytest.approx([0.3, 0.7], abs=1e-12)


def test_finest_steps_that_count_otherwise_where_they_begin_are_not_trusted(monkeypatch):
    problem = _two_pairs()
    segment = problem.segment((0.0, 0.0), (0.0, 1.0))
    elsewhere = problem.segment((0.0, 0.48), (0.0, 0.52))
    for finer in (None, Subsegment(elsewhere, (0.28, 0.32))):
        with monkeypatch.context() as patch:
            _hidden_on(patch, segment, finer)
            with pytest.raises(Disagreement, match="Neither is seen"):
                bifurcations(segment)


def test_a_point_that_finer_steps_have_elsewhere_is_not_the_one_on_the_segment():
    """What is near to it on the segment's own steps leads to another point, as along a canard."""
    near = at(0.0, 0.25, refine=lambda: at(0.0, 0.95))
    problem = line(pair(0.25), special={"HB": [near]})
    with pytest.raises(Disagreement, match="no point HB is found"):
        bifurcations(problem.segment((0.0, 0.2), (0.0, 0.3)))


def test_two_pairs_that_pass_together_are_counted_one_after_the_other():
    """Two oscillators of other frequencies and one growth rate, beside a state that is unstable."""

    def field(t, x, p, dx):
        for k, omega in ((0, 1.0), (2, 2.3)):
            growth = p.mu - x[k] ** 2 - x[k + 1] ** 2
            dx[k] = growth * x[k] - omega * x[k + 1]
            dx[k + 1] = omega * x[k] + growth * x[k + 1]
        dx[4] = 2.0 * x[4] - x[4] ** 3

    problem = small_problem(field, "abcde", {"mu": -0.5}, "mu")
    branch = cw.continue_branch(problem, np.zeros(5), (-0.5, 0.7))
    found = [(p.label, p.unstable_before, p.unstable_after) for p in branch.special_points[1:-1]]
    assert found == [("HB", 1, 3), ("HB", 3, 5)]
