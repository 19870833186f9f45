"""`contwalk systems check`: what is wrong with a plugin, before any run."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from contwalk.plugin_check.system import Finding

_STYLES = {"ok": "green", "warning": "yellow", "error": "bold red"}


@click.command("check")
@click.argument("system", metavar="SYSTEM_OR_PATH")
def command(system: str) -> int:
    """Check an installed system or a plugin file, each finding with its line.

    A system with model choices is checked with the default model and with each choice varied. Exit code 2 if
    there is an error, 0 otherwise.
    """
    from contwalk.cli.terminal import console, line
    from contwalk.number_words import plural
    from contwalk.plugin_check.system import findings_of

    out = console()
    count, model = Counter[str](), ""
    for finding in findings_of(system):
        count[finding.level] += 1
        if finding.model != model:
            model = finding.model
            out.print()
            line(out, f"with {model}", style="bold")
        line(out, _text(finding), style=_STYLES[finding.level])
    out.print()
    line(out, f"{count['ok']} ok, {plural(count['warning'], 'warning')}, {plural(count['error'], 'error')}")
    return 2 if count["error"] else 0


def _text(finding: Finding) -> str:
    place = ""
    if finding.file is not None and finding.level != "ok":
        place = _short(finding.file) + (f":{finding.line}" if finding.line is not None else "") + ": "
    return f"{finding.level:<8} {place}{finding.what}: {finding.sentence}"


def _short(file: str) -> str:
    """A file under the current directory without it."""
    try:
        return str(Path(file).resolve().relative_to(Path.cwd()))
    except ValueError:
        return file
