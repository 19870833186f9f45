"""Hopf points in closed form, with the first Lyapunov coefficient from an independent calculation."""

import mpmath
import pytest
from claimed_errors import DIGITS, assert_error_claim
from invariants import check_branch
from kuznetsov import first_lyapunov
from small_systems import bifurcations, small_problem

import contwalk as cw

# The project's goal for normal forms is 1e-5; exact derivatives give rounding amplified by a modest
# condition.
COEFFICIENT = 1e-9


def brusselator(t, x, p, dx):
    dx[0] = p.A - (p.B + 1.0) * x[0] + x[0] * x[0] * x[1]
    dx[1] = p.B * x[0] - x[0] * x[0] * x[1]


@pytest.mark.parametrize("feed", [0.3, 1.0, 1.7, 10.0])
def test_the_brusselator_has_its_hopf_point_at_one_plus_a_squared(feed):
    start = 0.7 * (1.0 + feed**2)
    problem = small_problem(brusselator, ["X", "Y"], {"A": feed, "B": start}, "B")
    end = 1.5 * (1.0 + feed**2)
    branch = cw.continue_branch(problem, [feed, start / feed], (start, end), direction="forward")
    check_branch(branch, problem)
    (hopf,) = bifurcations(branch)
    with mpmath.workdps(DIGITS):
        a = mpmath.mpf(feed)
        b = 1 + a * a
        assert_error_claim(hopf, "B", b)

        def exactly(x):
            return [a - (b + 1) * x[0] + x[0] ** 2 * x[1], b * x[0] - x[0] ** 2 * x[1]]

        l1, omega = first_lyapunov(exactly, [a, b / a], a)
    assert hopf.coefficients["omega"] == pytest.approx(feed, rel=1e-14)  # omega = A, rounded
    assert float(omega) == pytest.approx(feed, rel=1e-14)
    assert hopf.coefficients["l1"] == pytest.approx(float(l1), rel=COEFFICIENT)
    assert hopf.criticality == "supercritical"
    assert hopf.coefficients["crossing_rate"] == pytest.approx(0.5, rel=1e-12)  # trace B - 1 - A^2, halved
    assert (hopf.unstable_before, hopf.unstable_after) == (0, 2)


@pytest.mark.parametrize("l", [-1.0, 0.25])
@pytest.mark.parametrize("omega", [1.0, 30.0])
def test_the_planar_normal_form(l, omega):  # noqa: E741 - the literature's name
    """z' = (mu + i omega) z + l z |z|^2. With |q| = 1 the amplitude is w = z / sqrt(2): l1 = 2 l / omega."""

    def field(t, x, p, dx):
        square = x[0] ** 2 + x[1] ** 2
        dx[0] = p.mu * x[0] - p.omega * x[1] + p.l * x[0] * square
        dx[1] = p.omega * x[0] + p.mu * x[1] + p.l * x[1] * square

    problem = small_problem(field, "xy", {"mu": -0.7, "omega": omega, "l": l}, "mu")
    branch = cw.continue_branch(problem, [0.0, 0.0], (-1.0, 1.0))
    check_branch(branch, problem)
    (hopf,) = bifurcations(branch)
    assert_error_claim(hopf, "mu", mpmath.mpf(0))
    assert hopf.coefficients["l1"] == pytest.approx(
        2.0 * l / omega, rel=1e-13
    )  # a product of a few roundings
    assert hopf.coefficients["crossing_rate"] == pytest.approx(1.0, rel=1e-13)
    assert hopf.criticality == ("supercritical" if l < 0 else "subcritical")


@pytest.mark.parametrize(
    ("g20", "g11", "g02", "g21"),
    [(1 + 2j, 0.5 - 1j, -0.3 + 0.2j, -2 + 1j), (0.2 - 3j, 1 + 1j, 2j, 0.1), (3 + 1j, 2 + 2j, 1, 0)],
)
def test_the_planar_normal_form_with_quadratic_terms(g20, g11, g02, g21):
    """z' = (mu + i w) z + g20 z^2 / 2 + g11 z z* + g02 z*^2 / 2 + g21 z^2 z* / 2 (Kuznetsov 2004, eq. 3.18).

    c1 = i / (2 w) (g20 g11 - 2 |g11|^2 - |g02|^2 / 3) + g21 / 2,
    and l1 = 2 Re c1 / w in units of z / sqrt(2).
    """
    omega = 1.5
    (a, b), (c, d), (e, f), (g, h) = ((complex(v).real, complex(v).imag) for v in (g20, g11, g02, g21))

    def field(t, x, p, dx):
        u, v = x[0] ** 2 - x[1] ** 2, 2.0 * x[0] * x[1]
        square = x[0] ** 2 + x[1] ** 2
        re = p.mu * x[0] - omega * x[1] + 0.5 * (a * u - b * v) + c * square
        im = omega * x[0] + p.mu * x[1] + 0.5 * (a * v + b * u) + d * square
        dx[0] = re + 0.5 * (e * u + f * v) + 0.5 * square * (g * x[0] - h * x[1])
        dx[1] = im + 0.5 * (f * u - e * v) + 0.5 * square * (g * x[1] + h * x[0])

    problem = small_problem(field, "xy", {"mu": -0.2}, "mu")
    branch = cw.continue_branch(problem, [0.0, 0.0], (-0.3, 0.3))
    check_branch(branch, problem)
    (hopf,) = bifurcations(branch)
    c1 = 1j / (2 * omega) * (g20 * g11 - 2 * abs(g11) ** 2 - abs(g02) ** 2 / 3) + g21 / 2
    assert hopf.coefficients["l1"] == pytest.approx(2.0 * c1.real / omega, rel=COEFFICIENT)
    assert hopf.criticality == ("supercritical" if c1.real < 0 else "subcritical")


def test_three_states_with_a_slaved_one():
    """An extra state driven by the square of the amplitude adds to the cubic: z' gets -k z y, y' = -s y +
    |z|^2.
    """

    def field(t, x, p, dx):
        dx[0] = p.mu * x[0] - 2.0 * x[1] - 3.0 * x[0] * x[2]
        dx[1] = 2.0 * x[0] + p.mu * x[1] - 3.0 * x[1] * x[2]
        dx[2] = -0.5 * x[2] + x[0] ** 2 + x[1] ** 2

    problem = small_problem(field, "xyz", {"mu": -0.2}, "mu")
    branch = cw.continue_branch(problem, [0.0, 0.0, 0.0], (-0.3, 0.3))
    check_branch(branch, problem)
    (hopf,) = bifurcations(branch)
    # On the centre manifold y = 2 |z|^2, so l = -6 and l1 = 2 l / omega.
    assert hopf.coefficients["l1"] == pytest.approx(-6.0, rel=COEFFICIENT)

    def exactly(x):
        return [
            -2 * x[1] - 3 * x[0] * x[2],
            2 * x[0] - 3 * x[1] * x[2],
            -x[2] / 2 + x[0] ** 2 + x[1] ** 2,
        ]

    assert float(first_lyapunov(exactly, [0, 0, 0], 2)[0]) == pytest.approx(-6.0, rel=COEFFICIENT)


def test_criticality_is_by_the_critical_pair_alone():
    """An unstable direction besides does not turn a supercritical Hopf point into a subcritical one."""

    def field(t, x, p, dx):
        square = x[0] ** 2 + x[1] ** 2
        dx[0] = p.mu * x[0] - x[1] - x[0] * square
        dx[1] = x[0] + p.mu * x[1] - x[1] * square
        dx[2] = 0.8 * x[2] + x[2] ** 2

    problem = small_problem(field, "xyz", {"mu": -0.5}, "mu")
    branch = cw.continue_branch(problem, [0.0, 0.0, 0.0], (-1.0, 0.5))
    check_branch(branch, problem)
    (hopf,) = bifurcations(branch)
    assert (hopf.unstable_before, hopf.unstable_after) == (1, 3)
    assert hopf.criticality == "supercritical"


def test_the_crossing_rate_against_a_difference_along_the_branch():
    problem = small_problem(brusselator, ["X", "Y"], {"A": 1.3, "B": 2.0}, "B")
    width = 1e-3
    middle = 1.0 + 1.3**2
    branch = cw.continue_branch(
        problem, [1.3, 2.0 / 1.3], (2.0, 4.0), marks={"B": [middle - width, middle + width]}
    )
    check_branch(branch, problem)
    below, above = (branch["max_re"][q.index] for q in branch.special_points if q.label == "UZ")
    (hopf,) = bifurcations(branch)
    # Re = (B - 1 - A^2) / 2 is linear: the difference is off by rounding of its terms, 1e-16 / 1e-3.
    assert (above - below) / (2 * width) == pytest.approx(hopf.coefficients["crossing_rate"], rel=1e-11)


def spring(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -x[0] - x[0] ** 3 + p.mu * x[1]


def test_where_damping_vanishes_in_a_conservative_machine_nothing_is_told_of_the_side():
    """All terms of l1 are imaginary: their real parts are rounding, and no criticality."""
    problem = small_problem(spring, "xy", {"mu": -0.5}, "mu")
    (hopf,) = bifurcations(cw.continue_branch(problem, [0.0, 0.0], (-0.5, 0.5)))
    assert hopf.criticality is None
    assert "degenerate" in hopf.note
    assert abs(hopf.coefficients["l1"]) <= hopf.coefficients["l1_error"] < 1e-14


def competitors(t, x, p, dx):
    """Three species, each pressed by the next one (R. May, W. Leonard, SIAM J. Appl. Math. 29 (1975) 243)."""
    for i in range(3):
        dx[i] = x[i] * (1.0 - x[i] - p.a * x[(i + 1) % 3] - p.b * x[(i + 2) % 3])


def test_cycles_that_exist_at_one_value_only_are_followed_from_their_hopf_point():
    """At a + b = 2 all of a plane is cycles, up to the heteroclinic one: the side tells no size of them."""
    problem = small_problem(competitors, "xyz", {"a": 0.8, "b": 0.9}, "b")
    equilibria = cw.continue_branch(problem, [0.37, 0.37, 0.37], (0.3, 2.0))
    (hopf,) = bifurcations(equilibria)
    assert hopf.parameters["b"] == pytest.approx(1.2, abs=1e-14)
    assert hopf.criticality is None
    cycles = cw.switch_branch(problem, equilibria, "HB1", (0.3, 2.0))
    assert [p.label for p in cycles.special_points] == ["EP"]
    assert cycles.outcome.reason == "homoclinic", cycles.outcome
    assert abs(cycles.points["free"][:, 0] - 1.2).max() < 1e-8  # the accuracy asked
    assert cycles.points["period"][-1] > 3.0 * cycles.points["period"][0]
