"""Homoclinic ends: what is one, what is a fold, and what the limit's error claims."""

import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from small_systems import labelled, small_problem

import contwalk as cw
from contwalk.numerics.laws import Pair, falling, inverse_square, swinging
from contwalk.problems.orbit.homoclinic import (
    _coming,
    _Equilibrium,
    _gone,
    _laws,
    _passing,
    _standing,
    homoclinic,
)
from contwalk.problems.orbit.slow_place import SlowPlace

# Where the manifolds of the saddle of the Morris-Lecar model below meet, by SciPy's DOP853 to 1e-13: from two
# distances to 6e-12.
MORRIS_LECAR = 35.006734197584


def claimed(branch):
    """The limit that a homoclinic end names, and its error."""
    found = re.search(r"orbit at \w+ = (\S+) \+- (\S+), by", branch.outcome.message)
    return float(found[1]), float(found[2])


def morris_lecar(t, x, p, dx):
    m = 0.5 * (1.0 + np.tanh((x[0] + 1.2) / 18.0))
    w = 0.5 * (1.0 + np.tanh((x[0] - 12.0) / 17.4))
    rate = 0.23 * np.cosh((x[0] - 12.0) / 34.8)
    dx[0] = (p.I - 4.0 * m * (x[0] - 120.0) - 8.0 * x[1] * (x[0] + 84.0) - 2.0 * (x[0] + 60.0)) / 20.0
    dx[1] = rate * (w - x[1])


def test_the_limit_is_given_with_an_error_that_covers():
    problem = small_problem(morris_lecar, ["v", "w"], {"I": -50.0}, "I")
    equilibria = cw.continue_branch(problem, [-75.0, 0.0], (-50.0, 120.0))
    cycle = cw.switch_branch(problem, equilibria, "HB1", (-50.0, 120.0))
    assert cycle.outcome.reason == "homoclinic", cycle.outcome
    assert [p.label for p in cycle.special_points] == ["LP", "EP"]
    value, error = claimed(cycle)
    assert abs(value - MORRIS_LECAR) <= error
    assert error <= 1e-10 * value  # orbits of longer periods are followed until rounding is left


# Where the stable and the unstable manifold of the saddle of the next model meet, by SciPy's DOP853 to 1e-13.
MEETING = -0.4295058488773843


def takens(t, x, p, dx):
    """Unfolding of a Bogdanov-Takens point: cycles around (1, 0) end at the saddle (0, 0)."""
    dx[0] = x[1]
    dx[1] = x[0] - x[0] ** 2 + p.b * x[1] + 0.5 * x[0] * x[1]


def test_a_limit_nearer_than_what_the_steps_of_the_walk_tell_is_found_on_finer_ones():
    """Slopes are noise there: the walk went on to a period of 123, over 24 crossings that are none."""
    problem = small_problem(takens, "xy", {"b": -0.6}, "b")
    cycle = cw.switch_branch(
        problem, cw.continue_branch(problem, [1.0, 0.0], (-0.6, 0.0)), "HB1", (-0.6, 0.0)
    )
    assert cycle.outcome.reason == "homoclinic", cycle.outcome
    assert [p.label for p in cycle.special_points] == ["EP"]
    value, error = claimed(cycle)
    assert abs(value - MEETING) <= error < 1e-8


def takens_in_the_plane(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = x[0] - x[0] ** 2 + p.b * x[1] + p.c * x[0] * x[1]


@pytest.mark.long
def test_a_curve_in_two_parameters_tells_the_limit_in_both():
    """It was told along the line through its last two orbits: `path = 1.075 +- 2.4e+09`."""
    problem = small_problem(takens_in_the_plane, "xy", {"b": -0.48, "c": 0.48}, "b")
    equilibria = cw.continue_branch(problem, [1.0, 0.0], (-0.6, 0.0))
    marked = {"marks": {"b": [MEETING]}}
    cycle = cw.switch_branch(problem, equilibria, "HB1", (-0.6, 0.0), **marked)
    curve = cw.continue_locus(problem.system, cycle, "UZ1", {"b": (-0.6, 0.0), "c": (0.4, 0.7)})
    assert curve.outcome.reason == "homoclinic", curve.outcome
    found = re.search(r"orbit at b = (\S+) \+- \S+, c = (\S+) \+- (\S+), by", curve.outcome.message)
    assert float(found[1]) == pytest.approx(MEETING, rel=1e-11)
    assert abs(float(found[2]) - 0.5) <= float(found[3]) < 1e-6


def leaf(t, x, p, dx):
    """The loop y^2 = x^2 (1 - x) is homoclinic at m = 1, eigenvalues a - 1 and a + 1 (B. Sandstede, 1997)."""
    aside = p.m - 1.0
    dx[0] = p.a * x[0] + x[1] - p.a * x[0] ** 2 + aside * x[0] * (2.0 - 3.0 * x[0])
    dx[1] = x[0] + p.a * x[1] - 1.5 * x[0] ** 2 - 1.5 * p.a * x[0] * x[1] - 2.0 * aside * x[1]


@pytest.mark.drawn(1)
@pytest.mark.parametrize("a", [-0.8, 0.2])
def test_longer_periods_are_followed_until_rounding_is_left(a):
    problem = small_problem(leaf, "xy", {"m": 1.0, "a": a}, "m")
    equilibria = cw.continue_branch(problem, [2.0 / 3.0, 0.0], (0.5, 1.5))
    cycle = cw.switch_branch(problem, equilibria, "HB1", (0.5, 1.5))
    assert cycle.outcome.reason == "homoclinic", cycle.outcome
    value, error = claimed(cycle)
    assert abs(value - 1.0) <= error < 1e-12
    period = float(re.search(r"where the period is (\S+)\.", cycle.outcome.message)[1])
    # By then what is left has fallen from the walk's 1e-7, at the lesser rate of the saddle.
    assert period > cycle.points["period"][-1] + np.log(1e4) / (1.0 - abs(a))


def escape(t, x, p, dx):
    """Undamped it conserves y^2 / 2 + x^2 / 2 + x^3 / 3: all its orbits, and their loop, are at m = 0."""
    dx[0] = x[1]
    dx[1] = -x[0] - x[0] ** 2 - p.m * x[1]


def test_a_family_at_one_value_of_the_parameter_ends_at_its_saddle():
    """Slopes are rounding all along: the walk went on to periods of 1500, and told folds that are none."""
    problem = small_problem(escape, "xy", {"m": 0.5}, "m")
    equilibria = cw.continue_branch(problem, [0.0, 0.0], (-1.0, 1.0))
    cycle = cw.switch_branch(problem, equilibria, "HB1", (-1.0, 1.0))
    assert cycle.outcome.reason == "homoclinic", cycle.outcome
    assert "the equilibrium x = -1, y = 0" in cycle.outcome.message
    assert [p.label for p in cycle.special_points] == ["EP"]
    value, error = claimed(cycle)
    assert abs(value) <= error < 1e-10


def circuit(t, x, p, dx):
    """An electronic oscillator (E. Freire et al., 1993), the demo `tor` of AUTO."""
    dx[0] = (-(0.5 + p.nu) * x[0] + 0.5 * x[1] - 0.328578 * x[0] ** 3 + 0.933578 * (x[1] - x[0]) ** 3) / 0.6
    dx[1] = 0.5 * x[0] + 0.1 * x[1] - x[2] - 0.933578 * (x[1] - x[0]) ** 3
    dx[2] = x[1]


@pytest.mark.long
def test_folds_before_a_saddle_focus_are_no_end():
    """Around a saddle-focus the family turns again and again, each time nearer to the limit."""
    problem = small_problem(circuit, "xyz", {"nu": -0.9}, "nu")
    equilibria = cw.continue_branch(problem, [0.0, 0.0, 0.0], (-1.0, 0.0))
    cycle = cw.switch_branch(problem, equilibria, "HB1", (-1.0, 0.0))
    assert cycle.outcome.reason == "homoclinic", cycle.outcome
    # It passes two of them in a round. The limit with the half round closed by the mirror, to 7e-13.
    value, error = claimed(cycle)
    assert abs(value + 0.79751983065330) <= error < 1e-8
    # A fold and the branch point beside it are one turn; turns are half a round of the focus apart.
    turns = [p for p in labelled(cycle, "LP", "BP") if p.period > 35.0]
    apart = np.diff([p.period for p in turns], prepend=0.0) > 1.0
    places = [p.parameters["nu"] for p, new in zip(turns, apart, strict=True) if new]
    assert len(places) >= 7
    widths = np.abs(np.diff(places))
    # Each turn is exp(pi rho / omega) times nearer, with the pair rho +- i omega of the equilibrium at y = 0.
    square = -(0.5 + places[-1]) / (0.328578 + 0.933578)
    bend = 3.0 * 0.933578 * square
    matrix = [
        [(-(0.5 + places[-1]) - 3.0 * 0.328578 * square - bend) / 0.6, (0.5 + bend) / 0.6, 0.0],
        [0.5 + bend, 0.1 - bend, -1.0],
        [0.0, 1.0, 0.0],
    ]
    pair = next(v for v in np.linalg.eigvals(np.array(matrix)) if v.imag > 0.0)
    # The next order is a part of the order of the deviation, 2e-3 at the first of these turns.
    assert np.diff(np.log(widths)) == pytest.approx(-np.pi * pair.real / pair.imag, abs=0.03)
    value, error = claimed(cycle)
    assert min(places[-2:]) < value < max(places[-2:])
    assert abs(value - places[-1]) < widths[-1]
    # The walk ends where the limit is known to 1e-7 of itself, whatever turns that takes; steps add to it.
    assert error < 2e-7 * abs(value)


def samples(law, *periods):
    """Two neighbouring orbits of a law lambda(T), with the slopes that their tangents tell."""
    step, at = 1e-6, np.array(periods)
    slopes = np.array([(law(t + step) - law(t - step)) / (2.0 * step) for t in periods])
    return Pair(at, np.array([law(t) for t in periods]), slopes)


def beside(matrix, distance=1e-2):
    """The equilibrium at 0 of a linear field, shape (n, n), and a slow place of an orbit that passes it."""
    matrix, n = np.asarray(matrix), len(matrix)
    state = np.append(np.zeros(n - 1), distance)
    place = SlowPlace(
        tuple(f"x{k}" for k in range(n)),
        1e-4,
        1.0,
        state,
        np.ones(n),
        state[None],
        lambda x: matrix @ x,
        lambda x: matrix,
        lambda x, value: (matrix @ x, np.column_stack([matrix, np.zeros(n)])),
    )
    return _Equilibrium(place, np.zeros(n))


def passing(matrix, distance, pair, eventful=False, passes=1):
    """The limit by the law of an equilibrium that is passed."""
    law = _passing(beside(matrix, distance), pair, eventful, passes)
    return None if law is None else law.limit


@pytest.mark.parametrize("lasting", [0.126, 0.32, 1.0, 4.0])
def test_orbits_of_nearly_one_period_tell_no_exponent(lasting):
    """Past two saddle-foci in a round the family swings half as fast: from near orbits either law fits."""
    exponent, passed = complex(-0.274, 0.628), 3e-4
    law = lambda t: (np.exp(0.5 * exponent * t + 0.4j)).real + passed * np.exp(exponent * t).real  # noqa: E731
    told = 0
    for begin in np.arange(60.0, 90.0, 1.7):
        pair = samples(law, begin, begin + lasting)
        limit = swinging(pair, [exponent, 0.5 * exponent])
        if limit is not None:
            told += 1
            assert abs(limit.rest + law(begin + lasting)) <= limit.error
    assert told or lasting < 0.3


def test_the_law_of_a_saddle():
    law = lambda t: 2.0 + 3.0 * np.exp(-0.7 * t)  # noqa: E731
    pair = samples(law, 10.0, 10.5)
    limit = falling(pair, [0.7])
    assert limit.rest == pytest.approx(2.0 - law(10.5), rel=1e-4)  # slopes by differences of 1e-6
    assert falling(pair, [1.5]) is None  # another equilibrium's rate: no end
    # Where that hides the equilibrium's own, the error covers what both rates say.
    hidden = falling(pair, [1.5], 0.25, 4.0)
    assert abs(hidden.rest - pair.slopes[1] / 1.5) <= hidden.error


def test_a_fold_is_not_the_law_of_a_saddle():
    """Near a fold dlambda/dT falls linearly: by which rate depends on how near, not on an equilibrium."""
    pair = samples(lambda t: 2.0 + 1e-9 * (t - 20.0) ** 2, 18.0, 18.3)
    assert falling(pair, [0.05]) is None
    assert falling(pair, [3.0]) is None


def test_the_law_of_a_saddle_focus():
    law = lambda t: 2.0 + np.exp(-0.2 * t) * np.cos(1.3 * t + 0.4)  # noqa: E731
    pair = samples(law, 20.0, 20.4)
    limit = swinging(pair, [complex(-0.2, 1.3)])
    assert limit.rest == pytest.approx(2.0 - law(20.4), rel=1e-3)
    assert limit.swing == pytest.approx(np.exp(-0.2 * 20.4), rel=1e-3)
    assert limit.error >= limit.swing


@pytest.mark.parametrize("passes", [2, 3])
def test_the_law_of_a_round_past_several_saddle_foci_alike(passes):
    """As of a cycle that its symmetry maps to itself: each passage takes its share of the period."""
    law = lambda t: 2.0 + np.exp(-0.2 * t / passes) * np.cos(1.3 * t / passes + 0.4)  # noqa: E731
    pair = samples(law, 20.0 * passes, 20.4 * passes)
    matrix = np.array([[-0.2, -1.3, 0.0], [1.3, -0.2, 0.0], [0.0, 0.0, 0.9]])
    limit = passing(matrix, 1e-2, pair, passes=passes)
    assert limit.rest == pytest.approx(2.0 - law(20.4 * passes), rel=1e-3)
    # Where two are alike and one is passed only, the period is that one's.
    law = lambda t: 2.0 + np.exp(-0.2 * t) * np.cos(1.3 * t + 0.4)  # noqa: E731
    pair = samples(law, 20.0, 20.4)
    limit = passing(matrix, 1e-2, pair, passes=passes)
    assert limit.rest == pytest.approx(2.0 - law(20.4), rel=1e-3)


AT = {"error": 0.0, "z": np.array([2.0]), "weights": np.array([2.0])}


def place(speed):
    """A slow place with a speed, and nothing else."""
    return SlowPlace(
        ("x",),
        speed,
        1.0,
        np.zeros(1),
        np.ones(1),
        np.zeros((1, 1)),
        lambda x: x,
        lambda x: np.eye(1),
        lambda x, value: (x, np.eye(1, 2)),
    )


def bottleneck(state, value, meet=0.0):
    """The slowest place of orbits through x' = lambda - meet + x^2, y' = -y."""

    def family(x, at):
        return np.array([at - meet + x[0] ** 2, -x[1]]), np.array([[2.0 * x[0], 0.0, 1.0], [0.0, -1.0, 0.0]])

    speed = float(np.linalg.norm(family(state, value)[0]))
    fixed = lambda x: family(x, value)[0], lambda x: family(x, value)[1][:, :2]
    return SlowPlace(("x", "y"), speed, 1.0, state, np.ones(2), state[None, :], *fixed, family)


def test_the_parameter_at_which_equilibria_meet_is_told_where_an_orbit_is_slow():
    for value in (1e-4, 1e-6):
        near = bottleneck(np.array([0.3 * value, 1e-3 * value]), value)
        assert near.meeting(value, 1.0) == pytest.approx(0.0, abs=value**2)
    # Slow along a line of equilibria of a faster state, as a canard is: the parameter there tells nothing.
    slope = np.array([[0.0, 0.0, 0.0], [1.0, -1.0, 0.0]])
    line = replace(near, speed=1e-3, family=lambda x, at: (np.array([1e-3, x[0] - x[1]]), slope))
    assert line.meeting(1e-6, 1.0) is None


def test_the_law_of_a_saddle_node_that_has_gone():
    law = lambda t: 2.0 + 5.0 / (t - 3.0) ** 2  # noqa: E731
    pair = samples(law, 300.0, 310.0)
    limit, _ = inverse_square(pair)
    assert limit.rest == pytest.approx(2.0 - law(310.0), rel=1e-2)
    assert abs(limit.rest - (2.0 - law(310.0))) <= limit.error
    # Equilibria meet at lambda = 2; the least speed is what is left of its way.
    near = bottleneck(np.zeros(2), law(310.0), 2.0)
    obeyed = _gone(near, pair, 1.0).obeyed
    assert obeyed([place(near.speed * (307.0 / 297.0) ** 2)])
    assert not obeyed([place(1.01 * near.speed)])  # the least speed stays: no equilibrium has gone
    assert _gone(bottleneck(np.zeros(2), law(310.0), 1.0), pair, 1.0) is None  # they meet elsewhere


@pytest.mark.parametrize(("growth", "ends"), [(1e-3, True), (3e-2, False)])
def test_orbits_that_grow_while_their_parameter_stands_still_have_no_limit(growth, ends):
    """Lotka and Volterra's come to the saddle (0, 0) as their periods grow, and so do they, without bound."""
    saddle = np.diag([1.0, -1.0])

    def passed(period, range_):
        state = np.array([0.1, 0.1]) * np.exp(-0.5 * period) * range_
        linear = (lambda x: saddle @ x), (lambda x: saddle)
        return SlowPlace(
            ("x", "y"), 1e-3, 1.0, state, np.full(2, range_), state[None], *linear, lambda x, value: (x, x)
        )

    before, near = passed(9.0, 1.0), passed(9.5, 1.0 + growth)
    pair = Pair(np.array([9.0, 9.5]), np.array([0.0, 1e-14]), np.array([1e-15, -1e-15]))
    (law,) = _standing([near], pair, 1e-13)
    assert law.obeyed([before]) == ends
    assert law.limit.error == 1e-13
    assert _standing([near], pair, 1e-15) == []  # it moves, and another law has to tell


def test_only_an_orbit_that_creeps_is_compared_with_the_one_before():
    """Along a canard the parameter hardly moves for hundreds of points: each is looked at once."""
    asked = []
    orbits = [SimpleNamespace(**AT, tangent=np.array([1.0, 1e-12]), period=t) for t in (9.0, 10.0)]
    problem = SimpleNamespace(
        forced=False,
        eventful=False,
        discretization=SimpleNamespace(accuracy=1e-8),
        duration_gradient=lambda z: np.array([1.0, 0.0]),
        slow_places=lambda z: asked.append(z) or [place(0.5)],
    )
    assert homoclinic(problem, *orbits) is None
    assert len(asked) == 1
    assert asked[0] is orbits[1].z


def test_the_orbit_before_is_not_looked_at_while_the_limit_is_far():
    """It would have to be integrated once more, on the present steps, at every point of a long approach."""
    asked = []
    # The slope falls by a third while the period grows by a tenth: a limit 2e-5 away, far beyond 1e-7.
    pair = zip((9.0, 10.0), (3e-6, 2e-6), strict=True)
    orbits = [SimpleNamespace(**AT, tangent=np.array([1.0, slope]), period=t) for t, slope in pair]
    problem = SimpleNamespace(
        forced=False,
        eventful=False,
        discretization=SimpleNamespace(accuracy=1e-8),
        duration_gradient=lambda z: np.array([1.0, 0.0]),
        slow_places=lambda z: asked.append(z) or [place(1e-3)],
    )
    assert homoclinic(problem, *orbits) is None
    assert [z is orbits[1].z for z in asked] == [True]


@pytest.mark.parametrize(("growing", "falling"), [(0.7, 3.0), (3.0, 0.7)])
def test_the_rate_is_that_of_the_slowest_direction_of_a_saddle(growing, falling):
    """Whether the orbit leaves it slowly or comes to it slowly; faster directions tell nothing."""
    law = lambda t: 2.0 + 3.0 * np.exp(-0.7 * t)  # noqa: E731
    pair = samples(law, 10.0, 10.5)
    jacobian = np.diag([growing, 5.0, -falling, -6.0])
    limit = passing(jacobian, 1e-2, pair)
    assert limit.rest == pytest.approx(2.0 - law(10.5), rel=1e-4)  # slopes by differences of 1e-6
    assert passing(np.diag([-0.7, -3.0]), 1e-2, pair) is None  # nothing leaves a sink


def test_a_focus_that_draws_in_is_no_limit_of_orbits_with_events():
    """Two slopes always fit a swing; what a sink has drawn in does not leave it again."""
    pair = samples(lambda t: 2.0 + 3.0 * np.exp(-0.3 * t), 20.0, 24.0)
    focus = np.array([[-0.005, 0.06], [-0.06, -0.005]])
    assert passing(focus, 1e-2, pair, eventful=True) is None


def test_past_a_saddle_an_orbit_comes_nearer_as_both_its_rates_say():
    """Else the parameter stands still for another reason, whatever rate it has, as along a canard."""
    repels, draws, lasting = 3.0, 0.7, 0.5
    # x' = 3 x, y' = -0.7 y from y = 1 to x = 1 in a time T: how near to the saddle it is at least.
    times = np.linspace(0.0, 10.0, 400001)
    nearest = [
        np.hypot(np.exp(repels * (times - passing)), np.exp(-draws * times)).min()
        for passing in (10.0, 10.0 + lasting)
    ]
    pair = samples(lambda t: 2.0 + 3.0 * np.exp(-draws * t), 10.0, 10.0 + lasting)
    saddle = np.diag([repels, -draws])
    law = _passing(beside(saddle, nearest[1]), pair, False, 1)
    assert law.obeyed([beside(saddle, nearest[0]).place])
    assert np.log(nearest[0] / nearest[1]) / lasting == pytest.approx(
        repels * draws / (repels + draws), rel=1e-6
    )
    assert not law.obeyed([beside(saddle, nearest[1]).place])
    assert not law.obeyed([beside(saddle, nearest[0] ** 2 / nearest[1]).place])  # twice as fast
    assert not law.obeyed([])


def test_on_the_way_to_a_saddle_the_rate_is_not_yet_the_saddles():
    """Along a canard: the slope falls at the rate 0.38 - 0.3 exp(-T / 100), which grows to 0.38."""
    slope = lambda t: -np.exp(-0.38 * t - 30.0 * np.exp(-0.01 * t))  # noqa: E731
    times = np.linspace(60.0, 200.0, 400001)
    way = float(np.trapezoid(slope(times), times))
    pair = Pair(np.array([55.0, 60.0]), np.zeros(2), np.array([slope(55.0), slope(60.0)]))
    law = _coming(beside(np.diag([0.38, -0.01])), pair, True)
    assert abs(law.limit.rest - way) <= law.limit.error < abs(way)
    assert law.obeyed([beside(np.diag([0.38, -0.01]), 1e-2 * np.exp(0.01 * 5.0)).place])
    assert _coming(beside(np.diag([-0.38, -0.01])), pair, True) is None  # a sink is not left
    assert _coming(beside(np.diag([0.38, -0.5])), pair, True) is None  # the way to it would be the faster one
    assert _coming(beside(np.diag([0.1, -0.01])), pair, True) is None  # nothing repels more than the saddle


def test_a_saddle_that_is_left_far_faster_than_it_is_come_to_draws_the_parameter_at_twice_the_rate():
    """Plant's burster: the square of how it comes, exp(-2 * 2.9e-4 t), is more than what is linear in it."""
    rate, periods = 2.9e-4, np.array([22500.0, 22560.0])
    parts = np.array([1e-8 * np.exp(-rate * periods), 1e-4 * np.exp(-2.0 * rate * periods)])
    pair = Pair(periods, np.zeros(2), -rate * (parts[0] + 2.0 * parts[1]))
    saddle = np.diag([0.0994, -rate, -0.0141])
    law = _coming(beside(saddle), pair, False)
    assert abs(law.limit.rest + parts[:, 1].sum()) <= law.limit.error
    assert law.obeyed([beside(saddle, 1e-2 * np.exp(rate * 60.0)).place])
    assert _coming(beside(np.diag([-0.0994, -2.9e-4])), pair, False) is None  # a sink is not left
    assert _coming(beside(np.diag([2e-3, -2.9e-4])), pair, False) is None  # it is not left far faster
    assert _coming(beside(np.diag([0.0994, -1e-4])), pair, False) is None  # too fast: still a canard
    assert _coming(beside(np.diag([0.0994, -1e-3])), pair, False) is None  # nor does it fall as fast as that


def test_an_orbit_that_does_not_come_nearer_is_on_no_way_to_a_saddle():
    """The rates are right and the saddle is near, but the least distance stays: a canard that will turn."""
    pair = samples(lambda t: 2.0 + 3.0 * np.exp(-0.3 * t), 20.0, 24.0)
    at = lambda distance: beside(np.diag([0.38, -0.01]), distance).place  # noqa: E731
    laws = {law.where: law for law in _laws([at(0.1)], pair, eventful=True, size=1.0)}
    law = laws["the equilibrium x0 = 0, x1 = 0"]
    assert law.obeyed([at(0.1 * np.exp(0.04))])
    assert not law.obeyed([at(0.1)])
    assert not law.obeyed([at(0.1 * np.exp(0.4))])
    assert not law.obeyed([])
