"""The command: measure, run, table."""

from __future__ import annotations

import argparse
import json
import os
import random
import shutil
import tempfile
from collections import Counter
from collections.abc import Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict
from pathlib import Path
from typing import Any

from tools.mutants.nearest import Nearest, measure
from tools.mutants.sites import Mutant, mutants_of
from tools.mutants.trial import load_libraries, passes, tried

ROOT = Path(__file__).resolve().parents[2]
PACKAGES = ("continuation", "diagram", "problems", "flow", "fields", "storage")
COPIED = (
    "contwalk",
    "systems",
    "tests",
    "benchmarks",
    "tools",
    "runs",
    "docs",
    "README.md",
    "pyproject.toml",
)
SURVIVED = "survived"
# Seconds that tests may take that are named and not measured.
LONGEST = 60.0
# A mutant, the tests to ask, what they took when they were measured, whether they run its line.
Trial = tuple[Mutant, list[str], float, bool]


def main() -> None:
    """Entry point."""
    parser = argparse.ArgumentParser(prog="python -m tools.mutants", description=__doc__)
    parser.add_argument("--folder", type=Path, default=ROOT / ".mutants", help="where results are kept")
    commands = parser.add_subparsers(dest="command", required=True)
    measuring = commands.add_parser("measure", help="which test runs which line")
    running = commands.add_parser("run", help="try mutants")
    running.add_argument("--count", type=int, default=400)
    running.add_argument("--seed", type=int, default=1)
    running.add_argument("--packages", nargs="+", default=list(PACKAGES))
    again = commands.add_parser("again", help="try those that survived once more")
    again.add_argument("--tests", nargs="+", default=[], help="with these tests, else with the nearest ones")
    again.add_argument("--only", nargs="+", default=[""], help="those in files named like this")
    for command in (measuring, running, again):
        command.add_argument("--jobs", type=int, default=1)
    for command in (running, again):
        command.add_argument("--worth", type=float, default=40.0, help="seconds of tests for one mutant")
    commands.add_parser("table", help="what survived")
    given = parser.parse_args()
    if given.command == "measure":
        measure(ROOT, given.folder, given.jobs)
    elif given.command == "run":
        known = {row["key"] for row in results(given.folder)}
        mutants = drawn(given.packages, given.count, given.seed)
        run(given.folder, [m for m in mutants if m.key not in known], given.jobs, given.worth)
    elif given.command == "again":
        run(given.folder, survivors(given.folder, given.only), given.jobs, given.worth, given.tests)
    else:
        print(table(results(given.folder)))


def drawn(packages: Iterable[str], count: int, seed: int) -> list[Mutant]:
    """So many mutants at random, in random order.

    A package gives as many as the root of how many it has, so that small ones are looked at as well.
    """
    places = {package: _of_package(package) for package in packages}
    shares = {package: len(mutants) ** 0.5 for package, mutants in places.items()}
    dice, chosen = random.Random(seed), []
    for package, mutants in places.items():
        share = round(count * shares[package] / sum(shares.values()))
        chosen += dice.sample(mutants, min(share, len(mutants)))
    dice.shuffle(chosen)
    return chosen


def _of_package(package: str) -> list[Mutant]:
    """All mutants of a package, without the tables of numbers that order conditions check."""
    folder = ROOT / "contwalk" / package
    files = sorted(str(p.relative_to(ROOT)) for p in folder.rglob("*.py") if "tableaus" not in p.parts)
    return [mutant for file in files for mutant in mutants_of(ROOT, file)]


def results(folder: Path) -> list[dict[str, Any]]:
    """What has been tried so far; of a mutant tried twice, the later outcome."""
    path = folder / "results.jsonl"
    if not path.exists():
        return []
    rows = [json.loads(line) for line in path.read_text().splitlines()]
    return list({row["key"]: row for row in rows}.values())


def survivors(folder: Path, texts: Sequence[str]) -> list[Mutant]:
    """Mutants that survived, where their lines stand now; those whose line is gone are told and left out."""
    rows = [row for row in results(folder) if row["outcome"] == SURVIVED]
    rows = [row for row in rows if any(text in row["file"] for text in texts)]
    files = {row["file"] for row in rows if (ROOT / row["file"]).exists()}
    now = {mutant.key: mutant for file in sorted(files) for mutant in mutants_of(ROOT, file)}
    for row in rows:
        if row["key"] not in now:
            print(f"gone {row['file']}: {row['old'].strip()}")
    return [now[row["key"]] for row in rows if row["key"] in now]


def run(folder: Path, mutants: list[Mutant], jobs: int, worth: float, tests: Sequence[str] = ()) -> None:
    """Try mutants with the tests that are given, or else with the nearest; each result is written at once."""
    nearest = None if tests else Nearest(ROOT, folder, worth)
    given: list[Trial] = []
    for mutant in mutants:
        if nearest is None:
            given.append((mutant, list(tests), LONGEST, True))
        else:
            asked, runs_it = nearest.to(mutant.file, mutant.line)
            given.append((mutant, asked, nearest.seconds(asked), runs_it))
    if given and not _sound(given[0][1]):
        raise SystemExit(
            "Tests of a copy without any mutant do not pass: what they say of mutants is worth nothing."
        )
    with (
        ProcessPoolExecutor(jobs, initializer=_prepare) as pool,
        (folder / "results.jsonl").open("a") as file,
    ):
        for number, row in enumerate(pool.map(_trial, given), 1):
            file.write(json.dumps(row) + "\n")
            file.flush()
            print(
                f"{number}/{len(given)} {row['outcome']:9} {row['file']}:{row['line']} {row['new'].strip()}"
            )


def _sound(tests: list[str]) -> bool:
    """Whether tests of an unchanged copy pass, as they are run for mutants."""
    _prepare()
    assert _copy is not None
    return passes(_copy, tests, 600.0) is True


_copy: Path | None = None


def _prepare() -> None:
    """A worker's own copy of the tree; the tests of an unchanged copy must pass, else all is `killed`."""
    global _copy
    os.environ["OPENBLAS_NUM_THREADS"] = "1"
    load_libraries()
    _copy = Path(tempfile.mkdtemp(prefix="mutants-"))
    for name in COPIED:
        source = ROOT / name
        if source.is_dir():
            shutil.copytree(source, _copy / name, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            shutil.copy(source, _copy / name)


def _trial(given: Trial) -> dict[str, Any]:
    mutant, tests, seconds, runs_it = given
    assert _copy is not None
    outcome = tried(_copy, mutant, tests, seconds) if tests else SURVIVED
    told = {"key": mutant.key, "outcome": outcome, "tests": len(tests), "runs_it": runs_it}
    return asdict(mutant) | told


def table(rows: list[dict[str, Any]]) -> str:
    """Counts by package, and the survivors one by one."""
    lines = ["| package | mutants | killed | timeout | survived |", "|---|---|---|---|---|"]
    for package in sorted({row["file"].split("/")[1] for row in rows}):
        counts = Counter(row["outcome"] for row in rows if row["file"].split("/")[1] == package)
        outcomes = [counts[name] for name in ("killed", "timeout", SURVIVED)]
        lines.append(f"| {package} | {counts.total()} | " + " | ".join(map(str, outcomes)) + " |")
    for row in sorted(rows, key=lambda r: (r["file"], r["line"])):
        if row["outcome"] == SURVIVED:
            lines += ["", f"{row['file']}:{row['line']} ({row['tests']} tests, {row['kind']})"]
            lines += [f"    - {row['old'].strip()}", f"    + {row['new'].strip()}"]
    return "\n".join(lines)


if __name__ == "__main__":
    main()
