"""Systems as runs take them: loaded, and refused where what is cheap to check shows them to be wrong.

`contwalk systems check` tries far more. Here every function is traced twice, and what is declared about the
field, a period and symmetries, is compared with it: some milliseconds, against results that are wrong without
a word.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from contwalk.equations.loading import PREFIX
from contwalk.errors import SystemDefinitionError
from contwalk.plugin_check.angles import check_angles_of_fields
from contwalk.plugin_check.declarations import check_period, check_repeats
from contwalk.plugin_check.findings import Finding, Report
from contwalk.plugin_check.functions import check_clock, check_never_finite
from contwalk.plugin_check.modes import CheckedFields
from contwalk.plugin_check.neutral import check_somewhere, traced_generator, words
from contwalk.plugin_check.samples import samples_of
from contwalk.plugin_check.symmetry import compare_symmetry
from contwalk.plugin_check.traced import traced, vector_form
from contwalk.system import System
from contwalk.system import load_system as load_declared

MOST_OPERATIONS = 4000


def load_system(
    reference: str | Path, model: Mapping[str, Any] | None = None, base: Path | None = None
) -> System:
    """The system of this name or plugin file, built with these model choices, and found sound.

    Parameters
    ----------
    reference : str or Path
        An installed system's name, a plugin file that exports `SYSTEM`, or `equations:` and a text of them.
    model : mapping, optional
        Model choices that the system declares, by name.
    base : Path, optional
        Folder of relative paths; by default the current one.

    Raises
    ------
    SystemDefinitionError
        If there is no such system, its file cannot be imported, it does not have a model choice, or one of
        its functions or declarations is wrong; the sentence names the plugin's line.
    """
    system = load_declared(reference, model, base)
    refuse_unsound(system)
    return system


def system_from_text(text: str) -> System:
    """The system that a text of equations defines, as `"x' = a - x*y; y' = x*y - y; a = 1.2"`.

    Parameters
    ----------
    text : str
        One equation a line or between semicolons: `docs/reference/equations.md` has what may stand there.

    Raises
    ------
    SystemDefinitionError
        With the line of the text.
    """
    if not isinstance(text, str):
        raise SystemDefinitionError(
            f"The equations are a {type(text).__name__}, not a text.",
            'Give one, as in "x\' = a - x; a = 1".',
        )
    return load_system(PREFIX + text)


def refuse_unsound(system: System) -> None:
    """Raise for the first error that is found in a system's functions and declarations.

    Raises
    ------
    SystemDefinitionError
        With the line of the plugin.
    """
    found = next((finding for finding in _findings(system) if finding.level == "error"), None)
    if found is None:
        return
    place = "" if found.file is None else f"{found.file}, line {found.line}: "
    raise SystemDefinitionError(
        f"{place}{found.what}: {found.sentence}", "`contwalk systems check` tells of all that is wrong."
    )


def _small(fields: CheckedFields) -> bool:
    """Whether derivatives of all fields cost milliseconds; of others only `systems check` takes them."""
    return sum(len(field.program.graph.nodes) for field in fields.values()) <= MOST_OPERATIONS


def _findings(system: System) -> list[Finding]:
    report = Report()
    period = check_period(report, system)
    samples = samples_of(system, period)
    fields = CheckedFields(system)
    fields.check(report)
    if system.transitions or system.conditions:
        from contwalk.plugin_check.events_at_load import check_events  # much that smooth systems do without

        check_events(report, system, fields, samples, period)
    check_angles_of_fields(report, system, fields, samples)
    for neutral in system.neutral:
        generator = traced_generator(report, neutral, system)
        if generator is not None and fields.complete and _small(fields):
            check_somewhere(report, words(neutral), generator, fields, samples)
    for quantity in system.conserved:
        from contwalk.plugin_check.conserved import check_conserved  # few systems declare any

        check_conserved(report, quantity, system, fields, samples)
    for name, field in fields.items():
        what = f"field of mode '{name}'"
        if check_never_finite(report, what, field, samples) and period is not None:
            check_repeats(report, what, field, samples, period)
    symmetric = Report()
    for symmetry in system.symmetries:
        form = vector_form(system, "map", "x_image")
        image = traced(symmetric, f"symmetry '{symmetry.name}'", symmetry.map, system, form)
        if image is not None and fields.complete:
            compare_symmetry(symmetric, symmetry, image, system, fields, samples, period)
    if any(finding.level == "error" for finding in symmetric.findings):  # for want of a period, perhaps
        for mode in system.modes:
            found = dict(fields.items()).get(mode.name)
            if found is not None:
                check_clock(report, f"field of mode '{mode.name}'", found, system, mode.field)
    return report.findings + symmetric.findings
