"""Curves of cycles that are born at special points of curves of equilibria: GH, HH and ZH.

At a generalized Hopf point r' = r (mu + c1 r^2 + l2 r^4) with mu = c1 = 0: cycles of the amplitude r
fold where c1 = -2 l2 r^2 and mu = l2 r^4 (Kuznetsov 2004, section 8.3). Beside the point, on the side of the
curve of Hopf points where c1 has the other sign than l2, a cycle of that amplitude is a fold to fourth order.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.linalg import norm

from contwalk.branch import SpecialPoint
from contwalk.errors import StartError
from contwalk.numerics.linear import kernel_direction
from contwalk.problems.equilibrium.equilibrium import Equilibrium
from contwalk.problems.equilibrium.points.hopf import Hopf
from contwalk.problems.locus.doubled_orbits import BornOrbits, amplitude_of_neutral, born_beside
from contwalk.problems.locus.lines import whole_plane
from contwalk.problems.locus.normal_forms import cubic_rate
from contwalk.problems.locus.orbit_places import OrbitPlane
from contwalk.problems.locus.points.point import sizes
from contwalk.problems.orbit.branching import filled_magnitudes
from contwalk.problems.problem import Seed

# How far along the curve of Hopf points the first cycle is looked for, in the metric; the first that is found
# counts. Nearer its fold is lost in that of the point itself.
ASIDE = (1e-2, 3e-3, 3e-2, 1e-3, 1e-1, 3e-4)
# Folds beside a point that lies so near to another one, as to a zero-Hopf point, that l2 is another there.
NEARER = (1e-4, 3e-5, 1e-5, 3e-6, 1e-6)
# A fold is another one too if its parameters are off by more than this part of how far from the point they
# are: that is of the size of r^2 with the amplitude r, and they are off by that of r^4.
OFF = 0.25
# Tori are found nearer, and what lies between the point and the first one is lost.
BESIDE = (1e-3, 3e-4, 3e-3, 1e-2, 3e-2, 1e-1)
# At double and zero-Hopf points: the amplitude of the first of two cycles, over the root of how far aside.
AMPLITUDE = 0.3
# A parameter is no smaller than this part of half its range.
SHARE = 1e-2


def folds_of_cycles(problem: Any, point: SpecialPoint) -> Sequence[Seed]:
    """The curve of folds of cycles that is born at a generalized Hopf point.

    Raises
    ------
    StartError
        If none is found: there is one wherever l2 is not zero.
    """
    z, l2 = np.array(point.unknowns), float(point.coefficients["l2"])
    lengths, count = (*ASIDE, *NEARER), _unstable(problem, z)

    def fold(beside: np.ndarray, aside: float) -> Seed | None:
        # Beyond another special point, as a zero-Hopf point where c1 has a pole, it tells nothing.
        return _fold(problem, beside, l2, z[-2:]) if _unstable(problem, beside) == count else None

    found = _found_beside(problem, z, fold, lengths)
    if not found:
        raise StartError(
            "No fold of the cycles that begin beside this point was found.",
            "Continue the cycles of a Hopf point beside it: the curve can be begun at a fold of theirs.",
        )
    return found


def _found_beside(
    problem: Any, z: np.ndarray, born: Callable[[np.ndarray, float], Seed | None], lengths: Sequence[float]
) -> Sequence[Seed]:
    """As `born_beside`, of a curve of Hopf points."""
    there = problem.at(z)
    return born_beside(there, z, sizes(there, z), lengths, born)


def _unstable(problem: Any, z: np.ndarray) -> int:
    """How many eigenvalues are unstable at z, shape (N + 1,), on a curve of Hopf points, but for its pair."""
    there = problem.at(z)
    weights, lin = sizes(there, z), there.linearize(z)
    tangent = kernel_direction(lin.jacobian, weights)
    return int(there.examine(z, tangent, weights, lin, None).unstable)


def _fold(problem: Any, z: np.ndarray, l2: float, origin: np.ndarray) -> Seed | None:
    """The fold of cycles beside a Hopf point at z, shape (N + 1,) of its curve.

    `origin` are the second and the first parameter at the generalized Hopf point, shape (2,).
    """
    rate = _cubic_rate(problem, z)
    if not rate * l2 < 0.0:
        return None
    cycles = _Cycles(problem, z)
    expected = cycles.amplitude(float(np.sqrt(-rate / (2.0 * l2))))
    found = cycles.curve("LP", cycles.of(expected), expected, origin)
    if found is None:
        return None
    off, aside = (found.z[-2:] - cycles.place) / cycles.typical, (cycles.place - origin) / cycles.typical
    return found if norm(off) <= OFF * norm(aside) else None


class _Cycles(BornOrbits):
    """The cycles that are born at a Hopf point, on a line across the curve of these: along it none grows.

    Parameters
    ----------
    problem : EquilibriumLocus
        The curve of Hopf points.
    z : ndarray, shape (N + 1,)
        One of its solutions.
    lean : float
        How much the line leans along the curve.
    """

    within = (0.8, 1.25)  # below it is no cycle, above it another one

    def __init__(self, problem: Any, z: np.ndarray, lean: float = 0.0) -> None:
        values, free = problem.values_of(z), (problem.free, str(problem.plane.second))
        least = SHARE * np.array((1.0, 1.0) if problem.spans is None else problem.spans)
        typical = np.maximum([abs(values[name]) for name in reversed(free)], least)
        seed = _cycles(problem, z, problem.kappa(z), _cubic_rate(problem, z))
        assert seed.tangent is not None
        born: Any = seed.problem
        self.place = np.array([values[free[1]], values[free[0]]])
        there = problem.at(z)
        along = kernel_direction(there.linearize(z).jacobian, sizes(there, z))[-2:] / typical
        across = np.array([along[1] + lean * along[0], lean * along[1] - along[0]])
        self.across = across / np.linalg.norm(across) * typical
        start = np.concatenate([seed.z[:-1], self.place])
        orbit, rest = OrbitPlane(born, free).on_tangent(start, self.across), np.append(seed.z[:-1], 0.0)
        units = np.append(filled_magnitudes(orbit, rest)[:-1], 1.0)
        super().__init__(orbit, rest, seed.tangent, units, free, typical)

    def amplitude(self, r: float) -> float:
        """That in the metric, of one in the length of the critical vector."""
        return 2.0 * r * self.unit

    def place_of(self, z: np.ndarray) -> np.ndarray:
        """On that line; z has the shape (M + 1,)."""
        return self.place + z[-1] * self.across


def tori_of_cycles(problem: Any, z: np.ndarray, leaning: Sequence[float] = (0.0,)) -> Sequence[Seed]:
    """The curve of tori of the cycles of a curve of Hopf points that is born at a double or zero-Hopf point.

    That curve's unknowns there are z, shape (N + 1,). With amplitudes r and s of both pairs
    s' = s (nu + p r^2): beside the point, where nu and p have other signs, the cycle of the amplitude
    r^2 = -nu / p has a torus (Kuznetsov 2004, section 8.6). Both numbers are read from the multipliers of two
    cycles. None where none is found.

    At a zero-Hopf point the growth of the pair is that of the curve's other direction, w' = .. + f w^2 + ..:
    with amplitude r and w it passes zero where w is of the size r^2. The cycles then are looked for on lines
    that are `leaning` towards the point, for across the curve w stands still (section 8.5).
    """

    def born(beside: np.ndarray, aside: float) -> Seed | None:
        each = (_torus(problem, beside, AMPLITUDE * aside**0.5, z[-2:], lean) for lean in leaning)
        return next((seed for seed in each if seed is not None), None)

    return _found_beside(problem, z, born, BESIDE)


def tori_not_found(frequencies: Sequence[float]) -> StartError:
    """What is said where a normal form has tori of cycles of these frequencies and none was found."""
    of = " and ".join(f"{omega:.6g}" for omega in frequencies)
    return StartError(
        f"No torus of the cycles of frequency {of} that begin beside this point was found.",
        "Continue the cycles of a Hopf point beside it: the curve can be begun at a torus (NS) of theirs.",
    )


def _torus(problem: Any, z: np.ndarray, r: float, origin: np.ndarray, lean: float) -> Seed | None:
    """The torus of the cycles that are born at a Hopf point at z, shape (N + 1,) of its curve.

    `r` is the amplitude of the first of two cycles, in the metric, `origin` the second and the first
    parameter at the point, shape (2,). `lean` is how much the cycles' line leans along the curve.
    """
    cycles = _Cycles(problem, z, lean)

    def growth(amplitude: float) -> float:
        return float(np.log(abs(_turning(cycles.problem, cycles.of(amplitude)))))

    expected = amplitude_of_neutral(growth, r)
    if expected is None:
        return None
    guess = cycles.of(expected)
    multiplier = _turning(cycles.problem, guess)
    return cycles.curve("NS", guess, expected, origin, [multiplier.real / abs(multiplier)])


def _turning(orbit: Any, z: np.ndarray) -> complex:
    """The complex multiplier nearest to the unit circle.

    z has the shape (N + 1,).

    Raises
    ------
    LinAlgError
        If there is none.
    """
    found = orbit.multipliers(z, orbit.jacobian(z)).values
    turning = [complex(value) for value in found if value.imag > 0.0]
    if not turning:
        raise np.linalg.LinAlgError("No pair of multipliers is complex.")
    return min(turning, key=lambda value: abs(abs(value) - 1.0))


def _cubic_rate(problem: Any, z: np.ndarray) -> float:
    """How the growth of a cycle's amplitude changes with its square; zero of neutral saddles.

    z has the shape (N + 1,).
    """
    kappa = problem.kappa(z)
    return cubic_rate(problem.plane, problem.in_plane(z), kappa) if kappa > 0.0 else 0.0


def _cycles(problem: Any, z: np.ndarray, kappa: float, rate: float) -> Seed:
    """The cycles that are born at a Hopf point at z, shape (N + 1,) of its curve, along the plane.

    `kappa` is the square of the frequency, `rate` as of `_cubic_rate`.
    """
    values, free = problem.values_of(z), (problem.free, str(problem.plane.second))
    n, pins = problem.states, len(problem.pins)
    record = SpecialPoint(
        "HB",
        0.0,
        unknowns=(*z[: n + pins].tolist(), 0.0),
        coefficients={"omega": kappa**0.5, "l1": rate / kappa**0.5, "crossing_rate": 1.0},
    )
    resting = Equilibrium(
        problem.system, values, "path", whole_plane(values, free), problem.pins, z[:n], problem.discretization
    )
    (seed,) = Hopf().seeds(resting, record)
    return seed
