"""Multipliers of given factors: the quotient by neutral directions, order, units and unstable counts."""

import numpy as np
import pytest

from contwalk.problems.orbit.multipliers import Multipliers, multipliers
from contwalk.problems.orbit.observing import split, whole_of
from contwalk.problems.orbit.periodic_schur import product

ONE = np.ones(3)
NOTHING = np.zeros((3, 0))


def similar(values, seed):
    random = np.random.default_rng(seed)
    v = random.standard_normal((len(values), len(values)))
    return v @ np.diag(values) @ np.linalg.inv(v), v


def test_all_of_a_forced_system_by_descending_modulus():
    matrix, _ = similar([0.5, -3.0, 1.25], 1)
    found = multipliers([matrix], [NOTHING], ONE, 1e-10)
    np.testing.assert_allclose(found.values, [-3.0, 1.25, 0.5], rtol=1e-12)
    np.testing.assert_allclose(found.measures, [2.0, 0.25, -0.5], rtol=1e-12)
    assert found.unstable(None) == 2


@pytest.mark.parametrize("segments", [1, 2, 5])
def test_the_flows_own_multiplier_is_left_out_and_never_another_one(segments):
    """Also where another one is nearly one, and where the velocity is not at a right angle to the others."""
    random = np.random.default_rng(segments)
    values = np.array([1.0, 1.0 + 1e-7, 0.3])
    frames = [random.standard_normal((3, 3)) for _ in range(segments)]
    parts = [np.array([1.0, 1.0, 1.0])] * (segments - 1) + [values]
    factors = [
        frames[(i + 1) % segments] @ np.diag(parts[i]) @ np.linalg.inv(frames[i]) for i in range(segments)
    ]
    neutral = [frame[:, :1] for frame in frames]
    found = multipliers(factors, neutral, ONE, 1e-12)
    # Roundings of the products, times the conditions of random frames.
    np.testing.assert_allclose(found.values, [1.0 + 1e-7, 0.3], rtol=0, atol=1e-10)


def test_units_do_not_matter():
    matrix, v = similar([1.0, -0.9, 0.2], 3)
    units = np.array([1e-8, 1.0, 1e9])
    there = matrix * units[:, None] / units
    plain = multipliers([matrix], [v[:, :1]], ONE, 1e-10)
    scaled = multipliers([there], [units[:, None] * v[:, :1]], units, 1e-10)
    np.testing.assert_allclose(scaled.values, plain.values, rtol=1e-12)
    np.testing.assert_allclose(scaled.errors, plain.errors, rtol=1e-6)


@pytest.mark.parametrize("segments", [1, 3])
def test_complex_pairs_are_exact_and_the_upper_one_comes_first(segments):
    turn = np.array([[0.8, -0.7, 0.0], [0.7, 0.8, 0.0], [0.3, 0.1, 0.5]])
    random = np.random.default_rng(segments)
    frames = [random.standard_normal((3, 3)) for _ in range(segments)]
    factors = [frames[(i + 1) % segments] @ turn @ np.linalg.inv(frames[i]) for i in range(segments)]
    found = multipliers(factors, [NOTHING] * segments, ONE, 1e-10)
    np.testing.assert_allclose(found.values[0], (0.8 + 0.7j) ** segments, rtol=1e-12)
    assert found.values[1] == np.conj(found.values[0])


def test_nothing_is_left_of_one_state():
    found = multipliers([np.eye(1)], [np.ones((1, 1))], np.ones(1), 1e-10)
    assert found.values.shape == (0,)
    assert found.unstable(None) == 0


def test_doubtful_ones_count_as_at_the_neighbour():
    values = np.array([1.5, 1.0 + 1e-12, 0.5], dtype=complex)
    found = Multipliers(values, np.full(3, 1e-9), 1e-9)
    assert found.unstable(2) == 2
    assert found.unstable(1) == 1
    assert found.unstable(None) == 1


def test_doubtful_ones_beside_pairs_count_as_at_the_neighbour_too():
    """A pair on the circle never counts, however little is known of it; a pair off it does."""
    values = np.array([1.0 + 1e-12, 0.6 + 0.8j, 0.6 - 0.8j, 0.5], dtype=complex)
    paired = np.array([False, True, True, False])
    found = Multipliers(values, np.full(4, 1e-9), 1e-9, paired)
    assert [found.unstable(before) for before in (None, 0, 1, 2)] == [0, 0, 1, 1]
    values = np.array([2.0, 1.0 + 1e-12, 0.5], dtype=complex)
    found = Multipliers(values, np.full(3, 1e-9), 1e-9, np.array([True, False, True]))
    assert [found.unstable(before) for before in (None, 0, 1, 2, 3)] == [1, 1, 1, 2, 2]


def test_what_is_not_known_to_its_size_is_not_counted_as_unstable():
    found = Multipliers(np.array([6e6 + 0j, 0.1 + 0j]), np.array([1e-8, 1e-14]), 3.6)
    assert found.unstable(0) == found.unstable(None) == 1
    doubted = found.doubted(2e7)
    assert doubted.accuracy == 2e7
    assert doubted.unstable(0) == doubted.unstable(None) == 0
    assert doubted.unstable(1) == 1  # as at the neighbouring point


@pytest.mark.parametrize("segments", [1, 3])
def test_what_grows_along_the_flow_is_left_out_at_the_state_that_it_arrives_at(segments):
    """A gap of 1e-4 between end and start turns the velocity by as much. Of deviations that grow a
    millionfold along it, the next start's velocity leaves over 100 in each segment, where there is 0.7."""
    gap, growth, own = 1e-4, 1e6, 0.7
    start = np.array([[1.0], [0.0]])
    end = np.array([[np.cos(gap)], [np.sin(gap)]])
    aside = np.array([[-np.sin(gap)], [np.cos(gap)]])
    factor = end @ np.array([[1.0, growth]]) + aside @ np.array([[0.0, own]])
    found = multipliers([factor] * segments, [start] * segments, np.ones(2), 1e-6, [end] * segments)
    # The cosine of the gap, and rounding of the growth.
    assert found.values[0].real == pytest.approx(own**segments, rel=segments * gap**2)
    rounding = abs(found.values[0].real - (own * np.cos(gap)) ** segments)
    assert rounding <= found.errors[0] <= 1e-6
    seen_from_the_start = multipliers([factor] * segments, [start] * segments, np.ones(2), 1e-6)
    assert seen_from_the_start.values[0].real > 99.0**segments


def one_that_forgets(own, error):
    """Two segments: deviations grow a millionfold beside the flow, which is an axis; then everything comes to
    lie along the flow, but for `own` of what is beside it, and for an error of the direction."""
    grows = np.diag([1.0, 1e6])
    along, aside = np.array([1.0, error]), np.array([0.0, 1.0])
    return [grows, np.outer(along, [1.0, 1e3]) + own * np.outer(aside, [0.0, 1.0])]


def flow_of(factors):
    axis = np.array([[1.0], [0.0]])
    return multipliers(factors, [axis, axis], np.ones(2), 1e-6, [axis, axis])


def test_a_multiplier_that_is_nothing_but_errors_is_not_known_to_its_size():
    """An orbit that passes a saddle for long after it has forgotten where it came from: the product is 1e-24,
    and an error of 2.5e-9 in the direction that a thousandfold growth has makes it 2.5."""
    found = flow_of(one_that_forgets(1e-30, 2.5e-9))
    assert found.values[0].real == pytest.approx(2.5, rel=1e-6)
    assert found.accuracy >= 2.4
    assert (found.unstable(0), found.unstable(1), found.unstable(None)) == (0, 1, 0)


def test_a_multiplier_with_a_small_error_is_known_with_it():
    found = flow_of(one_that_forgets(2e-6, 1e-12))
    assert found.values[0].real == pytest.approx(2.0, rel=1e-3)
    # 1e6 1e3 1e-12 at least; the tolerance itself may do thirty times that.
    assert 0.99e-3 <= found.accuracy <= 0.1
    assert found.errors[0] <= 1e-9
    assert found.unstable(0) == 1


@pytest.mark.parametrize("segments", [1, 3])
def test_what_steps_leak_into_the_flow_is_told_and_costs_no_second_set_of_eigenvectors(segments, monkeypatch):
    """Moduli of the quotient by what factors carry along, instead of by what is there: of plain matrices."""
    asked = []
    monkeypatch.setattr(np.linalg, "eig", lambda m, plain=np.linalg.eig: asked.append(1) or plain(m))
    random = np.random.default_rng(segments)
    flows = [random.standard_normal((3, 1)) for _ in range(segments)]
    ahead = flows[1:] + flows[:1]
    factors = []
    for here, there in zip(flows, ahead, strict=True):
        rest = 0.4 * random.standard_normal((3, 3))
        carried = there + 1e-3 * random.standard_normal((3, 1))  # the gap of coarse steps
        onto = here.T / (here.T @ here)
        factors.append(rest @ (np.eye(3) - here @ onto) + carried @ onto)
    found = multipliers(factors, flows, ONE, 1e-12, arriving=ahead)
    assert len(asked) <= 1

    def moduli(ends):
        bases = [np.linalg.svd(flow)[0][:, 1:] for flow in flows]
        product = np.eye(2)
        for k, factor in enumerate(factors):
            unit = ends[k] / np.linalg.norm(ends[k])
            across = (np.eye(3) - unit @ unit.T) @ factor @ bases[k]
            product = bases[(k + 1) % segments].T @ across @ product
        return np.sort(np.abs(np.linalg.eigvals(product)))[::-1]

    exact = moduli(ahead)
    np.testing.assert_allclose(np.abs(found.values), exact, rtol=1e-9)
    leak = np.abs(exact - moduli([factor @ flow for factor, flow in zip(factors, flows, strict=True)]))
    assert found.accuracy == pytest.approx(leak[0], rel=1e-6)


def test_a_double_multiplier_of_zero_is_no_warning():
    """Its eigenvectors are one but for the least number there is, and their condition is infinite."""
    found = multipliers([np.array([[0.0, 1.0], [0.0, 0.0]])], [np.zeros((2, 0))], np.ones(2), 1e-10)
    np.testing.assert_array_equal(found.values, 0.0)
    assert np.isfinite(found.errors).all()


def test_what_no_number_holds_is_infinite_without_a_warning():
    """NumPy warned in the middle of a run, or Python ended it: pushes of e^400 over one of two halves."""
    half = np.diag([1e200, 0.5])
    assert product([half, half])[0, 0] == np.inf
    assert split(np.array([1e200, 1.0])) == np.inf
    assert whole_of(1e200, 2) == np.inf
    assert whole_of(3.0, 2) == 9.0
