"""Which variants of a test `make test` and `make slow` try, where a matrix of them says much the same.

Of a test marked `drawn` a draw is tried that shows each value of each parameter at least once; of one marked
`drawn(4)` four variants, which show as many values as four can. The others are `make long`'s. The draw is the
same on every machine; `CONTWALK_TEST_DRAW=7 make test` makes another one.
"""

from __future__ import annotations

import os
import random
from collections import defaultdict
from collections.abc import Mapping, Sequence
from itertools import count

import pytest

Variant = Mapping[str, int]


def draw(variants: Sequence[Variant], most: int | None, dice: random.Random) -> set[int]:
    """Numbers of the variants to try; each variant says which value, by any number, each parameter has."""
    left = dice.sample(range(len(variants)), len(variants))
    chosen: set[int] = set()
    shown: set[tuple[str, int]] = set()
    for _ in count() if most is None else range(most):
        gain = {k: len(set(variants[k].items()) - shown) for k in left}
        best = max(left, key=gain.__getitem__, default=None)
        if best is None or (most is None and not gain[best]):
            break
        left.remove(best)
        chosen.add(best)
        shown |= variants[best].items()
    return chosen


def leave_to_long(items: Sequence[pytest.Item], seed: str) -> None:
    """Mark variants that are not drawn as long; those that are long anyway are no part of a draw.

    What is long is slow as well.
    """
    groups: dict[tuple[str, bool], list[pytest.Function]] = defaultdict(list)
    for item in items:
        mark = item.get_closest_marker("drawn")
        if mark is not None and isinstance(item, pytest.Function) and not item.get_closest_marker("long"):
            groups[_test(item), item.get_closest_marker("slow") is not None].append(item)
    for (test, _), group in groups.items():
        mark = group[0].get_closest_marker("drawn")
        most = mark.args[0] if mark is not None and mark.args else None
        chosen = draw(_numbered(group), most, random.Random(f"{seed} {test}"))
        for k, item in enumerate(group):
            if k not in chosen:
                item.add_marker(pytest.mark.long)
    for item in items:
        if item.get_closest_marker("long") is not None:
            item.add_marker(pytest.mark.slow)


def _numbered(group: Sequence[pytest.Function]) -> list[dict[str, int]]:
    """Values by their numbers: variants of a matrix share them, whether or not they can be compared."""
    return [{name: id(value) for name, value in item.callspec.params.items()} for item in group]


def _test(item: pytest.Function) -> str:
    return item.nodeid.partition("[")[0]


def given_seed() -> str:
    """Which draw is asked for."""
    return os.environ.get("CONTWALK_TEST_DRAW", "1")
