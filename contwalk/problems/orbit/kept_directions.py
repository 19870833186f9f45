"""Directions in a critical space that symmetries keep: branches leave along them, to all orders.

Where a symmetry makes several eigenvalues critical together, any vector of their space is an eigenvector. One
that an image turns by a factor of its own is what deviations of solutions with less symmetry begin as: at a
multiplier of 1 one that it keeps, at -1 one that it reverses as well, a closure later (equivariant branching
lemma; M. Golubitsky, I. Stewart & D. G. Schaeffer, 1988, chapters XIII and XVIII).
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np

from contwalk.numerics.linear import EPSILON
from contwalk.numerics.permutations import Permutation, automorphisms
from contwalk.problems.images import products
from contwalk.problems.kept_spaces import SAME, Map, keeps, linear_image, turned
from contwalk.problems.orbit import monodromy
from contwalk.problems.orbit.discretized_orbit import DiscretizedOrbit
from contwalk.problems.orbit.itinerary import imaged_leg
from contwalk.problems.orbit.scales import cycle_scales
from contwalk.problems.orbit.shooting import velocity
from contwalk.problems.orbit.variations import cycle_matrix
from contwalk.system import Symmetry
from contwalk.system.declarations import ParameterValues


def kept_directions(
    problem: DiscretizedOrbit, z: np.ndarray, multiplier: float, count: int
) -> tuple[list[np.ndarray], list[Permutation]]:
    """Critical directions of an orbit that its symmetries keep, of which none is the image of another one.

    With them the permutations of its states that nobody declared, if none that is declared keeps the orbit.

    z has the shape (N + 1,), each direction (N,); `count` multipliers are at `multiplier`.
    """
    x = problem.first_state(z)
    if len(problem.passages[0].states) < len(x):
        return [], []
    rows, columns = cycle_scales(problem)
    matrix = cycle_matrix(problem, problem.linearize(z).jacobian, multiplier)
    space = columns[:, None] * np.linalg.svd(matrix / rows[:, None] * columns)[2][-count:].T
    scale, starts = problem.mesh.variation, space[problem.layout.states[0]]
    flow = monodromy.flow_direction(problem, z, 0)[: len(x)]
    declared = [each for each in _declared(problem, z) if keeps(each[0], x)]
    orders = [] if declared else _undeclared(problem, z)
    # What closes up to a symmetry needs one that has a name: its orbits lie in no space that it keeps.
    images = [(linear_image(image, x, starts), named) for image, named in declared]
    images += [(starts[list(order)], False) for order in orders]
    units, found = scale[:, None], list[np.ndarray]()
    each = [turned(starts / units, own / units, flow / scale) for own, _ in images]
    turns = [turn for turn, _ in each]
    for (_, vectors), (_, named) in zip(each, images, strict=True):
        for ratio, share in vectors:
            if abs(ratio - 1.0) > SAME and not (named and abs(ratio - multiplier) <= SAME):
                continue
            a = share.real / np.linalg.norm(share.real)
            known = [w / np.linalg.norm(w) for b in found for w in (b, *(turn @ b for turn in turns))]
            if all(abs(a @ w) < 1.0 - SAME for w in known):
                found.append(a)
    return [space @ a for a in found], orders


def _declared(problem: DiscretizedOrbit, z: np.ndarray) -> Iterator[tuple[Map, bool]]:
    """The products of declared spatial symmetries that take each leg to itself, and whether one is alone."""
    system, p = problem.system, ParameterValues(**problem.values_of(z))

    def kept(symmetry: Symmetry) -> bool:
        legs = problem.itinerary.legs
        return symmetry.role == "spatial" and legs == tuple(
            imaged_leg(system, symmetry.name, x) for x in legs
        )

    for product in products(system, problem.first_state(z), p):
        if all(map(kept, product.symmetries)):
            yield partial(product.state, p=p), len(product.symmetries) == 1


def _undeclared(problem: DiscretizedOrbit, z: np.ndarray) -> list[Permutation]:
    """Permutations of the states of an orbit without events that keep it, and the field beside it."""
    if problem.itinerary.eventful or not problem.itinerary.single:
        return []
    n, x, passage = problem.states, problem.first_state(z), problem.passages[0]
    whole = monodromy.once_round(problem, problem.jacobian(z), 0)[:n, :n]
    values = np.concatenate([problem.layout.inputs(0, z)[1], problem.line.constants])
    scale = problem.mesh.variation

    beside = x + 0.1 * scale * np.cos(np.arange(1.0, n + 1.0))  # no permutation keeps that
    here = velocity(passage, beside, 0.3, values)

    def keeps_field(order: Permutation) -> bool:
        off = velocity(passage, beside[list(order)], 0.3, values) - here[list(order)]
        return bool(np.abs(off).max() <= SAME * np.abs(here).max())

    rounded = np.where(np.abs(x) <= EPSILON * scale, 0.0, x)
    return [order for order in automorphisms(whole, rounded) if keeps_field(order)]
