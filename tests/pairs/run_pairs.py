"""Walk past pairs of crossings, as many as asked for: `python tests/pairs/run_pairs.py --help`.

It prints a table of how many were located, told as unlocated within an interval, or lost, a kind a line.
"""

from __future__ import annotations

# ruff: noqa: E402  (the number of threads is settled before NumPy is imported)
import os

for library in ("OPENBLAS", "MKL", "OMP"):
    os.environ.setdefault(f"{library}_NUM_THREADS", "1")

import argparse
import sys
from collections import Counter
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from pairs_judged import Verdict, judged, walked
from pairs_kinds import DIPS, KINDS, case

HEAD = """| kind | pairs | located | unlocated | lost, nearest and farthest | other |
|---|---|---|---|---|---|"""


def verdicts(kind: str, seeds: range, near_miss: bool) -> list[Verdict]:
    """What is told of the pairs of a kind."""
    drawn = (case(kind, seed, near_miss) for seed in seeds)
    return [judged(each, walked(each)) for each in drawn]


def line(kind: str, found: list[Verdict]) -> str:
    """A line of the table."""
    counts = Counter(each.outcome for each in found)
    lost = sorted(each.distance for each in found if each.outcome == "lost")
    told = f"{len(lost)} ({lost[0]:.0e} to {lost[-1]:.0e})" if lost else "0"
    known = ("located", "nothing", "unlocated", "undecided", "lost")
    right = counts["located"] + counts["nothing"]
    open_ = counts["unlocated"] + counts["undecided"]
    other = ", ".join(f"{n} {name}" for name, n in counts.items() if name not in known) or "0"
    return f"| {kind} | {len(found)} | {right} | {open_} | {told} | {other} |"


def main() -> int:
    """Run all kinds that are asked for; 1 if any crossing is lost, or told where there is none."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=100, help="pairs of each kind, seeds 0 to this, less one")
    parser.add_argument("--kinds", nargs="*", default=list(KINDS), metavar="KIND", help="all by default")
    parser.add_argument("--faults", action="store_true", help="print what was told where it is not right")
    given = parser.parse_args()
    wrong = 0
    print(HEAD)
    for kind in given.kinds:
        for near_miss in (False, True) if kind in DIPS else (False,):
            found = verdicts(kind, range(given.runs), near_miss)
            print(line(f"{kind}, as near a miss" if near_miss else kind, found), flush=True)
            faults = [each for each in found if each.outcome in ("lost", "false", "stopped")]
            wrong += len(faults)
            for each in faults if given.faults else ():
                print(f"    seed {each.seed}, {each.distance:.2g} apart: {each.outcome}; {each.text}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
