"""The lines of an .ode file: joined where they go on, and written out where they stand for many."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass

from contwalk.equations.nodes import ModelError

_RANGE = re.compile(r"\[\s*(-?\d+)\s*\.\.\s*(-?\d+)\s*\]")
_BLOCK = re.compile(r"^%\s*" + _RANGE.pattern)
_INDEX = re.compile(r"\[([\dj+*\s-]*)\]")
_TERMS = re.compile(r"[+-]?(?:\d+\*)?(?:j|\d+)")
# Lines that a line or a block may stand for.
LARGEST = {"copies": 2000}

Wrong = Callable[[int, str, str], ModelError]


@dataclass(frozen=True)
class Line:
    """A line of the file, written out; `number` is that of its first part."""

    number: int
    text: str


def lines_of(text: str, wrong: Wrong) -> Iterator[Line]:
    """What an .ode file says up to its `done`, without comments.

    Raises
    ------
    ModelError
        For a range or an index that is none.
    """
    found = list(_joined(text))
    copies = 0
    at = 0
    while at < len(found):
        line = found[at]
        block = _BLOCK.match(line.text)
        if block is None:
            inside, at = [line], at + 1
            span = _RANGE.search(line.text)
        else:
            end = next((k for k in range(at + 1, len(found)) if found[k].text.startswith("%")), None)
            if end is None:
                raise wrong(line.number, "the block has no end.", "Close it by a line of a % alone.")
            inside, at, span = found[at + 1 : end], end + 1, block
        if span is None:
            yield from inside
            continue
        low, high = int(span.group(1)), int(span.group(2))
        copies += (abs(high - low) + 1) * len(inside)
        if high < low or copies > LARGEST["copies"]:
            raise wrong(
                line.number,
                f"[{low}..{high}] stands for no lines." if high < low else "the ranges stand for many lines.",
                f"Ranges go upwards, and a file has at most {LARGEST['copies']} lines by them.",
            )
        for j in range(low, high + 1):
            yield from (Line(each.number, _written_out(each, j, wrong)) for each in inside)


def _joined(text: str) -> Iterator[Line]:
    """Lines that end in a backslash joined with the next; comments and what follows `done` left out."""
    first, so_far = 0, ""
    for number, whole in enumerate(text.replace("\r\n", "\n").replace("\r", "\n").split("\n"), 1):
        line = whole.strip()
        first = first if so_far else number
        if line.endswith("\\"):
            so_far += line[:-1] + " "
            continue
        line, so_far = (so_far + line).strip(), ""
        if line.startswith(("#", '"')) or not line:
            continue
        if re.fullmatch(r"(?i)d(one)?", line.partition("#")[0].strip()):
            return
        yield Line(first, line.partition("#")[0].strip())
    if so_far:
        yield Line(first, so_far.strip())


def _written_out(line: Line, j: int, wrong: Wrong) -> str:
    """A line with its range and its indices of `j` as numbers."""

    def number(match: re.Match[str]) -> str:
        text = re.sub(r"\s", "", match.group(1))
        terms = _TERMS.findall(text)
        if not terms or "".join(terms) != text:
            raise wrong(line.number, f"the index [{text}] is none.", "As in [j], [j+1], [2*j-1].")
        value = sum(_term(term, j) for term in terms)
        before = line.text[: match.start()][-1:]
        if value < 0 and (before.isalnum() or before == "_"):
            raise wrong(line.number, f"the index [{text}] is {value} at j = {j}.", "Begin the range later.")
        return str(value)

    return _INDEX.sub(number, _RANGE.sub(str(j), line.text))


def _term(text: str, j: int) -> int:
    """The value of one term of an index, as `+2*j`."""
    sign = -1 if text.startswith("-") else 1
    value = 1
    for factor in text.lstrip("+-").split("*"):
        value *= j if factor == "j" else int(factor[:9])
    return sign * value
