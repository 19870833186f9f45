"""The grammar of expressions: from tokens to a tree, by the precedence of operators."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from contwalk.equations.nodes import LIMITS, RELATIONS, ModelError, Node, name, node
from contwalk.equations.tokens import Token, tokens


@dataclass(frozen=True)
class Precedence:
    """How tightly operators bind, higher numbers more tightly; signs and `not` by `sign` and `negation`.

    `rightwards` are operators of which the last in a row comes first.
    """

    operators: Mapping[str, int]
    sign: int
    negation: int
    rightwards: frozenset[str] = frozenset()


_ARITHMETIC = {"+": 5, "-": 5, "*": 6, "/": 6, "^": 8}
# As in Python and on paper.
USUAL = Precedence({"or": 1, "and": 2} | dict.fromkeys(RELATIONS, 4) | _ARITHMETIC, 7, 3, frozenset({"^"}))
_WORDS = ("and", "or", "not")
_RESERVED = ("if", "then", "else", *_WORDS)


class Parser:
    """Reads expressions from the tokens of a line.

    Parameters
    ----------
    line : sequence of Token
    precedence : Precedence
    """

    def __init__(self, line: Sequence[Token], precedence: Precedence = USUAL) -> None:
        self._line, self._precedence = line, precedence
        self._at, self._inside = 0, 0

    @property
    def next(self) -> Token:
        """The token that comes next."""
        return self._line[self._at]

    def seen(self, *texts: str) -> bool:
        """Whether these signs or words come next; nothing is taken."""
        coming = [token.text for token in self._line[self._at : self._at + len(texts)] if token.kind != "end"]
        return coming == list(texts)

    def took(self, *texts: str) -> bool:
        """Takes these signs or words if they come next."""
        if not self.seen(*texts):
            return False
        self._at += len(texts)
        return True

    def need(self, text: str, remedy: str = "") -> None:
        """Takes a sign that must come next."""
        if not self.took(text):
            raise self.wrong(f"{self.next} stands where '{text}' must", remedy)

    def take_name(self) -> str:
        """Takes a name that must come next."""
        token = self.next
        if token.kind != "name" or token.text in _RESERVED:
            raise self.wrong(f"{token} stands where a name must")
        self._at += 1
        return token.text

    def end(self) -> None:
        """Nothing may come any more."""
        if self.next.kind != "end":
            raise self.wrong(
                f"{self.next} is one too many",
                "Products are written with *, one equation a line or before a ;.",
            )

    def wrong(self, what: str, remedy: str = "") -> ModelError:
        """What is said of the token that comes next."""
        return ModelError(f"column {self.next.column}: {what}.", remedy)

    def expression(self, least: int = 0) -> Node:
        """An expression of operators that bind as tightly as `least` or more."""
        self._inside += 1
        if self._inside > LIMITS["parentheses"]:
            raise self.wrong(
                f"more than {LIMITS['parentheses']} parentheses or signs stand inside each other",
                "Give parts of the expression names of their own.",
            )
        left = self._operand()
        while True:
            operator = self.next.text if self.next.kind != "number" else ""
            binds = self._precedence.operators.get(operator, -1)
            if binds < least or binds < 0:
                break
            self._at += 1
            rightwards = operator in self._precedence.rightwards
            right = self.expression(binds if rightwards else binds + 1)
            if operator in RELATIONS and left.kind in RELATIONS and self._precedence is USUAL:
                raise self.wrong(
                    "two comparisons stand in a row", "Write (a < b) & (b < c); parentheses make it clear."
                )
            left = node(operator, left, right)
        self._inside -= 1
        return left

    def _operand(self) -> Node:
        token = self.next
        if token.text in ("-", "+", "~"):
            self._at += 1
            inner = self.expression(self._precedence.sign)
            return inner if token.text == "+" else node("negative", inner)
        if token.text == "not" and token.kind in ("sign", "name"):
            self._at += 1
            return node("not", self.expression(self._precedence.negation))
        if self.took("("):
            inner = self.expression()
            self.need(")", "Each ( needs its ).")
            return inner
        if token.kind == "number":
            self._at += 1
            value = float(token.text)
            if not math.isfinite(value):
                raise self.wrong(f"the number {token} is larger than floats are")
            return Node("number", value)
        if token.text == "if" and token.kind == "name":
            return self._choice()
        if token.kind != "name" or token.text in _RESERVED:
            raise self.wrong(f"{token} stands where a number, a name or ( must")
        self._at += 1
        return self._call(token.text) if self.took("(") else name(token.text)

    def _call(self, function: str) -> Node:
        arguments: list[Node] = []
        if not self.took(")"):
            arguments.append(self.expression())
            while self.took(","):
                arguments.append(self.expression())
            self.need(")", f"The arguments of {function}( end with ), and are parted by commas.")
        return node("call", *arguments, value=function)

    def _choice(self) -> Node:
        parts = []
        for word in ("if", "then", "else"):
            form = "The form is if(condition)then(value)else(value)."
            self.need(word, form)
            self.need("(", form)
            parts.append(self.expression())
            self.need(")", form)
        return node("if", *parts)


def expression_of(text: str, precedence: Precedence = USUAL) -> Node:
    """The tree of an expression.

    Raises
    ------
    ModelError
        With the column.
    """
    parser = Parser(tokens(text), precedence)
    found = parser.expression()
    parser.end()
    return found
