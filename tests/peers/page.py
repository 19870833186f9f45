"""The table of docs/howto/machines.md: every listed value of a machine, and what a run finds of it."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path

from peers.compare import Verdict
from peers.form import Peer, Study, Value

PAGE = Path(__file__).resolve().parents[2] / "docs" / "howto" / "machines.md"
BEGIN, END = "<!-- table: begin -->\n", "<!-- table: end -->\n"
HEADINGS = ("machine", "checked", "found", "reference", "source", "difference", "claimed", "covered")
# Whether numbers are written right or left of their column.
RULES = ("---", "---", "---:", "---:", "---", "---:", "---:", "---")
# What does not depend on the run.
LISTED = (0, 1, 3, 4)
OF = {"equilibrium": "equilibria", "orbit": "orbits"}


def listed(peer: Peer, study: Study, value: Value) -> tuple[str, ...]:
    """The cells of a row that are known before a run: machine, what is checked, reference, source."""
    several = f" of {value.times} branches" if value.times > 1 else ""
    marked = f"`{next(iter(study.run['mark']))}`: " if value.label == "UZ" else ""
    where = f"{value.label} of {OF[value.of]}{several}, `{study.run['continue']['parameter']}`"
    checked = f"{study.name}: {marked}{where}" if study.name else f"{marked}{where}"
    return f"[{peer.title}](#{anchor(peer.title)})", checked, _digits(value.value), value.source


def anchor(heading: str) -> str:
    """What a heading is called in links."""
    return re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", "-")


def rows_of(peer: Peer, study: Study, verdict: Verdict) -> list[tuple[str, ...]]:
    """A row for every listed value; of several points that are one value, the one farthest from it."""
    rows = []
    for value in study.values:
        met = max((met for met in verdict.met if met.value is value), key=lambda met: met.off)
        machine, checked, reference, source = listed(peer, study, value)
        numbers = f"{met.off:.1e}", f"{met.error:.1e}", "yes" if met.covered else "no"
        rows.append((machine, checked, _digits(met.there), reference, source, *numbers))
    return rows


def _digits(number: float) -> str:
    return f"{number:.15g}"


def stored_rows() -> list[tuple[str, ...]]:
    """The rows that the page has."""
    text = PAGE.read_text(encoding="utf-8")
    lines = text[text.index(BEGIN) + len(BEGIN) : text.index(END)].splitlines()[2:]
    return [tuple(line.removeprefix("| ").removesuffix(" |").split(" | ")) for line in lines]


def write(machines: Mapping[str, Peer], fresh: Mapping[str, list[tuple[str, ...]]]) -> None:
    """Write the table anew: fresh rows of the machines that were run, stored ones of the others."""
    stored, rows = stored_rows(), []
    for name, peer in machines.items():
        title = f"[{peer.title}]"
        rows += fresh.get(name, [row for row in stored if row[0].startswith(title)])
    table = "".join("| " + " | ".join(row) + " |\n" for row in [HEADINGS, RULES, *rows])
    text = PAGE.read_text(encoding="utf-8")
    before, rest = text.split(BEGIN)
    PAGE.write_text(before + BEGIN + table + END + rest.split(END)[1], encoding="utf-8")
