"""The branch of cycles that leaves a Hopf point of equilibria, along its critical vectors."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.numerics.linear import EPSILON
from contwalk.problems.equilibrium.equilibrium_equations import EquilibriumEquations
from contwalk.problems.equilibrium.points.cycle_sizes import CycleSizes
from contwalk.problems.equilibrium.points.several_waves import waves_at
from contwalk.problems.held_quantities import HeldQuantity
from contwalk.problems.images import imaged
from contwalk.problems.kept_spaces import keeps, linear_image
from contwalk.problems.neutral import generator_at
from contwalk.problems.orbit import equations
from contwalk.problems.orbit.closure import order_of
from contwalk.problems.orbit.periodic_orbit import PeriodicOrbit
from contwalk.problems.orbit.remesh import mesh_for
from contwalk.problems.orbit.section import section_at
from contwalk.problems.orbit.transport import segments_for, segments_of_growth
from contwalk.problems.problem import Seed
from contwalk.system.declarations import ParameterValues

# Parts of its multiples beyond whole numbers have no pattern.
GOLDEN = 0.5 * (1.0 + 5.0**0.5)
# Units are smaller by this part: rounding is this part of it again, thrice.
UNLIKE = EPSILON**0.25


def from_hopf(equilibrium: EquilibriumEquations, point: SpecialPoint) -> Sequence[Seed]:
    """The cycles that are born at a Hopf point, along its critical vectors.

    Where several pairs pass at once, there is one for each way in which a symmetry turns them, and where none
    does, for each wave that the normal form of all pairs tells.
    """
    waves = waves_at(equilibrium, np.array(point.unknowns), float(point.coefficients["omega"]))
    return [_along(equilibrium, point, vector) for vector in ([None] if waves is None else waves.vectors)]


def _along(equilibrium: EquilibriumEquations, point: SpecialPoint, vector: np.ndarray | None) -> Seed:
    """The cycle that is born along a critical vector, shape (n,); along the only one, if none is given."""
    n, z = equilibrium.states, np.array(point.unknowns)
    omega = float(point.coefficients["omega"])
    sizes = CycleSizes(equilibrium, point, vector)
    magnitudes = sizes(abs(float(z[-1])) or 1.0)
    # In like units a circle, as two equal masses make, is at a right angle in any phase.
    weights = _without_pattern(equilibrium.system.state_names)
    units = magnitudes * (1.0 - UNLIKE * weights)
    q = _turned(sizes.right, units, weights)
    known = equilibrium.values_of(z)
    own = {name: known[name] for name in equilibrium.system.conserved_names}
    # Orbits hold what is conserved by a term of their own, without a drift.
    pins = [pin for pin in equilibrium.pins if not isinstance(pin, HeldQuantity)]
    orbit = PeriodicOrbit(
        equilibrium.system,
        equilibrium.parameters | own,
        equilibrium.free,
        equilibrium.line.ends,
        pins=pins,
        reference=equilibrium.reference,
        discretization=equilibrium.discretization,
    )
    x, period = z[:n], 2.0 * np.pi / omega
    closing = _symmetry_of_cycle(equilibrium, x, z, q)
    if closing is not None:
        orbit = orbit.closing(np.zeros(n), *closing)
        period /= closing[2]
    scalars = np.concatenate([[period], np.zeros(len(pins)), z[-1:]])
    section = section_at(x, (1j * omega * q).real, units)

    def cut(m: int) -> tuple[PeriodicOrbit, np.ndarray, np.ndarray]:
        start = orbit.layout.joined(np.tile(x, m), scalars, np.arange(m) / m)
        fitting = orbit.fitting(start)
        mesh = mesh_for(fitting, start, fitting.weighted(units), orbit.discretization.walking)
        problem, turns = orbit.on(mesh, section), np.exp(1j * omega * period * np.arange(m) / m)
        tangent = orbit.layout.joined((q * turns[:, None]).real, np.zeros(len(scalars)))
        return problem, start, tangent - _along_pins(problem, start, tangent)

    # The linear flow is known: what grows too much is not integrated in one piece to find that out.
    exponents = np.linalg.eigvals(equilibrium.jacobian(z)[:n, :n]).real * period
    m = orbit.discretization.segments or segments_of_growth(float(exponents.max()))
    problem, start, tangent = cut(m)
    more = max(m, segments_for(problem, start))
    if more > m:
        m = more
        problem, start, tangent = cut(m)

    def reach(change: float) -> np.ndarray:
        moved = np.zeros(len(start))
        moved[: m * n] = np.tile(sizes(change) * np.sqrt(m), m)
        moved[-1] = change
        return moved

    return Seed("HB", start, tangent, reach, problem, one_sided=True)


def _along_pins(problem: PeriodicOrbit, start: np.ndarray, tangent: np.ndarray) -> np.ndarray:
    """The part of a tangent at an equilibrium that moves the orbit along pinned directions: all of it at
    once, as they are neutral there.
    """
    part, n, m = np.zeros(len(start)), problem.states, problem.mesh.segments
    if problem.pins:
        rows = np.zeros((len(problem.pins), len(start)))
        for pin, row in zip(problem.pins, rows, strict=True):
            equations.pinned(problem, pin, start, row)
        values = problem.values_of(start)
        ways = np.column_stack([generator_at(pin, start[:n], values) for pin in problem.pins])
        part[: m * n] = np.tile(ways @ np.linalg.solve(rows[:, :n] @ ways, rows @ tangent), m)
    return part


def _turned(q: np.ndarray, units: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """q, shape (n,), in the phase in which its real and imaginary parts are at a right angle in these units.

    The longer one is first. Of the two opposite phases it is that of the larger weighted mean.
    """
    scaled = q / units
    turn = np.exp(-0.5j * np.angle(complex(scaled @ scaled)))
    return q * (turn if (complex(weights @ scaled) * turn).real > 0.0 else -turn)


def _without_pattern(names: Sequence[str]) -> np.ndarray:
    """Numbers between 0 and 1, shape (n,), one for each state, whatever the order that they stand in."""
    return (np.argsort(np.argsort(names)) + 1.0) * GOLDEN % 1.0


def _symmetry_of_cycle(
    equilibrium: EquilibriumEquations, x: np.ndarray, z: np.ndarray, q: np.ndarray
) -> tuple[str, int, int] | None:
    """Symmetry, power and order of a cycle whose critical vector a spatial symmetry turns by a part of a
    round.

    S q = exp(-2 pi i j / order) q: the cycle is its own image a part of the period later.
    """
    p = ParameterValues(**equilibrium.values_of(z))
    for symmetry in equilibrium.system.symmetries:
        order = order_of(symmetry, x, p)
        if symmetry.role != "spatial" or order is None or order < 2:
            continue
        image = partial(imaged, symmetry, parameters=p)
        if not keeps(image, x):
            continue
        moved = linear_image(image, x, np.column_stack([q.real, q.imag])) @ [1.0, 1.0j]
        ratio = complex(q.conj() @ moved) / complex(q.conj() @ q)
        for power in range(1, order):
            turned = ratio**power
            if abs(turned - np.exp(-2j * np.pi / order)) < 1e-6:
                return symmetry.name, power, order
    return None
