"""What is told of an orbit with events beside what is told of any other, and what words of a point are."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from contwalk.number_words import exact
from contwalk.signatures import folded, is_iterated

if TYPE_CHECKING:
    from contwalk.branch import Branch, SpecialPoint
    from contwalk.system import System
    from contwalk.workflow.stored.hybrid_facts import HybridFacts, MarginFact


@dataclass(frozen=True)
class TableOfWords:
    """A header, which may be empty texts, rows of as many cells, and a sentence that stands below."""

    header: list[str]
    rows: list[list[str]]
    remark: str = ""


@dataclass(frozen=True)
class PointWords:
    """A title, facts in a line each, and tables."""

    title: str
    facts: list[str]
    tables: list[TableOfWords]


def admissible_line(admissible: bool, branch: Branch, facts: HybridFacts | None) -> list[str]:
    """Whether the machine can move so, and what is against it; of what has no events only if it cannot."""
    if branch.info.problem_by_name != "hybrid_orbit":
        return [] if admissible else ["not admissible"]
    if admissible:
        return ["admissible"]
    violated = facts.violated if facts is not None else []
    return ["not admissible" + (f": {', '.join(violated)} below zero" if violated else "")]


def meaning_line(
    branch: Branch, point: SpecialPoint, facts: HybridFacts | None, system: System | None
) -> list[str]:
    """What happens at a limit, and on which side of it the machine can move so."""
    own = None if facts is None else facts.nearest(point.label)
    text = _meaning(point, own, system)
    if not text:
        return []
    rows = branch.points
    regular = [row for row in (point.index - 1, point.index + 1) if 0 <= row < len(rows)]
    flags = [bool(rows["admissible"][row]) for row in regular]
    if len(flags) == 2 and flags[0] != flags[1]:
        sides = "before it, not after it" if flags[0] else "after it, not before it"
        text += f" The branch is admissible {sides}, in the order of its points."
    return [f"meaning: {text}"]


def _meaning(point: SpecialPoint, own: MarginFact | None, system: System | None) -> str:
    """A limit in a sentence."""
    name = f"'{own.name}'" if own is not None else "a guard"
    if point.label == "GR" and point.kind == "terminal":
        guard = "the guard that ends a segment" + (f", {name}," if own is not None else "")
        return (
            f"{guard} is touched before its end, or arrives there without speed; where it passes zero there, "
            "the segment ends earlier."
        )
    if point.label == "GR":
        about = _about(system, own.name if own is not None else "")
        acts = system is None or own is None or own.name not in system.margins
        beyond = "the event happens, and the signature changes" if acts else "the machine cannot move so"
        return f"{name}{about} is touched between two events and not passed; where it is passed, {beyond}."
    if point.label == "OC":
        return "two events happen at once; beyond this point their order would be another one."
    if point.label == "AZ":
        about = _about(system, str(point.kind))
        return f"'{point.kind}'{about} is zero; where it is negative, the machine cannot move so."
    return ""


def _about(system: System | None, name: str) -> str:
    if system is None:
        return ""
    declared: list[Any] = [*system.conditions, *system.transitions]
    about = next((each.about for each in declared if each.name == name), "")
    return f" ({about})" if about else ""


def segment_tables(facts: HybridFacts | None, time: str) -> list[TableOfWords]:
    """The segments of the closure with their modes and durations; none where they are not known."""
    if facts is None:
        return []
    rows = [
        [str(number), segment.mode, exact(segment.duration), time, segment.event or "the period ends"]
        for number, segment in enumerate(facts.segments, start=1)
    ]
    return [TableOfWords(["segment", "mode", "duration", "unit" if time else "", "ended by"], rows)]


def margin_table(facts: HybridFacts) -> TableOfWords:
    """What must be positive, the least first."""
    from contwalk.workflow.stored.hybrid_facts import BELOW, ZERO

    rows = []
    for margin in facts.margins:
        zero, below = abs(margin.share) < ZERO, margin.share < BELOW
        remark = ": zero here" if zero else ": BELOW ZERO" if below else ""
        share = "0 %" if zero else f"{100.0 * margin.share:.3g} %"
        rows.append([margin.name, exact(margin.value + 0.0), margin.unit, share, margin.what + remark])
    return TableOfWords(["margin, least first", "value", "unit", "of its largest", "of what"], rows)


def signature_line(branch: Branch) -> list[str]:
    """The events of the closure in their order."""
    events = branch.info.signature
    return [f"signature: {folded(events)}"] if events and not is_iterated(events) else []
