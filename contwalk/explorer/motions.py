"""What each stored point of a branch is in words, and how it moves."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from contwalk.branch import ORBITS, Branch, SpecialPoint
from contwalk.diagram.reopening import reopened
from contwalk.errors import ContwalkError
from contwalk.explorer.machine import MachineOfBranch
from contwalk.explorer.packing import packed, predicted, varints
from contwalk.explorer.planes import planes_of
from contwalk.explorer.sampling import Sampled, sampled
from contwalk.number_words import plural
from contwalk.plotting.playback import Playback
from contwalk.plotting.segments import at_birth
from contwalk.plotting.stage import Performer
from contwalk.printable import printable
from contwalk.system import System
from contwalk.workflow.phase_plane import has_plane
from contwalk.workflow.stored.hybrid_facts import HybridFacts, facts_of
from contwalk.workflow.stored.hybrid_words import PointWords
from contwalk.workflow.stored.orbit_motions import Motion, motion_along
from contwalk.workflow.stored.orbits import PICTURE, Orbit, orbit_at
from contwalk.workflow.stored.point_words import row_words, special_words

# What curves may be beside the motion, and how the machine moves between two of its pictures, in parts of a
# state's range; levels of a state within its range, and of time within the motion.
TOLERANCE = {"curve": 2e-3, "machine": 4e-2}
LEVELS = {"state": 4096, "time": 16384}


@dataclass
class BranchPart:
    """The words and motions of a branch.

    Parameters
    ----------
    words, motions, planes : str
        Packed, see `packing`; `motions` is empty where nothing moves, `planes` where there are none.
    missing : list of str
        Sentences on what cannot be shown.
    error : float
        How far curves are from the motions, in parts of each state's range.
    """

    words: str
    motions: str
    planes: str
    missing: list[str]
    error: float


@dataclass
class _Moving:
    """What moves at the rows of a branch; None where it does not."""

    orbits: list[Orbit | None] = field(default_factory=list)
    motions: list[Motion | None] = field(default_factory=list)
    missing: dict[str, int] = field(default_factory=dict)

    def add(self, orbit: Orbit | None, motion: Motion | None) -> None:
        self.orbits.append(orbit)
        self.motions.append(motion)

    def lacks(self, error: Exception) -> None:
        sentence = error.sentence if isinstance(error, ContwalkError) else f"{type(error).__name__}: {error}"
        self.missing[sentence] = self.missing.get(sentence, 0) + 1


def branch_part(
    system: System | None,
    branch: Branch,
    units: Mapping[str, str],
    progress: Callable[[], None] = lambda: None,
) -> BranchPart:
    """All that a page tells of the points of one branch; without the system nothing moves."""
    moving = _Moving()
    rows = []
    for row in range(len(branch)):
        hybrid = _follow(system, branch, row, moving)
        rows.append(_plain(row_words(branch, row, units, hybrid)))
        progress()
    special = {}
    for point in branch.special_points:
        hybrid = _facts(system, branch, point)
        special[point.name] = _plain(special_words(branch, point, units, hybrid, system))
        progress()
    words = packed({"rows": rows, "points": special})
    if system is None or not len(branch):
        return BranchPart(words, "", "", [], 0.0)
    motions, error = _packed_motions(system, branch, moving)
    missing = [f"{sentence} ({plural(count, 'point')})" for sentence, count in moving.missing.items()]
    planes = planes_of(system, branch, moving.motions) if has_plane(system) else ""
    return BranchPart(words, motions, planes, missing, error)


def _follow(system: System | None, branch: Branch, row: int, moving: _Moving) -> HybridFacts | None:
    """Integrate an orbit once more; segments and margins where it has events."""
    if system is None or branch.info.problem not in ORBITS:
        moving.add(None, None)
        return None
    try:
        with np.errstate(all="ignore"):
            there = reopened(system, branch, row, PICTURE)
            orbit = orbit_at(system, branch, row, there)
            moving.add(orbit, motion_along(system, orbit))
            return (
                facts_of(system, branch, row, there)
                if branch.info.problem_by_name == "hybrid_orbit"
                else None
            )
    except (ContwalkError, ArithmeticError, ValueError) as error:
        if len(moving.motions) == row:
            moving.add(None, None)
        if not at_birth(branch)[row]:  # an orbit without extent has no motion
            moving.lacks(error)
        return None


def _facts(system: System | None, branch: Branch, point: SpecialPoint) -> HybridFacts | None:
    if system is None or branch.info.problem_by_name != "hybrid_orbit":
        return None
    try:
        with np.errstate(all="ignore"):
            return facts_of(system, branch, point)
    except (ContwalkError, ArithmeticError, ValueError):  # what a row says of it is told already
        return None


def _plain(words: PointWords) -> list[Any]:
    """As plain JSON values: nothing in a text acts."""
    tables = [
        [
            [printable(cell) for cell in table.header],
            [[printable(cell) for cell in row] for row in table.rows],
            table.remark,
        ]
        for table in words.tables
    ]
    return [printable(words.title), [printable(fact) for fact in words.facts], tables]


def _packed_motions(system: System, branch: Branch, moving: _Moving) -> tuple[str, float]:
    """Curves of states, and pictures of the machine."""
    known = [k for k, motion in enumerate(moving.motions) if motion is not None]
    motions = [motion for motion in moving.motions if motion is not None]
    curves = sampled(motions, TOLERANCE["curve"], TOLERANCE["curve"])
    header: dict[str, Any] = {
        "states": list(system.state_names),
        "levels": LEVELS,
        "rows": known,
        "periods": [_nine(motion.period) for motion in motions],
        "events": [[[_nine(at - motion.times[0]), name] for at, name in motion.marks] for motion in motions],
        "counts": [len(times) for times in curves.times],
    }
    low = [states.min(axis=0) for states in curves.states]
    high = [states.max(axis=0) for states in curves.states]
    header |= {"low": [[_nine(v) for v in each] for each in low]}
    header |= {"high": [[_nine(v) for v in each] for each in high]}
    body = bytearray()
    before: np.ndarray | None = None
    for number, motion in enumerate(motions):
        table = _levels(motion, curves.times[number], curves.states[number], low[number], high[number])
        body += varints(predicted(table, before))
        before = table
    if system.draw is not None:
        try:
            machine, times = _machine(system, branch, moving, motions)
        except ContwalkError as error:
            moving.lacks(error)
        else:
            header["machine"] = machine.header()
            header["frames"] = [[round(LEVELS["time"] * t) for t in each] for each in times]
            body += machine.body
    return packed(header, bytes(body)), curves.error + 0.5 / LEVELS["state"] if motions else 0.0


def _levels(
    motion: Motion, times: np.ndarray, states: np.ndarray, low: np.ndarray, high: np.ndarray
) -> np.ndarray:
    """Times and states as whole numbers, shape (k, 1 + n)."""
    span = np.where(high > low, high - low, 1.0)
    whole = np.empty((len(times), 1 + states.shape[1]), dtype=np.int64)
    whole[:, 0] = np.round(LEVELS["time"] * times / (motion.times[-1] - motion.times[0]))
    whole[:, 1:] = np.round(LEVELS["state"] * (states - low) / span)
    return whole


def _machine(
    system: System, branch: Branch, moving: _Moving, motions: list[Motion]
) -> tuple[MachineOfBranch, list[list[float]]]:
    """Pictures of the machine at each row; of an equilibrium one."""
    machine, times = MachineOfBranch(), []
    instants = iter(_instants(sampled(motions, TOLERANCE["machine"], 1.0)))
    on_axes = False
    for row, (orbit, motion) in enumerate(zip(moving.orbits, moving.motions, strict=True)):
        at = [0.0]
        if orbit is not None and motion is not None:
            playback = Playback(system, motion.times, motion.states, orbit.parameters)
            at = next(instants)
        else:
            state = branch.points["state"][row][None]
            playback = Playback(system, [0.0], state, _parameters(system, branch, row))
        performer = Performer(playback, on_axes)
        machine.add([performer.at(playback.begin + t) for t in at])
        on_axes, length = performer.on_axes, playback.end - playback.begin
        times.append([t / length if length else 0.0 for t in at])
    return machine, times


def _instants(found: Sampled) -> list[list[float]]:
    """The instants of pictures: just before an event rather than twice at it."""
    result = []
    for times in found.times:
        length = float(times[-1])
        before = np.append(times[:-1] == times[1:], False)
        result.append((times - np.where(before, 1e-9 * length, 0.0)).tolist())
    return result


def _parameters(system: System, branch: Branch, row: int) -> dict[str, float]:
    """Those of the system, at a row."""
    names = system.parameter_names
    return {name: float(value) for name, value in branch.parameters_at(row).items() if name in names}


def _nine(value: float) -> float:
    return float(f"{float(value):.9g}")
