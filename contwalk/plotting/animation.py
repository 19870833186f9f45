"""A machine in motion, as a file that plays: GIF, MP4, or a page of HTML."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from os import PathLike
from pathlib import Path
from subprocess import CalledProcessError
from typing import Any

import numpy as np
from matplotlib.animation import AbstractMovieWriter, FFMpegWriter, PillowWriter
from matplotlib.artist import Artist
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.transforms import Bbox

from contwalk.errors import ContwalkError
from contwalk.files.drafts import drafted
from contwalk.plotting.film_page import PageWriter
from contwalk.plotting.machine import scenery
from contwalk.plotting.playback import Playback
from contwalk.plotting.portrait_film import PortraitFilm
from contwalk.plotting.style import GREY, INK, PALETTE
from contwalk.system import System

ANIMATIONS = (".gif", ".mp4", ".html")
MOST_FRAMES = 5000
# Inches, and dots in an inch; 600 x 600 dots, even numbers as MP4 demands.
SIZE, DPI = (6.0, 6.0), 100
# Within the figure: the machine with its numbers, and the line of time below it, with a legend in rows above
# it. Fixed, so that nothing jumps between frames.
MACHINE, CLOCK = (0.01, 0.14, 0.98, 0.80), (0.06, 0.085, 0.88, 0.03)
ROW, IN_A_ROW = 0.035, 4
MOST_BESIDE = 0.25  # what numbers and labels beside the axes may take on each side at most
LOOKED_AT = 24  # instants, for limits that hold all of them
MEASURED_AT = 5  # instants, for the room that numbers take
# Times between frames of a GIF are whole hundredths of a second, and browsers play none below two.
HUNDREDTHS, LEAST_HUNDREDTHS = 100.0, 2
EVENTS = (*PALETTE[2:], *PALETTE[:2])  # colours; not the first ones, which a machine may well have
# How long the name of an event stays, in seconds of the animation.
LINGER = 0.25
# How pale a second motion is, and by how many layers the first one is in front of it.
PALE, IN_FRONT = 0.4, 10


def save_animation(
    system: System,
    times: Sequence[float] | np.ndarray,
    states: Sequence[Sequence[float]] | np.ndarray,
    parameters: Mapping[str, float],
    path: str | PathLike[str],
    *,
    events: Sequence[tuple[float, str]] = (),
    fps: float = 30.0,
    slow: float = 1.0,
    title: str = "",
    beside: Sequence[Sequence[float]] | np.ndarray | None = None,
    caption: str = "",
    progress: Callable[[int, int], None] | None = None,
) -> int:
    """Write a motion of a machine as an animation, by the suffix of `path`: GIF, MP4 (by ffmpeg) or HTML.

    Frames are evenly spaced in time. The plugin's `draw` sets the limits of each: the camera follows a
    machine that gets somewhere. Without a `draw`, a point moves along the phase portrait.

    Parameters
    ----------
    system : System
        It has a `draw`.
    times, states : array of shape (k,), (k, n)
        The motion; at an event, its instant twice, with the states on both sides.
    parameters : mapping
        Values by name; the system's defaults fill in what is not given.
    path : path-like
        The folder must exist; an existing file is replaced, when the new one is complete.
    events : sequence of (float, str)
        Times and names of events, which are marked on the line of time.
    fps : float
        Frames in a second. Those of a GIF last whole hundredths of a second, the nearest ones.
    slow : float
        A second of the motion lasts so many seconds.
    title : str
    beside : array of shape (k, n), optional
        States of a second motion at the same instants: the machine is drawn there as well, pale.
    caption : str
        What is said below the title.
    progress : callable, optional
        Told the number of frames that are done, and of all.

    Returns
    -------
    int
        The number of frames.

    Raises
    ------
    ContwalkError
        For another suffix, a missing ffmpeg, too many frames, a path that cannot be written, or what does
        not fit the system.
    PluginError
        If `draw` raises.
    """
    target = Path(path)
    motion = Playback(system, times, states, parameters)
    suffix = checked_suffix(target)
    fps = played_fps(suffix, fps)
    number = frames_of(motion.end - motion.begin, fps, slow)
    instants = motion.begin + (motion.end - motion.begin) * np.arange(number) / number
    second = None if beside is None else Playback(system, times, beside, parameters)
    film: _Film | PortraitFilm
    if system.draw is None:
        look: dict[str, Any] = {"size": SIZE, "dpi": DPI, "beside": second}
        film = PortraitFilm(motion, events, title, _below(caption, slow), **look)
    else:
        film = _Film(motion, events, slow, title, second, caption)
    try:
        with drafted(target, lambda name: name.open("xb")) as draft:
            draft.file.close()
            _write(film, _writer(suffix, fps, title), draft.path, instants, progress)
        draft.lock.release()
    except OSError as error:
        raise ContwalkError(
            f"The animation cannot be written to {target}: {error.strerror or error}.",
            "Name a file in an existing folder that you may write to.",
        ) from error
    except CalledProcessError as error:
        said = str(error.stderr or error.output or "").strip().splitlines()
        raise ContwalkError(
            f"ffmpeg could not write {target}: {said[-1] if said else error}.", "Name a .gif or .html file."
        ) from error
    return number


def _below(caption: str, slow: float) -> str:
    """What is said below the title: of what is displaced, and how fast it plays."""
    speed = f"1/{slow:g} of its speed" if slow > 1.0 else f"{1.0 / slow:g} times its speed"
    return "\n".join([*([caption] if caption else []), *([speed] if slow != 1.0 else [])])


def _write(
    film: _Film | PortraitFilm,
    writer: AbstractMovieWriter,
    path: Path,
    instants: np.ndarray,
    progress: Callable[[int, int], None] | None,
) -> None:
    """Write all frames."""
    writer.setup(film.figure, str(path), DPI)
    try:
        for done, time in enumerate(instants.tolist(), start=1):
            film.show(time)
            writer.grab_frame()
            if progress is not None:
                progress(done, len(instants))
    except BaseException:
        with suppress(IndexError):  # of a writer that has seen no frame
            writer.finish()
        raise
    writer.finish()


class _Film:
    """A figure that shows one instant of a motion after another."""

    def __init__(
        self,
        motion: Playback,
        events: Sequence[tuple[float, str]],
        slow: float,
        title: str,
        beside: Playback | None = None,
        caption: str = "",
    ) -> None:
        self.motion, self.beside, self.events = motion, beside, tuple(events)
        self.figure = Figure(figsize=SIZE, dpi=DPI)
        FigureCanvasAgg(self.figure)
        self.stage, clock = self.figure.add_axes(MACHINE), self.figure.add_axes(CLOCK)
        self.figure.text(0.02, 0.975, title, fontsize=10, color=INK, va="top")
        self.said = self.figure.text(0.98, 0.925, "", fontsize=11, va="top", ha="right", weight="bold")
        self.linger = LINGER / slow
        below = _below(caption, slow)
        self.figure.text(0.02, 0.935, below, fontsize=9, color=GREY, va="top", linespacing=1.4)
        names = dict.fromkeys(name for _, name in self.events)
        self.colors = {name: EVENTS[number % len(EVENTS)] for number, name in enumerate(names)}
        self.clock = clock
        self.hand = self._draw_clock()
        self.limits = self._limits()
        self._make_room()

    def show(self, time: float) -> None:
        """Draw an instant."""
        self._frame(time)
        since = time - self.motion.begin
        self.hand.set_data([since], [0.0])
        self.clock.set_xlabel(f"time  {self.motion.system.lasting(since, '.3f')}", fontsize=9, color=INK)
        just = [name for at, name in self.events if 0.0 <= time - at <= self.linger]
        self.said.set(text=just[-1] if just else "", color=self.colors[just[-1]] if just else INK)

    def _frame(self, time: float) -> None:
        self._draw(time)
        if self.limits is not None:
            self.stage.set(xlim=self.limits[:2], ylim=self.limits[2:])
        self.stage.set_aspect("equal", adjustable="box")

    def _draw(self, time: float) -> None:
        self.stage.clear()
        if self.beside is None:
            self.motion.draw(self.stage, time)
            return
        _pale(self.beside.draw(self.stage, time))
        added = self.motion.draw(self.stage, time)  # after the other one: the camera follows this one
        still = scenery(added)
        for artist in added:
            if artist not in still:
                artist.set_zorder(artist.get_zorder() + IN_FRONT)

    def _limits(self) -> np.ndarray | None:
        """Limits that hold all instants; None where the plugin sets its own."""
        found = []
        for time in np.linspace(self.motion.begin, self.motion.end, LOOKED_AT).tolist():
            self._draw(time)
            if not self.stage.get_autoscale_on():
                return None
            found.append([*self.stage.get_xlim(), *self.stage.get_ylim()])
        least, largest = np.min(found, axis=0), np.max(found, axis=0)
        return np.array([least[0], largest[1], least[2], largest[3]])

    def _make_room(self) -> None:
        """Place the machine so that the numbers and labels beside its axes, if it has any, are not cut."""
        left, low, width, height = MACHINE
        rows = -(-len(self.colors) // IN_A_ROW)
        low, height = low + rows * ROW, height - rows * ROW
        self.stage.set_position((left, low, width, height))
        beside = np.zeros(4)
        for time in np.linspace(self.motion.begin, self.motion.end, MEASURED_AT).tolist():
            self._frame(time)
            beside = np.maximum(beside, self._beside())
        beside = np.minimum(beside, MOST_BESIDE)
        self.stage.set_position(
            (left + beside[0], low + beside[1], width - beside[[0, 2]].sum(), height - beside[[1, 3]].sum())
        )

    def _beside(self) -> np.ndarray:
        """What stands beside the axes at the left, below, at the right and above, in parts of the figure."""
        if not self.stage.axison:
            return np.zeros(4)
        self.stage.apply_aspect()
        inner, whole = self.stage.get_window_extent(), self.figure.bbox
        boxes = [axis.get_tightbbox() for axis in (self.stage.xaxis, self.stage.yaxis)]
        outer = Bbox.union([inner, *(box for box in boxes if box is not None)])
        low, high = np.subtract(inner.min, outer.min), np.subtract(outer.max, inner.max)
        return np.asarray(np.concatenate([low, high]) / np.tile([whole.width, whole.height], 2))

    def _draw_clock(self) -> Line2D:
        """The line of time with its events; the hand on it."""
        ax, begin = self.clock, self.motion.begin
        ax.set_xlim(0.0, max(self.motion.end - begin, 1e-300))
        ax.set_ylim(-1.0, 1.0)
        ax.axhline(0.0, color=GREY, linewidth=2.0, zorder=1)
        ax.spines[:].set_visible(False)
        ax.set_yticks([])
        ax.tick_params(labelsize=8, color=INK, labelcolor=INK, width=0.7, length=3)
        for name, color in self.colors.items():
            at = [time - begin for time, other in self.events if other == name]
            look: dict[str, Any] = {"linestyle": "none", "marker": "|", "markersize": 11, "color": color}
            ax.plot(at, np.zeros(len(at)), markeredgewidth=1.8, label=name, clip_on=False, zorder=2, **look)
        if self.colors:
            ax.legend(
                loc="lower right",
                bbox_to_anchor=(1.0, 1.0),
                borderaxespad=0.0,
                ncols=min(len(self.colors), IN_A_ROW),
                frameon=False,
                fontsize=8.5,
                labelcolor=INK,
                handletextpad=0.1,
            )
        (hand,) = ax.plot([0.0], [0.0], marker="o", markersize=8, color=INK, zorder=3, clip_on=False)
        return hand


def _pale(artists: Sequence[Artist]) -> None:
    """Make what is drawn of a machine pale and nameless, and take away what stands still."""
    still = scenery(artists)
    for artist in artists:
        if artist in still:
            artist.remove()
            continue
        alpha = artist.get_alpha()
        artist.set_alpha(PALE * (1.0 if alpha is None else float(alpha)))
        artist.set_label("_beside")


def checked_suffix(path: Path) -> str:
    """The suffix of an animation that can be written here.

    Raises
    ------
    ContwalkError
        For one that is not known, or MP4 where there is no ffmpeg.
    """
    suffix = path.suffix.lower()
    if suffix not in ANIMATIONS:
        raise ContwalkError(
            f"An animation cannot be written to {path}: the format {suffix or '(no suffix)'} is not known.",
            f"Allowed: {', '.join(ANIMATIONS)}.",
        )
    if suffix == ".mp4" and not FFMpegWriter.isAvailable():
        raise ContwalkError(
            f"{path} cannot be written: MP4 needs the program ffmpeg, which is not there.",
            "Install ffmpeg, or name a .gif or .html file.",
        )
    return suffix


def played_fps(suffix: str, fps: float) -> float:
    """Frames in a second that a format can play: those of a GIF last whole hundredths of a second."""
    if suffix != ".gif":
        return fps
    return HUNDREDTHS / max(round(HUNDREDTHS / fps), LEAST_HUNDREDTHS)


def frames_of(duration: float, fps: float, slow: float) -> int:
    """The number of frames of a motion.

    Raises
    ------
    ContwalkError
        If there are too many.
    """
    wanted = duration * slow * fps
    if not math.isfinite(wanted) or wanted > MOST_FRAMES:
        raise ContwalkError(
            f"The animation would have {wanted:.0f} frames, more than {MOST_FRAMES}.",
            "Play fewer periods, slow the motion less, or show fewer frames in a second.",
        )
    return max(round(wanted), 1)


def _writer(suffix: str, fps: float, title: str) -> AbstractMovieWriter:
    """What writes a format."""
    if suffix == ".html":
        return PageWriter(fps, title)
    kind: Any = {".gif": PillowWriter, ".mp4": FFMpegWriter}[suffix]
    if suffix == ".gif":  # it cuts off what its durations have of a fraction
        return kind(fps=fps * (1.0 - 1e-9))
    return kind(fps=fps, codec="h264", extra_args=["-pix_fmt", "yuv420p"])
