"""The page that says what became of all random systems, from their lines of results."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from typing import Any

INTRODUCTION = """\
Machines that nobody wrote, drawn from a seed: polynomial and trigonometric fields of 2 to 6 states with
parameters, some with a declared symmetry, some driven, some with events and resets. Each study is run through
the command line, and everything it stores is checked against the plugin's own text, evaluated without
contwalk: residuals of equilibria in 40 digits, orbits and their multipliers by SciPy's `solve_ivp` with
complex steps, counts of unstable directions by NumPy. `tests/random_systems/` has the generator and the
checks; this page is written by
"""

WIDE = """\
Machines drawn from a seed as in [random systems](random_systems.md), of kinds that are hard for doubles.
`graded`: reversible reactions with rates from 1e-9 to 1e9 and a sum that is conserved, undeclared. `ring`:
three to eight equal units, each coupled to its neighbours, no symmetry declared. `population`: competing
kinds, of which some fall to 1e-20 of the others. Counts of unstable directions are checked at twelve rows of
each branch of equilibria by solutions and eigenvalues in 100 digits, the waves of rings by their closed form,
all else as there: what a branch tells not to be known (`undecided`, `error`) is no fault. This page is
written by
"""

MEANING = {
    "internal": "internal error or traceback",
    "warning": "a warning of Python or NumPy",
    "exit-code": "wrong exit code, or a run that one branch has ended",
    "reason": "reason code and status do not fit",
    "message": "an outcome without a sentence",
    "incomplete": "a branch without an outcome",
    "empty": "no points and no failure",
    "direction": "a direction without an end",
    "end": "an end whose reason is not true",
    "order": "rows out of order",
    "count": "the count of unstable directions changes without a special point, or against its own",
    "residual": "a stored point that does not solve the equations",
    "unstable": "a count that the independent eigenvalues or multipliers contradict",
    "lost": "a special point that the closed form has is not told",
    "no-child": "a point that is followed has neither a branch nor a sentence",
    "creeps": "a branch that has not left its Hopf point",
    "twice": "a branch that is told twice",
    "unchecked": "the independent integration was too long: not checked",
    "hang": "more processor time than allowed",
    "harness": "the checks themselves failed",
}


def page(records: Iterable[Mapping[str, Any]], command: str, wide: bool = False) -> str:
    """The summary as Markdown; `wide`: of graded rates, rings and populations."""
    found = sorted(records, key=lambda r: r["seed"])
    branches = sum(_sum(found, "branches").values())
    cost = [sum(r.get(key, 0.0) for r in found) for key in ("seconds", "checking")]
    left_out = sum(r.get("left_out", 0) for r in found)
    lines = [
        "# Random systems" + (" of wide ranges" if wide else "") + ": what ended how",
        "",
        *(WIDE if wide else INTRODUCTION).splitlines(),
        "",
        f"    {command}",
        "",
        f"{len(found)} systems, {branches} branches, {sum(r.get('rows', 0) for r in found)} stored points; "
        f"{cost[0]:.0f} s of processor time for the studies, {cost[1]:.0f} s for the checks. "
        f"{left_out} points were not checked: from these orbits deviations grow by over 1e4 in a period, "
        "and no integration from a stored start alone comes back; or one takes too long.",
        "",
        "## Families",
        "",
        "| family | systems | equilibria | periodic orbits | hybrid orbits | exit code 1 | with a fault |",
        "|---|---|---|---|---|---|---|",
    ]
    for family in sorted({r["family"] for r in found}):
        own = [r for r in found if r["family"] == family]
        kinds = _sum(own, "branches")
        counted = " | ".join(str(kinds[k]) for k in ("equilibrium", "periodic_orbit", "hybrid_orbit"))
        failed, faulty = sum(r.get("code") == 1 for r in own), sum(bool(r["faults"]) for r in own)
        lines.append(f"| {family} | {len(own)} | {counted} | {failed} | {faulty} |")
    lines += _table("How branches ended", "branch: reason", _sum(found, "outcomes"))
    lines += _table("Special points, located", "label", _sum(found, "points"))
    lines += _table("Special points, unlocated", "label", _sum(found, "unlocated"))
    failing = Counter(f["code"] for r in found for f in r["faults"])
    lines += ["", "## Faults", "", "| code | what | systems | faults | seeds |", "|---|---|---|---|---|"]
    for code, count in failing.most_common():
        seeds = sorted({r["seed"] for r in found if any(f["code"] == code for f in r["faults"])})
        shown = ", ".join(map(str, seeds[:12])) + (", ..." if len(seeds) > 12 else "")
        lines.append(f"| {code} | {MEANING.get(code, '')} | {len(seeds)} | {count} | {shown} |")
    if not failing:
        lines.append("| none | | 0 | 0 | |")
    lines += [
        "",
        "`--show SEED` prints plugin and run file of a system, `--shrink SEED` a smaller one with the fault.",
        "",
    ]
    return "\n".join(lines)


def _sum(records: Iterable[Mapping[str, Any]], key: str) -> Counter[str]:
    total: Counter[str] = Counter()
    for record in records:
        total.update(record.get(key, {}))
    return total


def _table(title: str, head: str, counts: Counter[str]) -> list[str]:
    rows = [f"| {name} | {count} |" for name, count in sorted(counts.items())]
    return ["", f"## {title}", "", f"| {head} | number |", "|---|---|", *(rows or ["| none | 0 |"])]
