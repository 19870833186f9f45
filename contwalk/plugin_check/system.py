"""What is wrong with a plugin, said before any run.

Every function is called as a run would call it, at the default parameters and at fixed sampled states; what
is declared about it (symmetries, the period, equilibria) is compared with what it does.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from contwalk.errors import ContwalkError
from contwalk.plugin_check import declarations
from contwalk.plugin_check.absent import check_absent
from contwalk.plugin_check.angles import check_angles_of_fields
from contwalk.plugin_check.at_events import check_at_all_events, check_at_event
from contwalk.plugin_check.at_one_instant import check_at_one_instant
from contwalk.plugin_check.conserved import check_conserved
from contwalk.plugin_check.cut_powers import check_cut_powers
from contwalk.plugin_check.event_kinks import check_event_kinks, check_told_kinks
from contwalk.plugin_check.events import Happening, check_passing, check_transition, traced_reset
from contwalk.plugin_check.findings import Finding, Report, place_of, place_of_error, split_place
from contwalk.plugin_check.guards import check_twins
from contwalk.plugin_check.jumps_in_time import check_jumps_in_time
from contwalk.plugin_check.keeping import check_keeping
from contwalk.plugin_check.kinks import check_kinks
from contwalk.plugin_check.modes import CheckedFields, distinct_transitions
from contwalk.plugin_check.neutral import check_neutral
from contwalk.plugin_check.parameter_kinks import check_kinks_of_period, check_parameter_kinks
from contwalk.plugin_check.reachable import check_reachable
from contwalk.plugin_check.samples import Samples, samples_of
from contwalk.plugin_check.signals import check_signal
from contwalk.plugin_check.symmetry import check_symmetry
from contwalk.system import Condition, Family, Observable, Symmetry, System, list_systems
from contwalk.system.loading import is_path, load_declaration

__all__ = ["Finding", "check_reference", "check_system", "findings_of"]


def check_reference(reference: str, base: Path | None = None) -> list[Finding]:
    """All that `findings_of` finds."""
    return list(findings_of(reference, base))


def findings_of(reference: str, base: Path | None = None) -> Iterator[Finding]:
    """Load a plugin and check it with its default model, and with each choice varied in turn.

    Findings come as each model has been checked.

    Parameters
    ----------
    reference : str
        An installed system's name, or the path of a plugin file.
    base : Path, optional
        What a relative path is relative to; the current directory by default.

    Raises
    ------
    ContwalkError
        If there is no such system or file at all. All that is wrong inside a plugin is a finding.
    """
    path = (base or Path.cwd()) / reference if is_path(reference) else None
    if (path is None and reference not in list_systems()) or (path is not None and not path.is_file()):
        load_declaration(reference, base)  # raises the error that says so
    try:
        declared = load_declaration(reference, base)
    except (Exception, SystemExit) as error:
        yield _load_finding(f"plugin '{reference}'", error, path)
        return
    sources = [path] if path is not None else _module_files(reference)
    if isinstance(declared, System):
        yield from check_system(declared, sources=sources)
        return
    for model in _models(declared):
        label = ", ".join(f"{name}={value}" for name, value in model.items())
        try:
            system = declared.with_model(model)
        except (Exception, SystemExit) as error:
            yield _load_finding(f"model of '{declared.name}'", error, path, declared, label)
            continue
        yield from check_system(system, sources=sources, model=label)


def check_system(system: System, sources: Sequence[Path] = (), model: str = "") -> list[Finding]:
    """Check a system as it is.

    Parameters
    ----------
    system : System
    sources : sequence of Path
        Files that declare it, besides those of its functions.
    model : str
        Its model choices in words, to be noted in the findings.

    Returns
    -------
    list of Finding
        At least one; those of level `ok` say what was checked, or could not be.
    """
    report = Report(model)
    period = declarations.check_period(report, system)
    samples = samples_of(system, period)
    fields = CheckedFields(system)
    fields.check(report, samples)
    if period is not None:
        for name, field in fields.items():
            declarations.check_repeats(report, f"field of mode '{name}'", field, samples, period)
    for name, field in fields.items():
        check_kinks(report, name, field, system, samples)
        check_cut_powers(report, name, field, system)
        check_parameter_kinks(report, f"field of mode '{name}'", field, samples, name)
    if period is not None:
        check_kinks_of_period(report, system, samples)
    distinct, happenings = distinct_transitions(system), list[Happening]()
    for transition in distinct:
        happening = check_transition(report, transition, system, fields, samples, period)
        if happening is not None:
            happenings.append(happening)
    for happening in happenings:
        field = fields[happening.transition.source]
        reset = traced_reset(Report(), happening.transition, system)
        check_event_kinks(report, happening, reset, system, samples)
        check_told_kinks(report, happening, system, samples)
        check_jumps_in_time(report, happening, samples, period)
        named, source = f"of transition '{happening.transition.name}'", happening.transition.source
        check_parameter_kinks(report, f"guard {named}", happening.guard, samples, source)
        if reset is not None:
            check_parameter_kinks(report, f"reset {named}", reset, samples, source)
            check_keeping(report, happening.transition, happening.guard, reset, field, samples)
    check_reachable(report, system)
    check_twins(report, system, {each.transition.name: each.guard for each in happenings})
    seen = None
    if system.acting and len(happenings) == len(distinct):
        seen = _seen(report, system, list(fields), happenings, samples)
        check_at_one_instant(report, system, happenings, samples)
    passed = set[str]() if seen is None else set(seen.events)
    for happening in happenings:
        check_passing(report, happening, fields[happening.transition.source], samples, happenings, passed)
    check_absent(report, system)
    for symmetry in system.symmetries:
        check_symmetry(report, symmetry, system, fields, samples, period)
        if symmetry.role == "spatial" and fields.complete and len(happenings) == len(distinct):
            _check_mirrored(report, symmetry, system, samples, period)
    check_angles_of_fields(report, system, fields, samples)
    for neutral in system.neutral:
        check_neutral(report, neutral, system, fields, samples)
    for quantity in system.conserved:
        check_conserved(report, quantity, system, fields, samples)
    for observable in system.observables:
        if observable.at is None:
            declarations.check_observable(report, observable, system, samples)
            check_at_all_events(report, observable, system, happenings, seen, samples)
    for signal in system.signals:
        check_signal(report, signal, system, samples)
    at_events: list[Condition | Observable] = [*system.conditions]
    at_events += [observable for observable in system.observables if observable.at is not None]
    for entry in at_events:
        check_at_event(report, entry, system, happenings, seen, samples)
    for start in system.starts:
        declarations.check_start(report, start, system, fields.get(system.modes[0].name), samples)
    declarations.check_presets(report, system)
    written = declarations.Written([*sources, *_function_files(system)])
    declarations.check_words(report, system, written)
    return report.findings


def _seen(
    report: Report, system: System, modes: Sequence[str], happenings: Sequence[Happening], samples: Samples
) -> Any:
    from contwalk.plugin_check.motion import check_motions  # compiled flows

    return check_motions(report, system, modes, happenings, samples)


def _check_mirrored(
    report: Report, symmetry: Symmetry, system: System, samples: Samples, period: float | None
) -> None:
    from contwalk.plugin_check.mirrored import check_mirrored  # compiled flows

    check_mirrored(report, symmetry, system, samples, period)


def _models(family: Family) -> Iterator[dict[str, Any]]:
    """The default model, then those that differ from it by one choice.

    Whole numbers run from their minimum to one above the default, so that loops over them are seen to end.
    """
    default = {choice.name: choice.default for choice in family.choices}
    yield default
    for choice in family.choices:
        values: Sequence[Any] = choice.allowed or ()
        if choice.allowed is None and choice.minimum is not None:
            values = range(choice.minimum, int(choice.default) + 2)
        for value in values:
            if value != choice.default:
                yield default | {choice.name: value}


def _load_finding(
    what: str, error: BaseException, path: Path | None, family: Family | None = None, model: str = ""
) -> Finding:
    """Why a plugin cannot be used, with the line if it is known."""
    place = place_of_error(error, None if family is None else family.build)
    place = place if place[0] or path is None else (str(path), None)
    sentence = f"It raises {type(error).__name__}: {error}."
    if isinstance(error, ContwalkError):
        place, sentence = split_place(error.sentence, place)
        sentence = f"{sentence} {error.remedy}"
    report = Report(model)
    report.error(what, sentence, place)
    return report.findings[0]


def _module_files(reference: str) -> list[Path]:
    """The file of the module that an entry point names."""
    module = sys.modules.get(list_systems()[reference].partition(":")[0])
    file = getattr(module, "__file__", None)
    return [] if file is None else [Path(file)]


def _function_files(system: System) -> list[Path]:
    """The files in which the system's functions are."""
    functions: list[Any] = [mode.field for mode in system.modes]
    functions += [transition.guard for transition in system.transitions]
    functions += [observable.function for observable in system.observables]
    functions += [condition.function for condition in system.conditions]
    functions += [start.states for start in system.starts]
    return [Path(file) for file, _ in map(place_of, functions) if file is not None]
