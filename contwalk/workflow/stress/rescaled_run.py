"""A run file in other units: the same study of the same machine."""

from __future__ import annotations

from dataclasses import replace

from contwalk.workflow.run_file.reading import RunFile
from contwalk.workflow.run_file.settings import Mark
from contwalk.workflow.run_file.starts import StartSpec
from contwalk.workflow.stress.rescaled_system import in_units, rescaled_system
from contwalk.workflow.stress.units import Units


def rescaled_run(run: RunFile, units: Units) -> RunFile:
    """The run file with its system and all its numbers in other units."""
    place = run.report_at
    if place is not None and place.section is not None:
        name, level = place.section
        place = replace(place, section=(name, level * units.states[name]))
    low, high = (end * units.of(run.free) for end in run.range)
    second = run.second
    if second is not None:
        name, (least, most) = second
        second = name, (least * units.of(name), most * units.of(name))
    loci = run.loci
    if loci is not None:
        least, most = (end * units.of(loci.second) for end in loci.range)
        loci = replace(loci, range=(least, most))
    path = run.parameter_path
    if path is not None:
        path = in_units(path[0], units), in_units(path[1], units)
    sweep = run.sweep
    if sweep is not None:
        sweep = sweep[0], tuple(value * units.of(sweep[0]) for value in sweep[1])
    return replace(
        run,
        system=rescaled_system(run.system, units),
        parameters=in_units(run.parameters, units),
        starts=tuple(_start(start, units) for start in run.starts),
        range=(low, high),
        parameter_path=path,
        stop_at={
            name: tuple(value * units.of(name) for value in values) for name, values in run.stop_at.items()
        },
        marks=tuple(
            Mark(mark.name, tuple(value * units.of(mark.name) for value in mark.values), mark.extremum)
            for mark in run.marks
        ),
        report_at=place,
        second=second,
        loci=loci,
        sweep=sweep,
    )


def _start(start: StartSpec, units: Units) -> StartSpec:
    until = start.until
    return replace(
        start,
        parameters=in_units(start.parameters, units),
        given=in_units(start.given, units),
        state=None if start.state is None else units.new(start.state),
        until=until * units.time if isinstance(until, int | float) else until,
    )
