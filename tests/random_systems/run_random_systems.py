"""Run random systems, as many as asked for: `python tests/random_systems/run_random_systems.py --help`.

Results are lines of JSON, one a system, in a file that is taken up again: what stands in it is not run again.
"""

from __future__ import annotations

# ruff: noqa: E402  (the number of threads is settled before NumPy is imported)
import os

for library in ("OPENBLAS", "MKL", "OMP"):
    os.environ.setdefault(f"{library}_NUM_THREADS", "1")

import argparse
import json
import signal
import sys
import time
import traceback
from pathlib import Path
from typing import Any

from random_recipe import Recipe
from random_recipes import FIRST_WIDE, recipe
from random_shrink import shrunk
from random_study import checked, plain
from random_summary import page

COMMAND = "python tests/random_systems/run_random_systems.py {}--systems {}{} --summary docs/{}"


class TooLong(BaseException):
    """A study has used its processor time; no `except Exception` may swallow it."""


def _alarm(number: int, frame: Any) -> None:
    raise TooLong


def one(chosen: Recipe, limit: float) -> dict[str, Any]:
    """The record of a recipe, whatever happens."""
    begin = time.process_time()
    signal.signal(signal.SIGPROF, _alarm)
    signal.setitimer(signal.ITIMER_PROF, limit)
    try:
        return checked(chosen)
    except TooLong:
        code, text = "hang", f"more than {limit:g} s of processor time"
    except Exception:
        code, text = "harness", traceback.format_exc(limit=-3)
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
    return {
        "seed": chosen.seed,
        "family": chosen.family,
        "states": chosen.states,
        "seconds": round(time.process_time() - begin, 3),
        "faults": [{"code": code, "where": "run", "text": text}],
    }


def stored(path: Path) -> dict[int, dict[str, Any]]:
    """Records that a results file holds; a last line that a kill has cut is dropped."""
    if not path.exists():
        return {}
    text = path.read_text(encoding="utf-8")
    whole = text[: text.rfind("\n") + 1]
    if whole != text:
        path.write_text(whole, encoding="utf-8")
    return {entry["seed"]: entry for entry in map(json.loads, whole.splitlines())}


def main() -> int:
    """Run what is missing, write the summary; 1 if anything failed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--systems", type=int, default=2000, help="seeds 0 to this number, less one")
    parser.add_argument("--first", type=int, default=0, help="first seed")
    parser.add_argument(
        "--results", type=Path, default=Path("random_systems.jsonl"), help="where results are kept"
    )
    parser.add_argument("--limit", type=float, default=120.0, help="seconds of processor time for one system")
    parser.add_argument("--summary", type=Path, help="write the summary of all results here, as Markdown")
    parser.add_argument("--small", action="store_true", help="as small as the test suite runs them")
    parser.add_argument("--show", type=int, metavar="SEED", help="print plugin and run file of one system")
    parser.add_argument(
        "--shrink", type=int, metavar="SEED", help="find a smaller system with the same first fault"
    )
    given = parser.parse_args()
    if given.show is not None:
        print(recipe(given.show).plugin_text(), recipe(given.show).run_text(), sep="\n")
        return 0
    if given.shrink is not None:
        small, record = shrunk(recipe(given.shrink).small(), checked)
        print(small.plugin_text(), small.run_text(), json.dumps(record["faults"], indent=1), sep="\n")
        return 0
    records = stored(given.results)

    def chosen(seed: int) -> Recipe:
        return recipe(seed).small() if given.small else recipe(seed)

    with given.results.open("a", encoding="utf-8") as out:
        for seed in range(given.first, given.systems):
            if seed in records:
                continue
            records[seed] = one(chosen(seed), given.limit)
            out.write(json.dumps(records[seed], default=plain) + "\n")
            out.flush()
            for fault in records[seed]["faults"]:
                print(f"{seed}: {fault['code']} at {fault['where']}: {fault['text'][:200]}", flush=True)
    if given.summary:
        wide = given.first >= FIRST_WIDE
        first = f"--first {given.first} " if given.first else ""
        small = " --small" if given.small else ""
        command = COMMAND.format(first, given.first + len(records), small, given.summary.name)
        given.summary.write_text(page(records.values(), command, wide), encoding="utf-8")
    return int(any(r["faults"] for r in records.values()))


if __name__ == "__main__":
    sys.exit(main())
