"""A line of a model, cut into numbers, names and signs."""

from __future__ import annotations

import re
import unicodedata
from dataclasses import dataclass

from contwalk.equations.nodes import ModelError

_TOKEN = re.compile(
    r"\s*(?:(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)|(?P<name>[^\W\d]\w*)"
    r"|(?P<sign>\*\*|<=|>=|==|!=|&&|\|\||\.\.|[-+*/^<>=()&|!~,:;'\[\]%@{}$\\\"]))"
)
_ALIKE = {"**": "^", "&&": "and", "&": "and", "||": "or", "|": "or", "!": "not"}


@dataclass(frozen=True, slots=True)
class Token:
    """A number, a name or a sign; `column` counts from 1."""

    kind: str
    text: str
    column: int

    def __str__(self) -> str:
        return f"'{self.text[:40]}'" if self.kind != "end" else "the end of the line"


def tokens(text: str) -> list[Token]:
    """The tokens of a line, an `end` last.

    Raises
    ------
    ModelError
        At a character that stands for nothing.
    """
    found, place = [], 0
    text = text.rstrip()
    while place < len(text):
        match = _TOKEN.match(text, place)
        if match is None:
            column = place + len(text[place:]) - len(text[place:].lstrip()) + 1
            raise ModelError(
                f"column {column}: {text[column - 1]!r} stands for nothing.",
                "Write numbers, names, + - * / ^ ( ) and commas; # begins a comment.",
            )
        kind = str(match.lastgroup)
        word = match.group(kind)
        if kind == "name":
            word = unicodedata.normalize("NFKC", word)  # as Python reads it
        found.append(Token(kind, _ALIKE.get(word, word), match.start(kind) + 1))
        place = match.end()
    return [*found, Token("end", "", len(text) + 1)]
