"""Machines that nobody wrote: nothing stored is wrong, and nothing is lost without a word.

What is checked stands in `random_checks`; `run_random_systems.py` runs more of them, deeper.
"""

from __future__ import annotations

import pytest
from random_recipes import FIRST_WIDE, recipe
from random_study import checked

SYSTEMS = 200
# Some are tried by `make test`, some with what is slow, so that each family is; the others with what is long.
QUICK, SLOW = range(12), range(30, 39)
# Further ones that showed a fault once: every other one is slow, the others are long.
MENDED = (377, 574, 610, 657, 742, 934, 980, 1039, 1043, 1259, 1698, 1776)

# Of wide ranges and equal units: one is tried by `make test`, the others with what is long.
WIDE, QUICK_WIDE = range(FIRST_WIDE, FIRST_WIDE + 30), (FIRST_WIDE + 4,)

# Faults that are known and open, by seed. Strict: who mends one takes it off.
KNOWN: dict[int, str] = {}


def _marked(seed: int) -> object:
    marks = [pytest.mark.xfail(strict=True, reason=KNOWN[seed])] if seed in KNOWN else []
    if seed not in (*QUICK, *QUICK_WIDE):
        marks.append(pytest.mark.slow)
    if seed not in (*QUICK, *SLOW, *MENDED[::2], *QUICK_WIDE):
        marks.append(pytest.mark.long)
    return pytest.param(seed, marks=marks, id=f"{recipe(seed).family}-{seed}")


@pytest.mark.parametrize("seed", [_marked(seed) for seed in (*range(SYSTEMS), *MENDED, *WIDE)])
def test_nothing_is_wrong_and_nothing_is_lost(seed):
    small = recipe(seed).small()
    found = checked(small)["faults"]
    shown = "\n".join(f"{f['code']} at {f['where']}: {f['text']}" for f in found)
    assert not found, f"{shown}\n\n{small.plugin_text()}\n{small.run_text()}"
