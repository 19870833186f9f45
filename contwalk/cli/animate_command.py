"""`contwalk animate`: the machine in motion."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from contwalk.cli.bar import bar
from contwalk.cli.stored_system import required_system, trust_option
from contwalk.errors import ContwalkError

if TYPE_CHECKING:
    from contwalk.branch import Branch, SpecialPoint
    from contwalk.system import System
    from contwalk.workflow.animating import Animated


@click.command("animate")
@click.argument("db")
@click.argument("point", metavar="BRANCH/POINT")
@click.option("-o", "output", metavar="FILE", required=True, help="The file to write: GIF, MP4 or HTML.")
@click.option(
    "--periods", type=click.IntRange(1), default=1, show_default=True, help="Periods that are played."
)
@click.option(
    "--fps", type=click.FloatRange(1.0, 120.0), default=30.0, show_default=True, help="Frames in a second."
)
@click.option(
    "--slow",
    type=click.FloatRange(0.001, 1000.0),
    default=1.0,
    show_default=True,
    help="A second of the motion lasts so many seconds.",
)
@click.option(
    "--mode",
    type=click.IntRange(1),
    metavar="N",
    help="Show beside it the machine displaced by a mode: multiplier number N, 1 for the largest.",
)
@click.option(
    "--amplitude",
    type=click.FloatRange(0.0, min_open=True),
    metavar="A",
    help="The largest displacement at the start, in half the range of each state; 0.3.",
)
@click.option("--force", is_flag=True, help="Replace a file that exists.")
@click.option("--quiet", is_flag=True, help="Print errors only.")
@trust_option
def command(
    *,
    db: str,
    point: str,
    output: str,
    periods: int,
    fps: float,
    slow: float,
    mode: int | None,
    amplitude: float | None,
    force: bool,
    quiet: bool,
    trust: bool,
) -> None:
    """Play the orbit of a stored point of the database DB, as the system draws its machine.

    Where it draws none, a point moves along the phase portrait, with its time series below.

    The point is one of a branch of periodic orbits, named as b1/PD1, or by its number along the branch as
    b1/12. Frames are evenly spaced in time; the camera follows a machine that gets somewhere. MP4 needs the
    program ffmpeg.

    With --mode, the machine displaced by one mode of small deviations is drawn pale beside it: how it grows,
    decays or goes round is what the multiplier tells.
    """
    from contwalk.cli.point_page import stored_point
    from contwalk.storage import open_database

    if amplitude is not None and mode is None:
        raise ContwalkError("--amplitude is that of a mode, and none is named.", "Name one: --mode 1.")
    with open_database(db) as database:
        branch = database.branch(point.partition("/")[0])
        where = stored_point(branch, point)
        system = required_system(database, trust)
    options: dict[str, Any] = {"periods": periods, "fps": fps, "slow": slow, "mode": mode, "force": force}
    if amplitude is not None:
        options["amplitude"] = amplitude
    done = _animate(system, branch, where, Path(output), options, quiet)
    if not quiet:
        click.echo(f"Wrote {done.path}: {_described(done, periods, system.time_unit)}.")


def _animate(
    system: System,
    branch: Branch,
    point: SpecialPoint | int,
    path: Path,
    options: dict[str, Any],
    quiet: bool,
) -> Animated:
    """With a live bar where somebody watches a terminal."""
    from contwalk.workflow.animating import animate

    with bar("frames", None, quiet) as move:
        progress = move and (lambda done, number: move(completed=done, total=number))
        return animate(system, branch, point, path, **options, progress=progress)


def _described(done: Animated, periods: int, time: str) -> str:
    from contwalk.number_words import plural
    from contwalk.system.units import lasting

    shown = f"{plural(periods, 'period')} of {lasting(done.motion / periods, time, '.4g')}"
    beside = f", beside it {done.mode}" if done.mode else ""
    return f"{plural(done.frames, 'frame')}, {shown} in {done.seconds:.4g} s{beside}"
