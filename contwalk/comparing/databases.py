"""`diff`: two databases beside each other."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from contwalk.branch import Branch
from contwalk.comparing.curve import Curve
from contwalk.comparing.difference import BRANCH, END, MODEL, PARAMETER, POINT, Difference
from contwalk.comparing.families import BEGINNING, CURVE, IMAGE, Family, described, families
from contwalk.comparing.points import Stored, compared, paired, stored
from contwalk.comparing.rows import Met, absent, met, moved, turned
from contwalk.labels import END as END_POINT
from contwalk.storage import Database, open_database


@dataclass(frozen=True)
class Compared:
    """Branches of both databases that are the same, and what differs on them.

    Parameters
    ----------
    a, b : tuple of str
        Names; several where one database has in pieces what the other has in one, none where it has nothing.
    by : str
        `curve`, `image` or `beginning`; empty where one database has nothing.
    what : str
        What the branch is, in words.
    points, rhs, seconds : tuple of two numbers
        Points, evaluations of the vector field and seconds in A and in B.
    differences : tuple of Difference
    """

    a: tuple[str, ...]
    b: tuple[str, ...]
    by: str
    what: str
    points: tuple[int, int]
    rhs: tuple[int, int]
    seconds: tuple[float, float]
    differences: tuple[Difference, ...]


@dataclass(frozen=True)
class Comparison:
    """What `diff` finds.

    Parameters
    ----------
    a, b : str
        The files.
    branches : tuple of Compared
    differences : tuple of Difference
        Those of the whole run: system, model and fixed parameters.
    notes : tuple of str
        What is told beside, and is no difference: versions, accuracies, pieces, images.
    """

    a: str
    b: str
    branches: tuple[Compared, ...]
    differences: tuple[Difference, ...]
    notes: tuple[str, ...]

    @property
    def same(self) -> bool:
        """Whether nothing differs but what it cost."""
        return not self.all_differences

    @property
    def all_differences(self) -> tuple[Difference, ...]:
        """Those of the whole run, and those of all branches."""
        return (*self.differences, *(each for branch in self.branches for each in branch.differences))


def diff(a: str | Path | Database, b: str | Path | Database) -> Comparison:
    """Compare two databases, given as files or open.

    Branches are matched by what they are, not by name. Special points, ends, stability and admissibility are
    compared within the sum of the errors that both databases claim; counts of points and cost are told.

    Parameters
    ----------
    a, b : str, Path or Database

    Returns
    -------
    Comparison

    Raises
    ------
    DatabaseError
        If a file is missing, is not a contwalk database, or is damaged.
    """
    opened: list[Database] = []
    try:
        sides = []
        for each in (a, b):
            if isinstance(each, Database):
                sides.append(each)
            else:
                opened.append(open_database(each))
                sides.append(opened[-1])
        return _compare(sides[0], sides[1], (_named(a), _named(b)))
    finally:
        for database in opened:
            database.close()


def _named(given: str | Path | Database) -> str:
    return str(given) if not isinstance(given, Database) else str(given.path or "in memory")


def _compare(a: Database, b: Database, names: tuple[str, str]) -> Comparison:
    of_a, of_b = a.branches(), b.branches()
    found, only_a, only_b = families(of_a, of_b)
    # Branches that have stopped before their first point are beside each other by number.
    empty = [x for x in of_a if not len(x)], [x for x in of_b if not len(x)]
    branches = [_family(family) for family in found]
    branches += [_alone(x, "A") for x in [*only_a, *empty[0][len(empty[1]) :]]]
    branches += [_alone(x, "B") for x in [*only_b, *empty[1][len(empty[0]) :]]]
    notes = [*_headers_beside(a, b), *_told_families(found)]
    return Comparison(*names, tuple(branches), tuple(_headers(a, b, found)), tuple(notes))


# -- the whole run -------------------------------------------------------------------------------------------


def _headers(a: Database, b: Database, found: Sequence[Family]) -> Iterator[Difference]:
    """System, model, states, and parameters that are fixed."""
    one, other = a.header, b.header
    if one.system != other.system:
        yield Difference(MODEL, f"A is of the system {one.system}, B of {other.system}.")
    for name in sorted({*one.model, *other.model}):
        values = [str(header.model.get(name, "not declared")) for header in (one, other)]
        if values[0] != values[1]:
            yield Difference(MODEL, f"The model choice {name} is {values[0]} in A and {values[1]} in B.")
    said: set[str] = set()
    for family in found:
        for difference in _fixed(family.a[0], family.b[0]):
            if difference.text not in said:
                said.add(difference.text)
                yield difference


def _fixed(a: Branch, b: Branch) -> Iterator[Difference]:
    for what, one, other in (
        (MODEL, a.info.states, b.info.states),
        (PARAMETER, tuple(a.info.parameters), tuple(b.info.parameters)),
    ):
        for names, has, lacks in ((set(one) - set(other), "A", "B"), (set(other) - set(one), "B", "A")):
            if names:
                word = "states" if what == MODEL else "parameters"
                text = f"Only {has} has the {word} {', '.join(sorted(names))}; {lacks} does not."
                yield Difference(what, text)
    free = {*a.info.free, *b.info.free}
    moving = a.info.settings.get("path") or b.info.settings.get("path")
    for name, value in a.info.parameters.items():
        other_value = b.info.parameters.get(name)
        if name in free or other_value is None or moving or value == other_value:
            continue
        text = f"The fixed parameter {name} is {value!r} in A and {other_value!r} in B."
        yield Difference(
            PARAMETER,
            text,
            quantity=name,
            value_a=value,
            value_b=other_value,
            difference=abs(value - other_value),
            allowed=0.0,
        )


def _headers_beside(a: Database, b: Database) -> Iterator[str]:
    for key, words in (
        ("contwalk_version", "Made with contwalk"),
        ("accuracy", "Accuracy"),
        ("numpy", "Made with numpy"),
        ("numba", "Made with numba"),
        ("llvmlite", "Made with llvmlite"),
        ("processor", "Made on"),
    ):
        values = [_in_words(each.header.provenance, key) for each in (a, b)]
        if values[0] != values[1]:
            yield f"{words}: {values[0]} in A, {values[1]} in B."
    if a.header.provenance.get("plugin_sha256") != b.header.provenance.get("plugin_sha256"):
        yield "The plugin's text is not the same in both."


def _in_words(provenance: Mapping[str, Any], key: str) -> str:
    return str(provenance.get(key, "not told"))


def _told_families(found: Sequence[Family]) -> Iterator[str]:
    for family in found:
        a, b = _names(family.a), _names(family.b)
        if family.by == IMAGE:
            yield (
                f"{a} of A and {b} of B have the same parameters, periods and eigenvalues, and other states: "
                f"images of each other under a symmetry."
            )
        if len(family.a) != len(family.b):
            yield f"What {a} is in A, {b} is in B: the branch is cut into other pieces."


def _names(branches: Sequence[Branch]) -> str:
    return " + ".join(x.name for x in branches)


# -- branches ------------------------------------------------------------------------------------------------


def _cost(branches: Sequence[Branch], key: str) -> float:
    return float(sum(x.cost.get(key, 0) for x in branches))


def _family(family: Family) -> Compared:
    a, b = family.a, family.b
    return Compared(
        tuple(x.name for x in a),
        tuple(x.name for x in b),
        family.by,
        described(a[0]),
        (sum(map(len, a)), sum(map(len, b))),
        (int(_cost(a, "rhs")), int(_cost(b, "rhs"))),
        (_cost(a, "seconds"), _cost(b, "seconds")),
        tuple(_differences(family)),
    )


def _alone(branch: Branch, side: str) -> Compared:
    other = "B" if side == "A" else "A"
    text = f"Only {side} has {branch.name}: {described(branch)}. {other} has no such branch."
    there = side == "A"
    difference = Difference(BRANCH, text, branch.name if there else "", "" if there else branch.name)
    points, rhs, seconds = len(branch), int(_cost([branch], "rhs")), _cost([branch], "seconds")
    return Compared(
        (branch.name,) if there else (),
        () if there else (branch.name,),
        "",
        described(branch),
        (points, 0) if there else (0, points),
        (rhs, 0) if there else (0, rhs),
        (seconds, 0.0) if there else (0.0, seconds),
        (difference,),
    )


def _differences(family: Family) -> Iterator[Difference]:
    a, b = family.curves()
    if family.by == BEGINNING:
        text = (
            f"{family.a[0].name} of A ({described(family.a[0])}) and {family.b[0].name} of B "
            f"({described(family.b[0])}) begin alike, and are not one curve."
        )
        yield Difference(BRANCH, text, family.a[0].name, family.b[0].name)
        yield from _otherwise(family.a[0], family.b[0])
    else:
        yield from _rows(a, b, family.by)
    pairs, only_a, only_b = paired(stored(a), stored(b), family.by == BEGINNING)
    for one, other in pairs:
        yield from compared(one, other)
    whole = family.by != BEGINNING
    for side, left, others in (("A", only_a, b), ("B", only_b, a)):
        for each in left:
            if each.point.label == END_POINT and whole and _goes_on(each, others):
                continue
            yield _unpaired(each, side)
    yield from _outcomes(family)


def _otherwise(a: Branch, b: Branch) -> Iterator[Difference]:
    """In which respect two branches are of another kind: their closure, and the events of their orbits."""
    if a.info.closure != b.info.closure:
        text = f"Orbits close by {a.info.closure} on {a.name} of A, by {b.info.closure} on {b.name} of B."
        yield Difference(BRANCH, text, a.name, b.name)
    one, other = Counter(a.info.signature or ()), Counter(b.info.signature or ())
    for side, more in (("A", one - other), ("B", other - one)):
        if more:
            events = ", ".join(sorted(more.elements()))
            yield Difference(BRANCH, f"Only in {side} the orbits have: {events}.", a.name, b.name)


def _rows(a: Sequence[Curve], b: Sequence[Curve], by: str) -> Iterator[Difference]:
    """Both ways: rows of A on B, and of B on A."""
    found: list[Difference] = []
    for side, own, others in (("A", a, b), ("B", b, a)):
        for curve in own:
            places: list[Met] = met(curve, others)
            found += absent(curve, places, side)
            found += _new(found, moved(curve, places, side))
            found += _new(found, turned(curve, places, side))
    yield from found


def _new(found: Sequence[Difference], more: Iterator[Difference]) -> list[Difference]:
    """What is not told from the other side already."""
    told = {(each.what, each.quantity, each.a, each.b) for each in found}
    return [each for each in more if (each.what, each.quantity, each.a, each.b) not in told]


def _goes_on(end: Stored, others: Sequence[Curve]) -> bool:
    """Whether the other database passes an end: the branch is cut there into other pieces."""
    for curve in others:
        foot = curve.foot(end.curve.values[end.point.index])
        inside = 0.0 < foot.t < (curve.t[-1] if len(curve) else 0.0)
        if foot.on and inside:
            return True
    return False


def _unpaired(each: Stored, side: str) -> Difference:
    other = "B" if side == "A" else "A"
    names = (each.name, "") if side == "A" else ("", each.name)
    if each.point.label == END_POINT:
        return Difference(END, f"{side} ends at {each.told()}; {other} does not end there.", *names)
    text = f"Only {side} has {each.told()}; {other} has no such point near."
    free = each.curve.branch.info.free[0]
    values = (each.value(free), None) if side == "A" else (None, each.value(free))
    return Difference(POINT, text, *names, free, *values)


def _outcomes(family: Family) -> Iterator[Difference]:
    """Why the branches ended; in pieces there are other reasons, and the ends have been compared."""
    if len(family.a) != 1 or len(family.b) != 1 or CURVE != family.by != IMAGE:
        return
    a, b = family.a[0], family.b[0]
    one, other = a.outcome, b.outcome
    if (one.status, one.reason) != (other.status, other.reason):
        text = f"{a.name} of A is {one.status} ({one.reason}), {b.name} of B {other.status} ({other.reason})."
        yield Difference(END, text, a.name, b.name)
