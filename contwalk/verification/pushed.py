"""What `contwalk margins` has stored, by pushing once more: borders of survival, and what motions come to."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from contwalk.errors import ContwalkError
from contwalk.system.falling import FALLEN
from contwalk.verification import budget
from contwalk.verification.finding import AGREES, DISAGREES, SLACK, CannotTell, Finding
from contwalk.verification.passage import TIGHT
from contwalk.verification.pushing import ACCUMULATED, ENDED, SURVIVED, Pushing, Rule, Twice

# What decides these is not followed here as it is there: where a motion cannot go on, or where it crowds.
OWN = (ENDED, ACCUMULATED)
METHOD = "SciPy DOP853"


def checked_rays(
    both: Mapping[int, Twice], rows: Sequence[Mapping[str, Any]], rule: Rule
) -> Iterator[Finding]:
    """The borders of survival along rays, as they are stored."""
    for row in rows:
        name = f"{row['instant']}/{row['state']}{'+' if row['sign'] > 0 else '-'}"
        border = np.nan if row["border"] is None else float(row["border"])
        begun = Finding("margins", name, "border", stored=border, method=METHOD)
        begun = replace(begun, stored_error=rule.accuracy * border)
        try:
            budget.ask()
            verdict, reason = _ray(both[int(row["instant"])], row, rule)
            yield replace(begun, verdict=verdict, reason=reason)
        except (budget.UsedUp, CannotTell) as why:
            yield replace(begun, reason=why.sentence)
        except (ArithmeticError, ValueError, ContwalkError) as error:
            yield replace(begun, reason=f"the second computation broke down: {error}")


def _ray(twice: Twice, row: Mapping[str, Any], rule: Rule) -> tuple[str, str]:
    """A verdict and its reason on one ray."""
    if "vector" not in row:
        raise CannotTell("an older file does not tell what was pushed")
    along = float(row["sign"]) * np.array(row["vector"], dtype=float)

    def ends(size: float) -> str:
        return twice.told(size * along, Pushing.verdict)

    if row["border"] is None:
        return _none(twice, row, along, ends)
    # The state itself is known to some of its roundings only.
    of = np.flatnonzero(along)
    rounded = TIGHT * float((twice.fine.magnitudes[of] / np.abs(along[of])).max())
    for border in row["borders"]:
        codes = list[str]()
        for times in (1.0, SLACK):
            off = times * rule.accuracy * border + rounded
            inner, outer = ends(max(border - off, 0.0)), ends(border + off)
            codes += [inner, outer]
            if (inner == SURVIVED) != (outer == SURVIVED):
                break
        else:
            if not {*codes} & {*OWN} and row["ends"] not in OWN:
                what = f"both sides of {border:.6g} are alike: {codes[0]}"
                return DISAGREES, what
            raise CannotTell(f"where motions end as {' or '.join(OWN)} is told in another way here")
        first = border == row["border"]
        if first and inner != SURVIVED:
            return DISAGREES, f"what is pushed less than {border:.6g} is {inner}"
        if first and row["ends"] not in codes:
            if {*codes, row["ends"]} & {*OWN}:
                raise CannotTell(f"beyond the border a motion is {outer}; {row['ends']} is stored")
            return DISAGREES, f"beyond the border a motion is {outer}, not {row['ends']}"
    if row["border"] not in row["borders"]:
        return DISAGREES, "its border is none of those that were met"
    return AGREES, ""


def _none(
    twice: Twice, row: Mapping[str, Any], along: np.ndarray, ends: Callable[[float], str]
) -> tuple[str, str]:
    """Of a ray on which no border was met: what is pushed farthest survives."""
    if row["ends"] != SURVIVED:
        return DISAGREES, f"no border is stored, and motions end as {row['ends']}"
    if not np.isfinite(row["farthest"]):
        raise CannotTell("an older file does not tell how far was looked")
    code = ends(float(row["farthest"]))
    return (AGREES, "") if code == SURVIVED else (DISAGREES, f"what is pushed farthest is {code}")


def checked_basin(
    twice: Twice, basin: Mapping[str, Any], own: str, others: Mapping[str, Twice]
) -> Iterator[Finding]:
    """What motions of a plane come to.

    Parameters
    ----------
    own : str
        The name of the solution that is pushed.
    others : mapping
        Further stored solutions by their names; another name is told by the first motion that has it.
    """
    labels, places = basin["labels"], np.array(basin["places"], dtype=float)
    names = list(twice.fine.functions.system.state_names)
    pushes, state = np.zeros((len(places), len(names))), np.array(twice.fine.instant["state"], dtype=float)
    columns = [names.index(name) for name in basin["states"]]
    pushes[:, columns] = places - state[columns]
    new = dict[str, np.ndarray]()
    for place in sampled(len(places)):
        begun = Finding("basin", str(place), "what it comes to", method=METHOD)
        try:
            budget.ask()
            comes = _Comes(own, others, new, str(labels[place]))
            told = twice.told(pushes[place], comes)
            if told == labels[place]:
                yield replace(begun, verdict=AGREES, stored=0.0, recomputed=0.0, difference=0.0)
            elif labels[place] in twice.beside(pushes[place], comes):
                raise CannotTell(f"it comes to {told}, and to {labels[place]} within the run's tolerance")
            elif told in OWN or labels[place] in OWN or labels[place] == "unknown":
                raise CannotTell(f"it comes to {told}, and {labels[place]} is stored")
            else:
                yield replace(begun, verdict=DISAGREES, reason=f"it comes to {told}, not {labels[place]}")
        except budget.UsedUp:
            return
        except CannotTell as why:
            yield replace(begun, reason=why.sentence)
        except (ArithmeticError, ValueError, ContwalkError) as error:
            yield replace(begun, reason=f"the second computation broke down: {error}")


def sampled(count: int, every: int = 10) -> list[int]:
    """Every tenth of so many places from the middle of ten on, spread ever more finely."""
    chosen = list(range(every // 2 if count > every // 2 else 0, count, every))
    return [chosen[k] for k in sorted(range(len(chosen)), key=lambda k: int(f"{k:032b}"[::-1], 2))]


@dataclass(frozen=True)
class _Comes:
    """What a pushed motion comes to: a name, or the code of how it ends.

    Parameters
    ----------
    own, stored : str
        Names of the solution that is pushed, and of what is stored of the motion.
    others, new : mapping
        Stored solutions, and courses, (k, N), of what is none of these, each told by a first motion to it.
    """

    own: str
    others: Mapping[str, Twice]
    new: dict[str, Any]
    stored: str

    def __call__(self, pushing: Pushing, push: np.ndarray) -> str:
        code, course = pushing.followed(push)
        if code != SURVIVED or course is None:
            return code
        if known := self._near(pushing, pushing.motion.full(course.at)):
            return known
        lasts, most = pushing.rule.duration, pushing.rule.most
        longer = pushing.motion.followed(course.at, pushing.rule.settling * lasts, most, 0.0)
        if longer.ended:
            return FALLEN
        if known := self._near(pushing, pushing.motion.full(longer.at)):
            return known
        if self.stored.rstrip("0123456789") not in ("new", "unstable"):
            return "another solution"
        round_ = pushing.motion.followed(longer.at, lasts, most, 0.0)
        self.new[self.stored] = np.array(round_.states)
        return self.stored

    def _near(self, pushing: Pushing, state: np.ndarray) -> str:
        """The name of the solution that a state is near to, or nothing."""
        apart = {self.own: pushing.distance(state)}
        apart |= {name: pushing.distance(state, other.fine.course) for name, other in self.others.items()}
        apart |= {name: pushing.distance(state, course) for name, course in self.new.items()}
        name = min(apart, key=apart.__getitem__)
        return name if apart[name] <= pushing.rule.near else ""
