"""Closures up to a symmetry: images, orders, lifts of the map, turns of angles."""

import math
from itertools import pairwise

import numpy as np
import pytest
from small_systems import small_system

import contwalk as cw
from contwalk.problems.orbit.closure import closure_image, imaged, order_of
from contwalk.problems.orbit.itinerary import Itinerary, Leg
from contwalk.problems.orbit.lifts import JET, MIXED, PLAIN, TANGENT
from contwalk.problems.orbit.passage import closure_of
from contwalk.problems.orbit.piece import Piece
from contwalk.problems.orbit.traced_leg import Closing, ScalarInputs
from contwalk.system import Symmetry
from contwalk.system.declarations import ParameterValues


def third(t, x, p, image):
    """A turn by 120 degrees about the origin, bent by a change of coordinates that the parameter sets."""
    u, v = x[0], x[1] - p.lam * x[0] * x[0]
    c, s = -0.5, math.sqrt(0.75)
    image[0] = c * u - s * v
    image[1] = s * u + c * v + p.lam * (c * u - s * v) ** 2


def field(t, x, p, dx):
    dx[0] = -x[1] * p.lam
    dx[1] = x[0]


TURN = Symmetry("turn", "spatial", third)
SYSTEM = small_system(field, "xy", {"lam": 0.3}, symmetries=(TURN,))
P = ParameterValues(lam=0.3)


@pytest.fixture
def passage():
    return closure_of(SYSTEM, ScalarInputs("lam"), Closing("turn"))


def test_the_order_of_a_symmetry():
    assert order_of(TURN, np.array([0.3, 0.1]), P) == 3
    shift = Symmetry("shift", "spatial", lambda t, x, p, image: image.__setitem__(slice(None), x + 1.0))
    assert order_of(shift, np.array([0.3, 0.1]), P) is None


def test_powers_of_images():
    x = np.array([0.4, -0.7])
    once = imaged(TURN, x, P)
    np.testing.assert_allclose(imaged(TURN, once, P, 2), x, rtol=0, atol=1e-15)
    assert np.array_equal(imaged(None, x, P), x)


def values(lam, *directions):
    """T, the free parameter, all parameters and their changes along a path, directions of the lift."""
    return np.concatenate([[1.0, lam], [lam], [0.0], *directions])


def test_the_closures_of_a_motion_follow_each_other():
    """S x(T) = x(0): where the next piece is at its beginning, the last one was at its end."""
    end = np.array([0.9, 0.2])
    start = imaged(TURN, end, P)
    piece = np.array([start, end])
    word = Itinerary((Leg("all"),), "turn", 1, 3)
    whole = [closure_image(SYSTEM, word, piece, P, number) for number in range(word.closures)]
    assert len(whole) == 3
    for before, after in pairwise(whole):
        np.testing.assert_allclose(after[0], before[-1], rtol=0, atol=1e-15)
    np.testing.assert_allclose(whole[-1][-1], start, rtol=0, atol=1e-15)


def test_lifts_of_the_map_are_its_derivatives(passage):
    """Against central differences, whose error with a step of 1e-4 is 1e-8 of the third derivatives."""
    lam, x = 0.3, np.array([0.4, -0.7])
    v, w = np.array([0.2, 1.1]), 0.7  # directions of state and parameter
    h = 1e-4

    def at(s):
        return imaged(TURN, x + s * v, ParameterValues(lam=lam + s * w))

    first = (at(h) - at(-h)) / (2 * h)
    second = (at(h) - 2 * at(0.0) + at(-h)) / h**2
    own = np.array([0.0, w])  # of T and lam

    def image(lift, y, given):
        map_ = passage.end(lift)
        return map_(1.0, y, map_.constants(given))

    assert np.array_equal(image(PLAIN, x, values(lam)), at(0.0))
    tangent = image(TANGENT, np.concatenate([x, v]), values(lam, own))
    np.testing.assert_allclose(tangent[2:], first, rtol=0, atol=1e-7)
    mixed = image(MIXED, np.concatenate([x, v, v, np.zeros(2)]), values(lam, own, own))
    np.testing.assert_allclose(mixed[6:], second, rtol=0, atol=1e-6)
    still = np.zeros(2)
    jet = image(JET, np.concatenate([x, v, still, still]), values(lam, own, still, still))
    np.testing.assert_allclose(jet[2:4], first, rtol=0, atol=1e-7)
    np.testing.assert_allclose(jet[4:6], second, rtol=0, atol=1e-6)


def test_columns_are_carried_through_the_map(passage):
    lam, x, h = 0.3, np.array([0.4, -0.7]), 1e-5
    columns = np.array([[1.0, 0.0, 0.2, 0.3], [0.0, 1.0, 0.5, 0.1]])  # the last two are those of T and lam
    piece = Piece(passage, np.array([0.0, 1.0]), "dop853", values(lam)[2:])
    end, moved = piece.through(PLAIN, x, columns, values(lam))
    for j in range(4):
        up = imaged(TURN, x + h * columns[:, j], ParameterValues(lam=lam + h * (j == 3)))
        down = imaged(TURN, x - h * columns[:, j], ParameterValues(lam=lam - h * (j == 3)))
        np.testing.assert_allclose(moved[:, j], (up - down) / (2 * h), rtol=0, atol=1e-8)
    assert np.array_equal(end, imaged(TURN, x, P))


def test_turns_of_angles_are_taken_off():
    problem, turns = cw.PeriodicOrbit(SYSTEM, SYSTEM.defaults(), "lam"), np.array([0.0, 2 * math.pi])
    z = np.array([1.0, 7.0, 2.0, 0.3])
    there = problem.adapted_to(z, np.ones(4))
    turned = problem.closing(turns).adapted_to(z, np.ones(4))
    gap = there.linearize(z).residual - turned.linearize(z).residual
    np.testing.assert_allclose(gap, [*turns, 0.0], rtol=0, atol=1e-13)
    assert turned.whole == ("full", 1)
