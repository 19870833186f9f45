"""Texts with what happens to files: characters and lines lost, doubled, exchanged, put in."""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence

# What makes a difference to a grammar, and what would be dangerous if anything were run.
PIECES = [*"()[]{}<>=+-*/^'\",;:#%&|!~@.$\\ \n\t\0", "**", "1e999", "9^9^9", "if(", "then(", "else", ".."]
PIECES += ["[j]", "__import__('os').system('touch ran')", "exec", "eval(", "lambda", "é", "\u2028", "par "]
PIECES += ["x'=", "event e: x falls, x=", "table f % 9 0 1 t", "(" * 200, "-" * 300, "x+" * 400]


def mutated(texts: Sequence[str], count: int, seed: int) -> Iterator[str]:
    """So many texts, each made of one of some by one to five changes."""
    chance = random.Random(seed)
    for _ in range(count):
        text = chance.choice(texts)
        for _ in range(chance.choice((1, 1, 2, 5))):
            at, other = (chance.randrange(len(text) + 1) for _ in range(2))
            low, high = min(at, other), min(max(at, other), min(at, other) + chance.choice((1, 3, 40)))
            kind = chance.randrange(6)
            if kind == 0:
                text = text[:low] + text[high:]
            elif kind == 1:
                text = text[:high] + text[low:]
            elif kind == 2:
                lines = text.split("\n")
                chance.shuffle(lines)
                text = "\n".join(lines)
            elif kind == 3:
                text = text[:low] + chance.choice(texts)[low:high] + text[high:]
            else:
                text = text[:at] + chance.choice(PIECES) + text[at:]
        yield text
