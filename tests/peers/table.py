"""Run the published problems and print what is found.

table.py [PROBLEM ...] [--markdown]     all, or some
table.py [MACHINE ...] --page           the same of machines with events, and into docs/howto/machines.md
table.py [PROBLEM ...] --run-files DIR  write the run files of the studies there, and run nothing
"""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
from collections.abc import Mapping
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # before NumPy is imported, as the command line does
sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from peers import page
from peers.compare import Verdict, judge
from peers.form import Peer, Study
from peers.running import machines, peers, run_study, write_run_file

HEADINGS = ("problem", "listed", "found", "missed", "extra", "worst rel. error", "covered", "CPU s")


def main(arguments: list[str]) -> int:
    """Print a row for every study, and below what is wrong; 1 where that differs from what is known."""
    options = _options(arguments)
    known = machines() if options.page else peers()
    unknown = sorted(set(options.problems) - set(known))
    if unknown:
        print(f"No such problem: {', '.join(unknown)}. Known: {', '.join(known)}", file=sys.stderr)
        return 2
    chosen = {name: known[name] for name in options.problems or known}
    if options.run_files:
        return _write_run_files(chosen, options.run_files)
    return _run_all(chosen, options)


def _options(arguments: list[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("problems", nargs="*", metavar="PROBLEM", help="names of files, without .py; all")
    parser.add_argument("--markdown", action="store_true", help="print the table as Markdown")
    parser.add_argument("--page", action="store_true", help="write the table of docs/howto/machines.md")
    parser.add_argument("--run-files", metavar="DIR", type=Path, help="write run files instead of running")
    return parser.parse_args(arguments)


def _run_all(chosen: Mapping[str, Peer], options: argparse.Namespace) -> int:
    _print_row(HEADINGS, options.markdown)
    if options.markdown:
        print("|---|" + "---:|" * (len(HEADINGS) - 1))
    complaints, surprises, seconds, listed, found = [], 0, 0.0, 0, 0
    rows: dict[str, list[tuple[str, ...]]] = {name: [] for name in chosen}
    for name, peer in chosen.items():
        for study in peer.studies:
            verdict, cost = _run(name, study)
            title = _title(peer, study)
            count = sum(value.times for value in study.values)
            _print_row((title, *_cells(verdict, count, cost)), options.markdown)
            seconds, listed, found = seconds + cost, listed + count, found + verdict.found
            told = "; ".join(verdict.complaints)
            if told:
                complaints.append(f"{title}: {f'known: {study.lost} ' if study.lost else ''}{told}")
            elif options.page:
                rows[name] += page.rows_of(peer, study, verdict)
            surprises += bool(told) != bool(study.lost)
    _print_row(("all", str(listed), str(found), "", "", "", "", f"{seconds:.0f}"), options.markdown)
    print("\n" + "\n\n".join(complaints))
    if options.page and not complaints:
        page.write(machines(), rows)
    return 1 if surprises else 0


def _title(peer: Peer, study: Study) -> str:
    return f"{peer.title}: {study.name}" if study.name else peer.title


def _write_run_files(chosen: Mapping[str, Peer], folder: Path) -> int:
    folder.mkdir(parents=True, exist_ok=True)
    for name, peer in chosen.items():
        for study in peer.studies:
            path = folder / f"{'_'.join([name, *study.name.split()])}.yaml"
            write_run_file(name, study, path)
            print(path)
    return 0


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
