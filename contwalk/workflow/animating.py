"""A stored orbit as an animation of its machine."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from contwalk.branch import Branch, SpecialPoint
from contwalk.storage.failures import refuse_existing
from contwalk.system import System

AMPLITUDE = 0.3  # of the displacement by a mode, in half the range of each state


@dataclass(frozen=True)
class Animated:
    """What was written.

    Parameters
    ----------
    path : Path
    frames : int
    seconds : float
        How long it plays.
    motion : float
        How long the motion lasts that it shows, seconds.
    mode : str
        The mode that displaces the second machine; empty without one.
    """

    path: Path
    frames: int
    seconds: float
    motion: float
    mode: str = ""


def animate(
    system: System,
    branch: Branch,
    point: SpecialPoint | int,
    path: Path,
    *,
    periods: int = 1,
    fps: float = 30.0,
    slow: float = 1.0,
    mode: int | None = None,
    amplitude: float = AMPLITUDE,
    force: bool = False,
    progress: Callable[[int, int], None] | None = None,
) -> Animated:
    """Play the orbit of a stored point.

    Parameters
    ----------
    system : System
    branch : Branch
    point : SpecialPoint or int
        A special point of the branch, or the number of a row.
    path : Path
        GIF, MP4 or HTML by its suffix.
    periods : int
        How many are played.
    fps : float
        Frames in a second.
    slow : float
        A second of the motion lasts so many seconds.
    mode : int, optional
        Number of a multiplier, 1 for the largest modulus: the machine displaced by its mode is drawn beside.
    amplitude : float
        The largest displacement at the start, in half the range of each state.
    force : bool
        Replace a file that exists.
    progress : callable, optional
        Told the number of frames that are done, and of all.

    Raises
    ------
    ContwalkError
        Before anything is written, for a point that is no orbit, a suffix that is not known or cannot be
        written here, a file that exists, more frames than one file should have, and a mode that the orbit
        does not have.
    """
    from contwalk.plotting.animation import checked_suffix, frames_of, played_fps, save_animation
    from contwalk.workflow.stored.orbit_modes import displaced_along
    from contwalk.workflow.stored.orbit_motions import motion_along
    from contwalk.workflow.stored.orbits import orbit_at, titled

    suffix = checked_suffix(path)
    refuse_existing([path], force)
    orbit = orbit_at(system, branch, point)
    rate = played_fps(suffix, fps)
    frames_of(periods * orbit.period, rate, slow)
    motion = motion_along(system, orbit, periods)
    beside, words = None, ""
    if mode is not None:
        displaced = displaced_along(system, branch, point, orbit, motion.states, mode, amplitude)
        beside, words = displaced.states, displaced.words
    frames = save_animation(
        system,
        motion.times,
        motion.states,
        orbit.parameters,
        path,
        events=motion.marks,
        fps=fps,
        slow=slow,
        title=titled(orbit),
        beside=beside,
        caption=words and f"pale: displaced by {words}",
        progress=progress,
    )
    return Animated(path, frames, frames / rate, periods * orbit.period, words)
