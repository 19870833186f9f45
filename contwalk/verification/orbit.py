"""Orbits, smooth or through events, by shooting: what ends where the next piece starts, guards and closure.

Durations of legs are unknowns, and guards are equations: no event is searched for. A leg is cut into pieces
where deviations grow on it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from contwalk.branch import BranchInfo
from contwalk.errors import called
from contwalk.system import System
from contwalk.system.declarations import ParameterValues
from contwalk.verification.equations import Equations, Evaluation, along_pins, pin_rows, without
from contwalk.verification.finding import MOVED, CannotTell
from contwalk.verification.functions import Functions, Parameters
from contwalk.verification.passage import EPSILON, Passage, grown, passed
from contwalk.verification.stored_orbit import stored_orbit


@dataclass(frozen=True)
class Leg:
    """A leg as it was passed: its mode, the name of what ends it, its pieces, and the time at its start.

    A deviation v at its end, (n,), that comes to the event later by d is `jump` v + `shift` d at the next
    one's start, (n', n) and (n',). d is `late` v, or what it was before where the leg lasts no time: None.
    """

    mode: str
    event: str
    pieces: list[Passage]
    start: float
    duration: float
    jump: np.ndarray
    shift: np.ndarray
    late: np.ndarray | None

    @property
    def along(self) -> np.ndarray:
        """What deviations at its start, (n,), have become at its end, shape (n, n)."""
        whole = np.eye(len(self.pieces[0].end))
        for piece in self.pieces:
            whole = piece.derivative[:, 1 : 1 + len(whole)] @ whole
        return whole


class OrbitEquations(Equations):
    """Those of one stored orbit.

    Parameters
    ----------
    system : System
    info : BranchInfo
    unknowns : ndarray, shape (u,)
        As they are stored: states at the starts of the legs, of hybrid orbits their durations, and the time.
    period : float
        Of the closure.
    free : ndarray, shape (k,)
    """

    unit = True

    def __init__(
        self, system: System, info: BranchInfo, unknowns: np.ndarray, period: float, free: np.ndarray
    ) -> None:
        self.functions, self.info = Functions(system, Parameters(system, info)), info
        stored = info.settings
        legs = stored.get("legs") or [[system.modes[0].name, "", True]]
        self.momentary, self.together = ([leg[k : k + 1] == [True] for leg in legs] for k in (3, 4))
        self.lasting_first = self.momentary.index(False)
        if self.lasting_first and (info.settings.get("pins") or system.conserved):
            raise CannotTell("A leg of no time begins an orbit along which a direction is held.")
        self.legs = [(str(mode), str(name)) for mode, name, *_ in legs]
        self.falls = [bool(leg[2]) for leg in legs]
        smooth = "legs" not in stored
        named = info.closure if smooth and info.closure not in (None, "full") else stored.get("image", "")
        self.image, self.power = str(named or ""), int(stored.get("power", 1)) if named else 0
        self.turns = np.array(stored.get("turns") or np.zeros(len(info.states)), dtype=float)
        self.forced, self.eventful = system.period is not None, bool(self.legs[-1][1])
        sizes = [len(system.states_of(mode)) for mode, _ in self.legs]
        kept = stored_orbit(info, unknowns, sizes, self.forced, period)
        self.first, self.lasting = [starts[0] for starts in kept.starts], kept.lasting
        self.closures = period / self._period(free) if self.forced else 0.0
        full = np.zeros((len(legs), len(info.states)))
        for row, starts, (mode, _) in zip(full, kept.starts, self.legs, strict=True):
            row[list(system.states_of(mode))] = np.abs(starts).max(axis=0)
        self.scale = np.max(full, axis=0)
        self.drifts = self._straight(kept.drifts, free)
        self._lay(kept.starts, kept.begins, kept.durations, kept.start, free)

    def _straight(self, stored: np.ndarray, free: np.ndarray) -> np.ndarray:
        """How fast one drifts who sees the orbit close, along each held direction that is straight, (j,).

        Raises
        ------
        CannotTell
            If it is along one that bends.
        """
        self.straight, (mode, _), p = list[int](), self.legs[0], self.functions.parameters.at(free)
        for number, (direction, bent) in enumerate(
            along_pins(self.functions, self.info, mode, self.first[0], p)
        ):
            if not bent:
                self.straight.append(number)
            elif np.any(np.abs(stored[number] * direction) > EPSILON**0.5 * self._scale(mode)):
                raise CannotTell("The orbit closes but for a drift along a direction that bends.")
        return stored[self.straight]

    def drifting(self, mode: str, x: np.ndarray, p: np.ndarray) -> np.ndarray:
        """Straight held directions in the states of a mode, shape (n, j)."""
        if not self.straight:
            return np.zeros((len(x), 0))
        found = [direction for direction, _ in along_pins(self.functions, self.info, mode, x, p)]
        return np.array([found[number] for number in self.straight]).T

    def _lay(
        self,
        starts: Sequence[np.ndarray],
        begins: Sequence[np.ndarray],
        durations: np.ndarray,
        start: float,
        free: np.ndarray,
    ) -> None:
        """Put the unknowns in their places: starts of all pieces, drifts, durations, start, free parameters.

        All pieces but the last one of each leg keep their durations.
        """
        self.cuts = [len(own) for own in starts]
        self.fixed = [np.diff(own) * lasts for own, lasts in zip(begins, durations, strict=True)]
        states = [own.ravel() for own in starts]
        self.z = np.concatenate([*states, self.drifts, durations, [start], free])
        self.size = len(self.z) - len(free)
        self.count = len(durations)
        self.sizes = np.maximum(np.abs(self.z), 1e-300)

    def _period(self, free: np.ndarray) -> float:
        assert self.functions.system.period is not None
        values = ParameterValues(**self.functions.parameters.by_name(free))
        return float(called("period", self.functions.system.period, values))

    def settle(self, relative: float, looked: int = 8, cuts: int = 64) -> None:
        """Cut pieces over which deviations grow, at states of a first motion; see how large the states are.

        On one piece they grow `MOVED` times at most: the equations are known to as many digits less. Over
        `looked` parts of a piece it is looked at how they grow; one is cut into `cuts` at most.
        """
        legs = self.at(self.z, relative).legs
        for leg in legs:
            for i, size in zip(
                self._states(leg.mode),
                np.max([np.abs(p.states).max(axis=0) for p in leg.pieces], axis=0),
                strict=True,
            ):
                self.scale[i] = max(self.scale[i], size)
        starts, begins = list[np.ndarray](), list[np.ndarray]()
        for leg in legs:
            scale, own, times = self._scale(leg.mode), list[np.ndarray](), list[float]()
            for whole in leg.pieces:
                begin, end = float(whole.times[0]), float(whole.times[-1])
                pieces, inner = [whole], self._cut(leg.mode, whole, looked, relative)
                if (
                    max(grown(inner, scale, looked)) > MOVED
                ):  # those that shrink again have grown all the same
                    pieces = inner
                while len(pieces) < cuts and max(grown(pieces, scale, 1)) > MOVED:
                    pieces = self._cut(leg.mode, whole, 2 * len(pieces), relative)
                own += [piece.states[0] for piece in pieces]
                times += [begin + (end - begin) * k / len(pieces) for k in range(len(pieces))]
            starts.append(np.array(own))
            begins.append((np.array(times) - leg.start) / (leg.duration or 1.0))
        tail = self.z[self.size - self.count - 1 : self.size]
        self._lay(starts, begins, tail[:-1], float(tail[-1]), self.free)

    def _cut(self, mode: str, whole: Passage, cuts: int, relative: float) -> list[Passage]:
        """A piece in several of one duration."""
        x, p, found = whole.states[0], self.functions.parameters.at(self.free), list[Passage]()
        each = float(whole.times[-1] - whole.times[0]) / cuts
        for i in range(cuts):
            begin = float(whole.times[0]) + each * i
            piece = passed(self.functions, mode, begin, x, each, p, self._scale(mode), relative)
            found.append(piece)
            x = piece.end + each * self.drifting(mode, x, p) @ self.drifts
        return found

    def _states(self, mode: str) -> tuple[int, ...]:
        return self.functions.system.states_of(mode)

    def _scale(self, mode: str) -> np.ndarray:
        own = self.scale[list(self._states(mode))]
        return np.where(own > 0.0, own, max(float(own.max()), EPSILON))

    # -- the equations ---------------------------------------------------------------------------------------

    def at(self, z: np.ndarray, relative: float) -> Evaluation:
        """The equations at z, shape (N + k,), with the monodromy matrix."""
        work = _Assembly(self, z, relative)
        for number in range(len(self.legs)):
            work.leg(number)
        work.closed()
        return work.evaluation()


class _Assembly:
    """The equations of one orbit as they are written down, leg by leg."""

    def __init__(self, orbit: OrbitEquations, z: np.ndarray, relative: float) -> None:
        self.orbit, self.z, self.relative = orbit, z, relative
        self.functions, n = orbit.functions, len(z)
        self.p = self.functions.parameters.at(z[orbit.size :])
        self.residuals: list[np.ndarray] = []
        self.rows: list[np.ndarray] = []
        self.legs: list[Leg] = []
        self.durations = slice(orbit.size - orbit.count - 1, orbit.size - 1)
        self.drifts = slice(self.durations.start - len(orbit.drifts), self.durations.start)
        self.t, self.dt = float(z[orbit.size - 1]), np.eye(n)[orbit.size - 1]
        self.place = 0

    def leg(self, number: int) -> None:
        """Follow a leg, and write where its pieces end."""
        orbit, z = self.orbit, self.z
        mode, event = orbit.legs[number]
        n, cuts, total = len(orbit.first[number]), orbit.cuts[number], z[self.durations][number]
        pieces, begun = [], (self.t, float(total))
        by_duration, fixed = np.eye(len(z))[self.durations.start + number], orbit.fixed[number]
        for i in range(cuts):
            last = i == cuts - 1
            lasts = float(total - fixed.sum() if last else fixed[i])
            own = slice(self.place, self.place + n)
            self.place += n
            piece = passed(
                self.functions, mode, self.t, z[own], lasts, self.p, orbit._scale(mode), self.relative
            )
            directions = orbit.drifting(mode, z[own], self.p)
            drift = directions @ z[self.drifts]
            piece = replace(piece, end=piece.end + lasts * drift, rate=piece.rate + drift)
            pieces.append(piece)
            moved = np.outer(piece.derivative[:, 0], self.dt)
            moved[:, own] += piece.derivative[:, 1 : 1 + n]
            moved[:, orbit.size :] += piece.derivative[:, 1 + n :]
            moved[:, self.drifts] += lasts * directions
            if last:
                moved += np.outer(piece.rate, by_duration)
            self.t += lasts
            if not last:
                moved[:, self.place : self.place + n] -= np.eye(n)
                self._write(piece.end - z[self.place : self.place + n], moved)
        self.dt = self.dt + by_duration
        jump, shift, late = self._ends(number, event, pieces[-1], moved)
        self.legs.append(Leg(mode, event, pieces, *begun, jump, shift, late))

    def _ends(
        self, number: int, event: str, piece: Passage, moved: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray | None]:
        """Write that a leg ends at its event, and where the next one begins; what becomes of deviations."""
        orbit, functions = self.orbit, self.functions
        last = number == len(orbit.legs) - 1
        target = orbit.legs[0 if last else number + 1][0]
        transition = functions.system.transition(event, piece.mode) if event else None
        jump = functions.jump(
            transition, piece.mode, target, orbit.image if last else "", orbit.power if last else 0
        )
        after, by = jump(self.t, piece.end, self.p)
        n = len(piece.end)
        by_x, shift = by[:, 1 : 1 + n], np.zeros(len(after))
        late: np.ndarray | None = np.zeros(n)
        if transition is not None:
            value, slope = functions.guard(transition)(self.t, piece.end, self.p)
            row = slope[0, 1 : 1 + n] @ moved + slope[0, 0] * self.dt
            row[orbit.size :] += slope[0, 1 + n :]
            rate = float(slope[0, 0] + slope[0, 1 : 1 + n] @ piece.rate)
            with np.errstate(all="ignore"):
                late = -slope[0, 1 : 1 + n] / rate
            if orbit.momentary[number]:  # its guard is past zero where it begins
                place = self.durations.start + number
                late, value, row = None, self.z[place : place + 1], np.eye(len(self.z))[place]
            self._write(value, row[None])
            time = float(self.z[orbit.size - 1]) if last else self.t  # an image is one of another time
            then = functions.field(target)(time, after, self.p)[0]
            then = then + orbit.drifting(target, after, self.p) @ self.z[self.drifts]
            shift = by_x @ piece.rate + by[:, 0] - then
        following = by_x @ moved + np.outer(by[:, 0], self.dt)
        following[:, orbit.size :] += by[:, 1 + n :]
        begin = 0 if last else self.place
        there = slice(begin, begin + len(after))
        following[:, there] -= np.eye(len(after))
        missed = after - self.z[there]
        if last:
            missed = missed - orbit.turns[list(functions.system.states_of(target))]
        self._write(missed, following)
        return by_x, shift, late

    def closed(self) -> None:
        """Write what holds the phase or the period, pins, and conserved quantities."""
        orbit, z, functions = self.orbit, self.z, self.functions
        mode, x, first = orbit.legs[0][0], z[: len(orbit.first[0])], orbit.first[0]
        start = float(z[orbit.size - 1])
        n, width = len(x), len(z)
        self.flow = functions.field(mode)(start, x, self.p)[0]
        self.flow = self.flow + orbit.drifting(mode, x, self.p) @ z[self.drifts]
        if orbit.forced:
            period, by_free = self._forced()
            row = np.zeros(width)
            row[self.durations], row[orbit.size :] = 1.0, -by_free
            self._write(np.array([z[self.durations].sum() - period]), row[None])
        if not orbit.forced or not orbit.eventful:
            row = np.zeros(width)  # the time at the start is held
            row[orbit.size - 1] = 1.0
            self._write(np.array([start - orbit.z[orbit.size - 1]]), row[None])
        if not orbit.forced and not orbit.eventful:
            row = np.zeros(width)
            row[:n] = self.flow / np.linalg.norm(self.flow)
            self._write(np.array([row[:n] @ (x - first)]), row[None])
        held, rows, self.pins = pin_rows(functions, orbit.info, mode, first, x, self.p)
        if len(held):
            whole = np.zeros((len(held), width))
            whole[:, :n], whole[:, orbit.size :] = rows[:, :n], rows[:, n:]
            self._write(held, whole)
        self.lefts = []
        for quantity in functions.system.conserved:
            value, slope = functions.number(("conserved", quantity.name), mode, quantity.of(mode))(
                start, x, self.p
            )
            self.lefts.append(slope[0, 1 : 1 + n])
            row, place = np.zeros(width), functions.system.parameter_names.index(quantity.name)
            row[:n], row[orbit.size :] = (
                slope[0, 1 : 1 + n],
                slope[0, 1 + n :] - functions.parameters.slopes[place],
            )
            known = self.p[place]
            if not np.isfinite(known):
                known = functions.number(("conserved", quantity.name), mode, quantity.of(mode))(
                    start, first, self.p
                )[0]
            self._write(value - known, row[None])

    def _once_round(self) -> tuple[np.ndarray, np.ndarray]:
        """What deviations at the start of the first leg that lasts, (n,), have become a closure later, and
        the flow there.
        """
        first, functions = self.orbit.lasting_first, self.functions
        begin = self.legs[first]
        x = begin.pieces[0].states[0]
        m, late = np.eye(len(x)), np.zeros(len(x))
        with np.errstate(all="ignore"):
            for leg in (*self.legs[first:], *self.legs[:first]):
                ends = leg.along @ m
                late = late if leg.late is None else leg.late @ ends
                m = leg.jump @ ends + np.outer(leg.shift, late)
        flow = functions.field(begin.mode)(begin.start, x, self.p)[0] if first else self.flow
        return m, flow

    def _forced(self) -> tuple[float, np.ndarray]:
        """Duration of the closure of a forced orbit, and its derivatives (k,) by central differences."""
        orbit, free = self.orbit, self.z[self.orbit.size :]
        slopes = np.zeros(len(free))
        for i, value in enumerate(free):
            step = EPSILON ** (1.0 / 3.0) * max(abs(value), EPSILON)
            moved = step * np.eye(len(free))[i]
            slopes[i] = (orbit._period(free + moved) - orbit._period(free - moved)) / (2.0 * step)
        return orbit.closures * orbit._period(free), orbit.closures * slopes

    def evaluation(self) -> Evaluation:
        """All that was written."""
        m, f = self._once_round()
        rights = [] if self.orbit.forced else [f]
        lefts = list(self.lefts)
        for v in self.pins:
            (lefts if np.linalg.norm(v @ m - v) < np.linalg.norm(m @ v - v) else rights).append(v)
        trivial = 0.0 if self.orbit.forced else float(np.linalg.norm(m @ f - f) / np.linalg.norm(f))
        matrix = without(m, lefts, rights) if np.isfinite(m).all() else m
        return Evaluation(
            self.z,
            np.concatenate(self.residuals),
            np.vstack(self.rows),
            matrix,
            self.relative,
            trivial,
            self.legs,
        )

    def _write(self, residual: Any, rows: np.ndarray) -> None:
        self.residuals.append(np.atleast_1d(residual))
        self.rows.append(rows)
