"""`contwalk plot`: a figure of a database."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from contwalk.cli import plot_margins
from contwalk.cli.stored_system import required_system, trust_option, units_of_run
from contwalk.errors import ContwalkError

if TYPE_CHECKING:
    from contwalk.branch import Branch
    from contwalk.system import System

KINDS = (
    "bifurcation_diagram",
    "eigenvalues",
    "multipliers",
    "stability_map",
    "locus",
    "chart",
    "machine",
    "margins",
    "phase_plane",
    "phase_portrait",
    "stick_figure",
    "time_series",
)
MARGINS = "margins"
# Those that are of stored points, and take --point.
OF_POINTS = ("machine", "phase_plane", "phase_portrait", "stick_figure", "time_series")
# Those that compute something, and need the system.
COMPUTED = (*OF_POINTS, "chart")
WITH_AXES = ("bifurcation_diagram", "stability_map", "locus", "chart", "phase_plane", "phase_portrait")


@click.command("plot")
@click.argument("db")
@click.option("-x", "x", metavar="P", help="What stands on the horizontal axis.")
@click.option(
    "-y",
    "several",
    metavar="OBS",
    multiple=True,
    help="What stands on the vertical axis; of a time series, any number of them.",
)
@click.option("-z", "z", metavar="STATE", help="The third axis of a phase portrait.")
@click.option("-o", "output", metavar="FIG", required=True, help="The file to write: PNG, SVG, PDF or PGF.")
@click.option(
    "--kind",
    type=click.Choice(KINDS),
    help=(
        f"The figure; by default {KINDS[0]}, or locus where all branches are curves in two parameters, or "
        "margins where DB is the file of margins."
    ),
)
@click.option("--branch", "names", metavar="b1", multiple=True, help="A branch to draw; all by default.")
@click.option(
    "--point",
    "points",
    metavar="b1/HB1",
    multiple=True,
    help="Where to draw the machine, or an orbit; by default the start, and a handful of orbits.",
)
@click.option(
    "--width",
    type=click.Choice(["column", "page"]),
    help="As wide as a column of a journal (3.4 inches), or as a page of it (7.2).",
)
@click.option("--full", is_flag=True, help="Multipliers of full orbits, not of what a symmetry closes up.")
@click.option("--together", is_flag=True, help="Multipliers of all branches in one pair of panels.")
@click.option("--force", is_flag=True, help="Replace a file that exists.")
@trust_option
def command(
    *,
    db: str,
    x: str | None,
    several: tuple[str, ...],
    z: str | None,
    output: str,
    kind: str | None,
    names: tuple[str, ...],
    points: tuple[str, ...],
    width: str | None,
    full: bool,
    together: bool,
    force: bool,
    trust: bool,
) -> None:
    """Draw a figure of the database DB, or of the file of margins X_margins.h5, into the file FIG.

    The axes take any parameter, state or observable; those of motions take states and signals. For a
    stability map, -x is the free parameter and -y the swept one.
    """
    from contwalk.cli.entry import say
    from contwalk.cli.point_page import stored_point
    from contwalk.plotting.style import of_width
    from contwalk.storage import open_database
    from contwalk.storage.failures import refuse_existing
    from contwalk.storage.trajectory import is_of_margins
    from contwalk.workflow.figures import draw_figure

    asked, kind = kind, kind or (MARGINS if is_of_margins(db) else KINDS[0])
    if len(several) > 1 and kind != "time_series":
        raise ContwalkError(f"The figure {kind} has one vertical axis.", "Give -y once.")
    y = several[0] if several else None
    _check_options(kind, x, y, z, points)
    of_multipliers = {name: True for name, wanted in (("full", full), ("together", together)) if wanted}
    _check_of_multipliers(kind, of_multipliers)
    refuse_existing([Path(output)], force)
    if kind == MARGINS:
        if names:
            raise ContwalkError("Margins have no branches.", "Leave --branch out.")
        if width:
            raise ContwalkError("Margins are as wide as they have states.", "Leave --width out.")
        plot_margins.plot(db, output, trust)
        return
    with open_database(db) as database:
        branches = [database.branch(name) for name in dict.fromkeys(names)] or database.branches()
        if asked is None and all(branch.info.problem == "locus" for branch in branches):
            kind = "locus"
        pointed = [(database.branch(point.partition("/")[0]), point) for point in points]
        places = [(branch, stored_point(branch, point)) for branch, point in pointed]
        system = required_system(database, trust) if kind in COMPUTED else None
        units = units_of_run(database, trust) if system is None else None
    if kind == "machine" and pointed and system is not None:
        with of_width(width):
            _draw_machine(system, *pointed[0], output)
    else:
        if kind == "stability_map":
            y = y or _swept(branches)
        options: dict[str, Any] = {axis: name for axis, name in (("x", x), ("y", y), ("z", z)) if name}
        if len(several) > 1:
            options["y"] = several
        options |= {"points": places, **of_multipliers}
        with of_width(width):
            draw_figure(kind, branches, system, Path(output), options, units, say)
    click.echo(f"Wrote {output}.")


def _check_options(kind: str, x: str | None, y: str | None, z: str | None, points: tuple[str, ...]) -> None:
    if points and kind not in OF_POINTS:
        raise ContwalkError(
            f"--point belongs to --kind {', '.join(OF_POINTS[:-1])} and {OF_POINTS[-1]}, not to {kind}.",
            "Leave it out.",
        )
    if len(points) > 1 and kind not in ("phase_plane", "phase_portrait"):
        what = "machine" if kind == "machine" else kind.replace("_", " ")
        raise ContwalkError(f"The {what} is drawn at one point.", "Give --point once.")
    if x and kind == "time_series":
        raise ContwalkError("The figure time_series has no -x: it is time.", "Leave it out.")
    if (x or y) and kind not in (*WITH_AXES, "time_series"):
        raise ContwalkError(f"The figure {kind} has no -x and -y.", "Leave them out.")
    if z and kind != "phase_portrait":
        raise ContwalkError(f"The figure {kind} has no -z.", "Leave it out.")


def _check_of_multipliers(kind: str, options: dict[str, bool]) -> None:
    if options and kind != "multipliers":
        raise ContwalkError(
            f"--{next(iter(options))} belongs to --kind multipliers, not to {kind}.", "Leave it out."
        )


def _swept(branches: list[Branch]) -> str:
    """The parameter that differs from branch to branch.

    Raises
    ------
    ContwalkError
        Unless there is exactly one.
    """
    from contwalk.cli.summary import differing

    found = differing(branches)
    if len(found) != 1:
        raise ContwalkError(
            f"The branches differ in {', '.join(found) or 'no parameter'}.",
            "A stability map needs a sweep over one parameter: name it with -y.",
        )
    return found[0]


def _draw_machine(system: System, branch: Branch, point: str, output: str) -> None:
    from contwalk import plotting
    from contwalk.cli.point_page import row_of, special_of
    from contwalk.number_words import with_unit
    from contwalk.workflow.stored.point_words import free_value

    name = point.partition("/")[2]
    row = row_of(branch, name)
    if row is None:
        special = special_of(branch, name)
        state, parameters, value = special.state, dict(special.parameters), free_value(branch, special)
    else:
        value = float(branch.points["free"][row][0])
        state = dict(zip(branch.info.states, branch.points["state"][row], strict=True))
        parameters = {**branch.info.parameters, branch.info.free[0]: value}
    known = {key: parameters[key] for key in system.parameter_names if key in parameters}
    free = branch.info.free[0]
    unit = with_unit(free, plotting.units_of(system))
    title = f"{point}: {free} = {value:.6g} {unit}".strip()
    plotting.save(plotting.plot_machine(system, state, known, title=title), output)
