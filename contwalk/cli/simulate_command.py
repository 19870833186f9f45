"""`contwalk simulate`: one motion from the start of a run file."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from rich.console import Console

    from contwalk.workflow.run_file.simulate import SimulationFile
    from contwalk.workflow.simulating import SimulationResult

MOST_SHOWN = 40  # events of the table: more are in the file


@click.command("simulate")
@click.argument("file")
@click.option("--set", "overrides", metavar="KEY=VALUE", multiple=True, help="Set a value of the run file.")
@click.option("--output", metavar="X.h5", help="Base of the files' names, instead of the run file's output.")
@click.option("--force", is_flag=True, help="Replace files that exist.")
@click.option("--quiet", is_flag=True, help="Print errors only.")
@click.option("--no-figures", is_flag=True, help="Draw no figures.")
def command(
    file: str, overrides: tuple[str, ...], output: str | None, force: bool, quiet: bool, no_figures: bool
) -> int:
    """Integrate the motion of the run file FILE from its start, and locate the events on its way.

    With output X.h5 it writes X_trajectory.h5, X_trajectory.csv, X_events.csv and the figures, such as
    X_time_series.png.

    A motion ends where the machine has fallen, if its plugin says when it has. Where a start simulates, the
    motion sets out from its state.

    Exit codes: 0; 1 if the motion ended early (everything before is stored); 2 for bad input.
    """
    from contwalk.cli.entry import say
    from contwalk.cli.terminal import console
    from contwalk.workflow.run_file.simulate import read_simulation
    from contwalk.workflow.simulating import simulate, why

    run = read_simulation(file, overrides, output)
    result = simulate(run, force=force, figures=not no_figures)
    if not quiet:
        _print(console(), run, result)
    problem = why(result.trajectory.status, float(result.trajectory.times[-1]), result.reason)
    if problem is not None:
        say(f"error: {problem}")
        return 1
    return 0


def _print(out: Console, run: SimulationFile, result: SimulationResult) -> None:
    from contwalk.cli.terminal import line
    from contwalk.number_words import choices, exact, plural
    from contwalk.system.falling import FALLEN

    system, motion = run.system, result.trajectory
    chosen = choices(system.model)
    line(out, system.name + (f" ({chosen})" if chosen else ""), style="bold")
    work = f"{plural(result.steps, 'step')}, {plural(result.evaluations, 'right-hand side')}"
    line(out, f"from t = {motion.times[0]:.10g} to {motion.times[-1]:.10g}, {work}", indent=4)
    if result.settled is not None and motion.status == "ok":
        word = "settled" if result.settled else "NOT SETTLED: given up; give until a time"
        line(out, word, indent=4)
    ends = ", ".join(
        f"{name} = {exact(value)}" for name, value in zip(motion.states, motion.values[-1], strict=True)
    )
    several = len(motion.mode_names) > 1
    mode = f" in mode {motion.mode_names[motion.modes[-1]]}" if several else ""
    if motion.status == FALLEN:
        where = f"at t = {exact(motion.times[-1])}{mode}, with {ends}"
        line(out, f"the machine has fallen, and the motion ends, {where}", indent=4)
    else:
        line(out, f"end{mode}: {ends}", indent=4)
    _print_events(out, motion)
    if result.note:
        line(out, f"note: {result.note}", indent=4)
    out.print()
    for path in result.files:
        line(out, f"file:   {path}")
    for path in result.figures:
        line(out, f"figure: {path}")


def _print_events(out: Console, motion: object) -> None:
    from contwalk.cli.terminal import line, table
    from contwalk.number_words import exact, plural
    from contwalk.storage.trajectory import Trajectory

    assert isinstance(motion, Trajectory)
    names = motion.event_names
    if not names:
        line(out, "no events", indent=4)
        return
    several = len(motion.mode_names) > 1
    happened = zip(
        names[:MOST_SHOWN],
        motion.event_times,
        motion.event_rising,
        motion.event_modes,
        motion.event_before,
        strict=False,
    )
    rows = []
    for name, t, rising, mode, state in happened:
        where = ["rising" if rising else "falling", *([mode] if several else [])]
        rows.append([name, exact(t), *where, *(f"{value:.10g}" for value in state)])
    heads = ["event", "t", "direction", *(["mode after"] if several else []), *motion.states]
    line(out, plural(len(names), "event"), indent=4)
    table(out, heads, rows, indent=4)
    if len(names) > MOST_SHOWN:
        line(out, f"... and {len(names) - MOST_SHOWN} more, in the file", indent=4)
