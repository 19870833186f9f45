"""The rows of a branch as a curve on which the rows of another one are looked for."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from contwalk.branch import ORBITS, STANDS_STILL, Branch, SpecialPoint
from contwalk.labels import END

# Rows nearer than this, in ranges of what they are told apart by, stand at one place of a curve.
ONE_PLACE = 1e-12
# Steps that bring the foot of a row on an interpolated curve to rounding.
FOOT_STEPS = 8
# A row so near a curve, in lengths of the step that it lies beside, belongs to it, if perhaps with other
# digits: interpolation between rows is good to that, and another branch is not so near for long.
BESIDE = 0.1
# So near a node, in lengths of a step, is at it.
AT_NODE = 1e-6
# What is between rows is an estimate of an estimate: so many times that, as for what `verify` allows.
UNSURE = 5.0


def place_names(branches: Sequence[Branch]) -> tuple[str, ...]:
    """What tells the solutions of branches of one kind apart: names that all of them know.

    States of orbits are taken where the run file's `report_at` says, if it says so; of others the phase is
    nobody's, and what they reach is taken instead.
    """
    first = branches[0].info
    names = sorted(first.free)
    orbits = first.problem in ORBITS or first.settings.get("of_problem") in ORBITS
    if orbits:
        names.append("period")
    reported = {branch.info.settings.get("reported", "") for branch in branches}
    if not orbits or (len(reported) == 1 and reported != {""}):
        own = first.states
    else:
        own = tuple(name for name in first.observables if name.startswith(("max:", "min:")))
    return (*names, *(name for name in own if all(branch.knows(name) for branch in branches)))


def values_of(branch: Branch, names: Sequence[str]) -> np.ndarray:
    """Columns of a branch, shape (k, number of names)."""
    return np.column_stack([np.asarray(branch[name], dtype=float) for name in names])


def leading(branch: Branch) -> np.ndarray:
    """The largest real part or modulus of the stored spectrum, shape (k,); NaN where it is empty."""
    spectrum = branch.points["spectrum"]
    if spectrum.shape[1] == 0:
        return np.full(len(branch), np.nan)
    measures = spectrum.real if _in_rates(branch) else np.abs(spectrum)
    return np.max(np.where(np.isfinite(measures), measures, -np.inf), axis=1)


def from_border(branch: Branch) -> np.ndarray:
    """How near the border of stability the nearest eigenvalue is, less its error; shape (k,)."""
    spectrum = branch.points["spectrum"]
    if spectrum.shape[1] == 0:
        return np.full(len(branch), np.inf)
    apart = np.abs(spectrum.real) if _in_rates(branch) else np.abs(np.abs(spectrum) - 1.0)
    nearest = np.min(np.where(np.isfinite(apart), apart, np.inf), axis=1)
    return nearest - np.nan_to_num(branch.points["spectrum_error"], nan=np.inf)


def _in_rates(branch: Branch) -> bool:
    info = branch.info
    return "equilibrium" in (info.problem, info.settings.get("of_problem"))


def claims_of(branch: Branch, names: Sequence[str]) -> np.ndarray:
    """Errors that the rows claim for these columns, shape (k, number of names); NaN where none is known."""
    rounding = 4.0 * np.finfo(float).eps * np.abs(values_of(branch, names))
    return branch.points["error"][:, None] * weights_of(branch, names) + rounding


def weights_of(branch: Branch, names: Sequence[str]) -> np.ndarray:
    """The metric's units of these columns, shape (k, number of names)."""
    info, weights = branch.info, branch.points["weights"]
    rows = np.arange(len(branch))
    used = np.isfinite(branch.points["unknowns"]).sum(axis=1)
    found = np.empty((len(branch), len(names)))
    for column, name in enumerate(names):
        state = name.partition(":")[2] or name
        if name in info.free:
            found[:, column] = weights[rows, used - info.free.index(name)]
        elif state in info.states:
            found[:, column] = weights[:, info.states.index(state)]
        elif name in info.parameters:  # constant along the branch
            found[:, column] = 0.0
        else:  # the period has itself for a scale
            found[:, column] = np.abs(branch[name])
    return found


def scale_of(branches: Sequence[Branch], names: Sequence[str]) -> np.ndarray:
    """The range of each column over all branches, shape (number of names,).

    One that moves by its errors alone has the metric's unit.
    """
    columns, claims, units = (
        np.concatenate([of(branch, names) for branch in branches])
        for of in (values_of, claims_of, weights_of)
    )
    span = np.ptp(columns, axis=0)
    unit = np.max(np.nan_to_num(units), axis=0)
    told = (own[np.isfinite(own)] for own in claims.T)
    known = np.array([np.median(own) if len(own) else 0.0 for own in told])
    still = span <= np.maximum(STANDS_STILL * np.max(np.abs(columns), axis=0), 10.0 * known)
    return np.where(still, np.where(unit > 0.0, unit, 1.0), span)


@dataclass(frozen=True)
class Foot:
    """Where on a curve a row has its foot.

    Parameters
    ----------
    segment : int
        Number of the node before it.
    t : float
        Length along the curve.
    distance : float
        From the row, in ranges.
    beside : float
        The distance in lengths of the step that it lies beside.
    beyond : float
        How far behind an end of the curve the row lies, in lengths of the curve's last step there; 0 within.
    """

    segment: int
    t: float
    distance: float
    beside: float
    beyond: float

    @property
    def on(self) -> bool:
        """Whether the row belongs to the curve."""
        return self.beside < BESIDE and self.beyond == 0.0


class Curve:
    """The rows of a branch, with those at one place as one node.

    Parameters
    ----------
    branch : Branch
    names : sequence of str
        What tells rows apart.
    scale : ndarray, shape (number of names,)
        The range of each, so that what is near is near in all of them.
    """

    def __init__(self, branch: Branch, names: Sequence[str], scale: np.ndarray) -> None:
        self.branch, self.names, self.scale = branch, tuple(names), scale
        self.values = values_of(branch, names)
        self.claims = claims_of(branch, names)
        scaled = self.values / scale
        steps = np.linalg.norm(np.diff(scaled, axis=0), axis=1)
        self.node_of = np.concatenate([[0], np.cumsum(~(steps <= ONE_PLACE))]).astype(int)[: len(branch)]
        first = np.unique(self.node_of, return_index=True)[1] if len(branch) else np.array([], dtype=int)
        self.rows = first
        self.nodes = scaled[first]
        self.lengths = np.linalg.norm(np.diff(self.nodes, axis=0), axis=1)
        self.t = np.concatenate([[0.0], np.cumsum(self.lengths)])[: len(first)]
        self._gaps = {int(self.node_of[row]) for row in branch.gaps()}
        self._polynomials: dict[int, _Interpolation] = {}

    def __len__(self) -> int:
        return len(self.nodes)

    @cached_property
    def special_nodes(self) -> np.ndarray:
        """Whether a node has the row of a special point, shape (number of nodes,)."""
        found = np.zeros(len(self), dtype=bool)
        found[self.node_of[self.branch.points["special"]]] = True
        return found

    def points_at(self, node: int) -> list[SpecialPoint]:
        """The special points at a node, in their order along the branch; ends are none of them."""
        points = [point for point in self.branch.special_points if point.label != END]
        return [point for point in points if self.node_of[point.index] == node]

    @cached_property
    def all_leads(self) -> np.ndarray:
        """The leading eigenvalue's measure of all rows, shape (k,)."""
        return leading(self.branch)

    @cached_property
    def lead(self) -> np.ndarray:
        """The leading eigenvalue's measure at the nodes, shape (number of nodes,)."""
        return self.all_leads[self.rows]

    @cached_property
    def _reach(self) -> np.ndarray:
        """Squares of what is near a node: the longer step beside it and half of it more, shape (nodes,)."""
        padded = np.concatenate([[0.0], self.lengths, [0.0]])[: len(self) + 1]
        return (np.maximum(1.5 * np.maximum(padded[:-1], padded[1:]), ONE_PLACE)) ** 2

    def may_hold(self, place: np.ndarray) -> bool:
        """Whether a row, whose columns are given, shape (number of names,), may lie on the curve, or within a
        step beyond its ends: it is near a node then.
        """
        away = self.nodes - place / self.scale
        return bool(np.any(np.einsum("ij,ij->i", away, away) <= self._reach))

    def foot(self, place: np.ndarray) -> Foot:
        """The foot of a row, whose columns are given, shape (number of names,)."""
        x = place / self.scale
        if len(self) == 1:
            distance = float(np.linalg.norm(x - self.nodes[0]))
            same = distance <= ONE_PLACE
            return Foot(0, 0.0, distance, 0.0 if same else np.inf, 0.0)
        chords = np.diff(self.nodes, axis=0)
        theta = np.sum((x - self.nodes[:-1]) * chords, axis=1) / self.lengths**2
        inside = np.clip(theta, 0.0, 1.0)
        distance = np.linalg.norm(x - self.nodes[:-1] - inside[:, None] * chords, axis=1)
        distance[list(self._gaps & set(range(len(chords))))] = np.inf
        segment = int(np.argmin(np.where(np.isfinite(distance), distance, np.inf)))
        past = max(-theta[segment], theta[segment] - 1.0, 0.0)
        last = len(chords) - 1
        outside = (segment == 0 and theta[segment] < 0) or (segment == last and theta[segment] > 1)
        if outside and past * self.lengths[segment] > ONE_PLACE:
            away = float(distance[segment]) / self.lengths[segment]
            return Foot(
                segment, self.t[0 if theta[segment] < 0 else -1], float(distance[segment]), away, past
            )
        t = self._nearest(x, segment, float(self.t[segment] + inside[segment] * self.lengths[segment]))
        off = float(np.linalg.norm(x - self.at(self.nodes, segment, t)[0]))
        return Foot(segment, t, off, off / float(self.lengths[segment]), 0.0)

    def _nearest(self, x: np.ndarray, segment: int, t: float) -> float:
        """The length at which the interpolated curve is nearest, within a segment."""
        # A little past the ends: two versions of one row may stand on either side of it.
        slack = AT_NODE * self.lengths[segment]
        low, high = self.t[segment] - slack, self.t[segment + 1] + slack
        curve, before = self._through(segment), np.inf
        for _ in range(FOOT_STEPS):
            value, way = curve.at(t)
            square = float(way @ way)
            if not square > 0.0 or t == before:
                return t
            before, t = t, min(max(t + float((x - value) @ way) / square, low), high)
        return t

    def _through(self, segment: int) -> _Interpolation:
        """The polynomial through the nodes around a segment."""
        if segment not in self._polynomials:
            nodes = self._window(segment)
            self._polynomials[segment] = _Interpolation(self.t[nodes], self.nodes[nodes])
        return self._polynomials[segment]

    def _window(self, segment: int) -> np.ndarray:
        """The nodes that interpolate a segment: two of each side, where they are."""
        low, high = max(segment - 1, 0), min(segment + 2, len(self) - 1)
        low = segment if segment - 1 in self._gaps else low
        high = segment + 1 if segment + 1 in self._gaps else high
        return np.arange(low, high + 1)

    def unsure(self, claims: np.ndarray, segment: int) -> float:
        """How far along the curve a foot may be off, by what its row and the nodes beside it claim.

        `claims` are the row's, shape (number of names,); those that are not known count as nothing.
        """
        known = np.nan_to_num(claims + self.claims_at(segment), posinf=0.0) / self.scale
        return float(np.linalg.norm(known))

    def at(
        self, values: np.ndarray, segment: int, t: float, unsure: float = 0.0
    ) -> tuple[np.ndarray, np.ndarray]:
        """What nodes have, interpolated at a length, and how far it may be off: between them, and where the
        length is not known better.
        """
        if len(self) == 1:
            return values[0], np.zeros_like(values[0])
        nodes = self._window(segment)
        best, slope = _Interpolation(self.t[nodes], values[nodes]).at(t)
        # Lengths have the rounding of the whole one.
        along = (unsure + float(np.finfo(float).eps * self.t[-1])) * np.abs(slope)
        if (at_node := self.t[nodes] == t).any():
            return values[nodes[at_node][0]], along
        a, b = values[segment], values[segment + 1]
        length = self.t[segment + 1] - self.t[segment]
        theta = (t - self.t[segment]) / length
        slopes = [
            (values[n + 1] - values[n]) / (self.t[n + 1] - self.t[n]) for n in range(nodes[0], nodes[-1])
        ]
        # A corner between two nodes is off a straight line by at most the change of slope, and a polynomial
        # through it by what is between both. Two nodes alone tell nothing of what is between them.
        turned = np.abs(np.diff(slopes, axis=0)).sum(axis=0)
        bend = turned if len(slopes) > 1 else np.abs(slopes[0])
        off = abs(theta * (1.0 - theta)) * length * bend
        return best, UNSURE * (off + np.abs(best - (a + theta * (b - a)))) + along

    def claims_at(self, segment: int) -> np.ndarray:
        """The larger claims of the rows at both ends of a segment, shape (number of names,)."""
        rows = self.rows[[segment, min(segment + 1, len(self) - 1)]]
        return np.max(self.claims[rows], axis=0)

    def way(self, node: int) -> np.ndarray:
        """The direction of the curve at a node, not normalized, shape (number of names,)."""
        low, high = max(node - 1, 0), min(node + 1, len(self) - 1)
        return np.asarray(self.nodes[high] - self.nodes[low])


class _Interpolation:
    """The polynomial through values at some lengths, by divided differences.

    Source: J. Stoer, R. Bulirsch, Introduction to Numerical Analysis, Springer 2002, section 2.1.3.

    Parameters
    ----------
    t : ndarray, shape (k,)
    values : ndarray, shape (k, number of names) or (k,)
    """

    def __init__(self, t: np.ndarray, values: np.ndarray) -> None:
        self._t, coefficients = t, np.array(values, dtype=float)
        for k in range(1, len(t)):
            apart = (t[k:] - t[:-k]).reshape((-1,) + (1,) * (coefficients.ndim - 1))
            coefficients[k:] = np.diff(coefficients[k - 1 :], axis=0) / apart
        self._coefficients = coefficients

    def at(self, t: float) -> tuple[np.ndarray, np.ndarray]:
        """The value and the derivative at a length, both of the shape of one value."""
        value = self._coefficients[-1]
        slope = np.zeros_like(value)
        for node, coefficient in zip(self._t[-2::-1], self._coefficients[-2::-1], strict=True):
            slope = slope * (t - node) + value
            value = value * (t - node) + coefficient
        return value, slope
