"""Sums of amounts that no reaction changes."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction


def dependent_rows(rows: Sequence[Sequence[Fraction]]) -> dict[int, dict[int, Fraction]]:
    """Rows of a matrix that are combinations of rows before them: each with the factors of these.

    What is computed with is exact. Of a stoichiometric matrix, a row for each amount and a column for each
    reaction, row `i` = sum of factors times rows says that amount `i` less the same sum of amounts stays as
    it is.

    Parameters
    ----------
    rows : sequence of sequences of Fraction, shape (m, n)
    """
    reduced: list[
        tuple[int, list[Fraction], dict[int, Fraction]]
    ] = []  # pivot, row, of which rows it is made
    found: dict[int, dict[int, Fraction]] = {}
    for i, row in enumerate(rows):
        left, made = list(row), {i: Fraction(1)}
        for pivot, other, of in reduced:
            factor = left[pivot] / other[pivot]
            if factor:
                left = [a - factor * b for a, b in zip(left, other, strict=True)]
                for j, value in of.items():
                    made[j] = made.get(j, Fraction(0)) - factor * value
        pivot = next((k for k, value in enumerate(left) if value), -1)
        if pivot < 0:
            found[i] = {j: -value for j, value in made.items() if j != i and value}
        else:
            reduced.append((pivot, left, made))
    return found


def without_differences(found: dict[int, dict[int, Fraction]]) -> dict[int, dict[int, Fraction]]:
    """Such combinations in which amounts are added only, where two of them together are one.

    Of E + ES + EI and I - E - ES, which stay as they are, the sum is I + EI.
    """
    better = dict(found)
    for i, factors in found.items():
        for j, others in found.items():
            both = {k: factors.get(k, 0) + others.get(k, 0) for k in {*factors, *others}}
            fewer = max(factors.values(), default=0) > 0 >= max(both.values(), default=0)
            if i != j and fewer and better[j] is others:  # else each would be the rest of the other
                better[i] = {k: Fraction(value) for k, value in both.items() if value} | {j: Fraction(-1)}
                break
    return better
