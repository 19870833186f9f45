"""A computed diagram against what is known of it: found, missed, extra, covered by the claimed errors."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

import numpy as np
from peers.form import Ending, Study, Value

from contwalk.branch import Branch, SpecialPoint

# Labels of points that must all be known. UZ and EP are what a run file asks for and where branches end.
COMPARED = ("LP", "BP", "HB", "PD", "NS", "GR", "OC", "AZ")
# The limit of the parameter that a message tells, with its error.
LIMIT = re.compile(r"= (\S+) \+- (\S+?)[,:]? ")
# A found point this near to a value, relative to it, is meant to be it. Whether it is near enough is for its
# claimed error to say.
NEAR = 1e-3


@dataclass(frozen=True)
class Met:
    """A found point that is a known value: where it is, and its claimed error."""

    value: Value
    there: float
    error: float | None

    @property
    def off(self) -> float:
        """How far it is from the known value."""
        return abs(self.there - self.value.value)

    @property
    def covered(self) -> bool:
        """Whether that is below the claimed error, plus the doubt of the known value."""
        return self.error is not None and self.off <= self.error + self.value.doubt


@dataclass
class Verdict:
    """What a diagram has of what is known."""

    found: int = 0
    met: list[Met] = field(default_factory=list)
    missed: list[str] = field(default_factory=list)
    extra: list[str] = field(default_factory=list)
    uncovered: list[str] = field(default_factory=list)
    otherwise: list[str] = field(default_factory=list)  # wrong kinds and criticalities, ends that are missing
    worst: float = 0.0  # relative difference from a known value

    @property
    def complaints(self) -> list[str]:
        """Everything that is not as it should be, a sentence each."""
        return [*self.missed, *self.extra, *self.uncovered, *self.otherwise]


def judge(study: Study, branches: list[Branch]) -> Verdict:
    """Compare the branches of a study's diagram with what is known of it."""
    verdict = Verdict()
    known = (*study.values, *study.real)
    marks = any(value.label == "UZ" for value in study.values)
    findings: dict[Value, list[tuple[Branch, SpecialPoint]]] = {value: [] for value in known}
    for branch in branches:
        for point in branch.special_points:
            if point.label not in COMPARED and not (marks and point.label == "UZ"):
                continue
            value = _meant(branch, point, known)
            if value in study.real and point.status != "located":
                continue  # it need not be found, and is not claimed to be
            if value is None or point.status != "located":
                verdict.extra.append(f"extra: {_told(branch, point)}")
            else:
                findings[value].append((branch, point))
    for value in known:
        _judge_value(value, findings[value], verdict, required=value in study.values)
    _judge_ends(study, branches, verdict)
    return verdict


def _kind_of(branch: Branch) -> str:
    return "equilibrium" if branch.info.problem == "equilibrium" else "orbit"


def _meant(branch: Branch, point: SpecialPoint, known: tuple[Value, ...]) -> Value | None:
    """The known value that a found point is, if any."""
    of = _kind_of(branch)
    there = point.parameters[branch.info.free[0]]
    like = [value for value in known if value.label == point.label and value.of == of]
    near = [value for value in like if abs(there - value.value) <= NEAR * value.size]
    return min(near, key=lambda value: abs(there - value.value), default=None)


def _judge_value(
    value: Value, findings: list[tuple[Branch, SpecialPoint]], verdict: Verdict, required: bool
) -> None:
    places = {branch.name: 0 for branch, _ in findings}
    for branch, point in findings:
        places[branch.name] += 1
        _judge_point(value, branch, point, verdict)
        if places[branch.name] > value.times:
            verdict.extra.append(f"extra: {_told(branch, point)} is found once too often on its branch")
    if required:
        verdict.found += min(len(findings), value.times)
        for _ in range(value.times - len(findings)):
            verdict.missed.append(f"missed: {value.label} of {value.of} at {value.value!r} ({value.source})")


def _judge_point(value: Value, branch: Branch, point: SpecialPoint, verdict: Verdict) -> None:
    """Error, criticality and kind of one found point."""
    met = Met(value, point.parameters[branch.info.free[0]], point.error)
    verdict.met.append(met)
    verdict.worst = max(verdict.worst, met.off / value.size)
    if not met.covered:
        verdict.uncovered.append(
            f"not covered: {_told(branch, point)}, error {point.error!r}, is {met.off:.3g} off "
            f"{value.value!r}, known to {value.doubt:.1g}"
        )
    if value.period is not None and not _near(point.period_full or point.period, value.period):
        verdict.otherwise.append(
            f"period: {_told(branch, point)} is told {point.period_full or point.period}"
        )
    for name in ("criticality", "kind"):
        said, known = getattr(point, name), getattr(value, name)
        if known is not None and said != known:
            verdict.otherwise.append(f"{name}: {_told(branch, point)} is told {said}, and is {known}")


def _near(found: float | None, known: float) -> bool:
    """Whether a period is the known one, and no multiple of it."""
    return found is not None and abs(found - known) <= NEAR * known


def _judge_ends(study: Study, branches: list[Branch], verdict: Verdict) -> None:
    for branch in branches:
        cut_short = branch.outcome.reason == "max_points" and "max_points" not in study.run["continue"]
        if branch.outcome.status == "failed" or cut_short:
            verdict.otherwise.append(f"not followed to its end: {branch.name}: {branch.outcome.message}")
    for ending in study.endings:
        like = [branch for branch in branches if _kind_of(branch) == ending.of]
        ends = [branch for branch in like if branch.outcome.reason == ending.reason]
        if not any(_ends_there(ending, branch) for branch in ends):
            at = "" if ending.value is None else f" at {ending.value!r}"
            told = "; ".join(branch.outcome.message for branch in ends)
            verdict.otherwise.append(
                f"end: no branch of {ending.of} ends as {ending.reason}{at} ({ending.source}). {told}"
            )


def _ends_there(ending: Ending, branch: Branch) -> bool:
    """Whether the told limit covers the known one; where none is told, whether the last point is near it."""
    if ending.value is None:
        return True
    limits = LIMIT.findall(branch.outcome.message)
    if limits:
        return any(abs(float(v) - ending.value) <= float(e) + ending.error for v, e in limits)
    rows = branch[branch.info.free[0]][[0, -1]]
    return bool(np.any(np.abs(rows - ending.value) <= ending.error))


def _told(branch: Branch, point: SpecialPoint) -> str:
    """A found point in words."""
    free = branch.info.free[0]
    where = f"{branch.name}/{point.name} ({point.status}) at {free} = {point.parameters[free]!r}"
    return where if point.note is None else f"{where} [{point.note}]"
