"""Run the published problems and print what is found: `table.py [PROBLEM ...] [--markdown]`."""

from __future__ import annotations

import os
import sys
import tempfile
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # before NumPy is imported, as the command line does
sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from peers.compare import Verdict, judge
from peers.form import Study
from peers.running import peers, run_study

HEADINGS = ("problem", "listed", "found", "missed", "extra", "worst rel. error", "covered", "CPU s")


def main(arguments: list[str]) -> int:
    """Print a row for every study, and below what is wrong; 1 where that differs from what is known."""
    markdown = "--markdown" in arguments
    wanted = [argument for argument in arguments if not argument.startswith("--")]
    known = peers()
    unknown = sorted(set(wanted) - set(known))
    if unknown:
        print(f"No such problem: {', '.join(unknown)}. Known: {', '.join(known)}", file=sys.stderr)
        return 2
    _print_row(HEADINGS, markdown)
    if markdown:
        print("|---|" + "---:|" * (len(HEADINGS) - 1))
    complaints, surprises, seconds, listed, found = [], 0, 0.0, 0, 0
    for name in wanted or known:
        for study in known[name].studies:
            verdict, cost = _run(name, study)
            title = f"{known[name].title}: {study.name}" if study.name else known[name].title
            count = sum(value.times for value in study.values)
            _print_row((title, *_cells(verdict, count, cost)), markdown)
            seconds, listed, found = seconds + cost, listed + count, found + verdict.found
            told = "; ".join(verdict.complaints)
            if told:
                complaints.append(f"{title}: {f'known: {study.lost} ' if study.lost else ''}{told}")
            surprises += bool(told) != bool(study.lost)
    _print_row(("all", str(listed), str(found), "", "", "", "", f"{seconds:.0f}"), markdown)
    print("\n" + "\n\n".join(complaints))
    return 1 if surprises else 0


def _run(name: str, study: Study) -> tuple[Verdict, float]:
    with tempfile.TemporaryDirectory() as folder:
        ran = run_study(name, study, Path(folder))
    return judge(study, ran.branches), ran.seconds


def _cells(verdict: Verdict, listed: int, seconds: float) -> tuple[str, ...]:
    numbers = (str(listed), str(verdict.found), str(len(verdict.missed)), str(len(verdict.extra)))
    covered = "no" if verdict.uncovered else "yes"
    return *numbers, f"{verdict.worst:.1e}", covered, f"{seconds:.1f}"


def _print_row(cells: tuple[str, ...], markdown: bool) -> None:
    if markdown:
        print("| " + " | ".join(cells) + " |", flush=True)
    else:
        print(
            cells[0].ljust(52)
            + "".join(cell.rjust(18 if "." in cell and "e" in cell else 9) for cell in cells[1:]),
            flush=True,
        )


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
