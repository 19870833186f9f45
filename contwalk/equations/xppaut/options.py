"""What the options of an .ode file mean for a study: the range of AUTO, how long it simulates, named sets."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, field

from contwalk.equations.model import Model

_PAIR = re.compile(r"([^\W\d]\w*)\s*=\s*([^\s,]+)")


_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
_ASSIGNED = re.compile(rf"([^\W\d]\w*)\s*(?:=\s*({_NUMBER}))?(?=[\s,]|$)")

_GAP = re.compile(r"[\s,]*")


@dataclass
class Options:
    """Options by their names in lower case, and sets of parameters by their names."""

    values: dict[str, str] = field(default_factory=dict)
    sets: dict[str, dict[str, float]] = field(default_factory=dict)

    def read(self, text: str) -> None:
        """A line of options."""
        self.values |= {name.lower(): value for name, value in _PAIR.findall(text)}

    def into(self, model: Model) -> None:
        """What has a meaning, into the model: the rest is about windows, pictures and the integrator."""
        known = set(model.parameters)
        for name, values in self.sets.items():
            kept = {parameter: value for parameter, value in values.items() if parameter in known}
            if kept:
                model.presets[name] = kept
        numbers = {name: number_of(text) for name, text in self.values.items()}
        low, high = numbers.get("parmin"), numbers.get("parmax")
        if low is not None and high is not None and low < high and model.parameters:
            model.study = (next(iter(model.parameters)), (low, high))
        total = numbers.get("total")
        if total is not None and total > 0.0:
            model.until = total


def number_of(text: str) -> float | None:
    """The finite number that a text is, if it is one."""
    try:
        found = float(text)
    except ValueError:
        return None
    return found if abs(found) < 1e300 else None


def assignments(text: str, wrong: Callable[[str, str], Exception]) -> list[tuple[str, float]]:
    """`a=1, b=-2  c` as names with numbers, zero where none is given.

    Raises
    ------
    Exception
        What `wrong(sentence, remedy)` gives, for what is no number.
    """
    found = []
    at = 0
    while (begin := _GAP.match(text, at)) is not None and begin.end() < len(text):
        match = _ASSIGNED.match(text, begin.end())
        if match is None:
            what = text[begin.end() : begin.end() + 40].split(",")[0]
            raise wrong(f"'{what}' is not a name with a number.", "As in par a=1, b=-2.5")
        value = float(match.group(2) or 0.0)
        if abs(value) > 1e300:
            raise wrong(f"{match.group(1)} is larger than floats are.", "Give another number.")
        found.append((match.group(1), value))
        at = match.end()
    return found
