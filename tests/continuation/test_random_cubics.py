"""Folds of random cubics are the roots of their discriminant, and none is missed."""

import mpmath
from claimed_errors import DIGITS, assert_error_claim
from hypothesis import Phase, assume, given, settings
from hypothesis import strategies as st
from invariants import check_branch
from small_systems import bifurcations, small_problem

import contwalk as cw

coefficients = st.integers(min_value=-40, max_value=40).map(lambda k: k / 16.0)


@settings(
    max_examples=6, deadline=None, derandomize=True, database=None, phases=[Phase.explicit, Phase.generate]
)
@given(b=coefficients, c=coefficients, d=coefficients, sign=st.sampled_from([-1.0, 1.0]))
def test_every_fold_of_a_cubic_is_found(b, c, d, sign):
    """lambda = -(s x^3 + b x^2 + c x + d) is one curve; it turns where 3 s x^2 + 2 b x + c = 0."""
    inside = b * b - 3.0 * sign * c
    assume(abs(inside) > 1e-2)  # at zero the two folds are one inflection

    def field(t, x, p, dx):
        dx[0] = p.lam + sign * x[0] ** 3 + b * x[0] ** 2 + c * x[0] + d

    def value(x):
        return -(sign * x**3 + b * x**2 + c * x + d)

    # All folds have |x| < 2.1 and |lambda| below that at the ends of [-2.1, 2.1] with every sign positive.
    bound = 2.1**3 + abs(b) * 2.1**2 + abs(c) * 2.1 + abs(d) + 1.0
    problem = small_problem(field, "x", {"lam": value(-2.0)}, "lam")
    branch = cw.continue_branch(problem, [-2.0], (-bound, bound))
    check_branch(branch, problem)
    assert sorted(branch["lam"][[0, -1]]) == [-bound, bound]
    folds = bifurcations(branch)
    if inside < 0.0:
        assert folds == []
        return
    with mpmath.workdps(DIGITS):
        root = mpmath.sqrt(mpmath.mpf(b) ** 2 - 3 * mpmath.mpf(sign) * mpmath.mpf(c))
        states = sorted((-mpmath.mpf(b) + k * root) / (3 * mpmath.mpf(sign)) for k in (1, -1))
        assert [q.label for q in folds] == ["LP", "LP"]
        for point, x in zip(sorted(folds, key=lambda q: q.state["x"]), states, strict=True):
            assert_error_claim(point, "lam", value(x))
            # The discriminant of the cubic in x vanishes at this parameter, to the rounding of its terms.
            terms = _discriminant_terms(sign, b, c, d + point.parameters["lam"])
            assert abs(sum(terms)) <= 1e-13 * sum(abs(v) for v in terms)


def _discriminant_terms(a, b, c, d):
    return [18 * a * b * c * d, -4 * b**3 * d, b**2 * c**2, -4 * a * c**3, -27 * a**2 * d**2]


@settings(
    max_examples=5, deadline=None, derandomize=True, database=None, phases=[Phase.explicit, Phase.generate]
)
@given(
    roots=st.lists(st.integers(min_value=-14, max_value=14), min_size=1, max_size=5, unique=True),
    rate=st.integers(min_value=1, max_value=5),
)
def test_every_crossing_on_a_trivial_branch_is_found(roots, rate):
    """x_k' = rate (mu - r_k) x_k - x_k^3: a pitchfork at every root, each by another state."""
    values = [r / 16.0 for r in sorted(roots)]

    def field(t, x, p, dx):
        for k, root in enumerate(values):
            dx[k] = rate * (p.mu - root) * x[k] - x[k] ** 3

    problem = small_problem(field, [f"x{k}" for k in range(len(values))], {"mu": -1.0}, "mu")
    branch = cw.continue_branch(problem, [0.0] * len(values), (-1.0, 1.0))
    check_branch(branch, problem)
    found = bifurcations(branch)
    assert [q.kind for q in found] == ["pitchfork"] * len(values)
    for number, (point, root) in enumerate(zip(found, values, strict=True)):
        assert_error_claim(point, "mu", mpmath.mpf(root))
        assert (point.unstable_before, point.unstable_after) == (number, number + 1)
