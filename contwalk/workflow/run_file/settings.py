"""What a run does along its branches: the range, marked values, where orbits are reported, figures."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from contwalk import quantities
from contwalk.system.declarations import System
from contwalk.workflow.run_file.document import Key
from contwalk.workflow.run_file.parameters import check_bounds, parameter_named
from contwalk.workflow.run_file.problems import Problems, allowed
from contwalk.workflow.run_file.starts import StartSpec

if TYPE_CHECKING:
    from contwalk.workflow.run_file.model import ReportPlace, RunModel

# Larger numbers, or ends that are nearer to each other than one over it, have no square in double precision
# with room for what is computed from it.
LARGEST = 1e100
PATH = "path"  # the name of the free parameter of a parameter path
# Largest real part of an equilibrium, largest modulus of an orbit's multipliers, and what its closure lasts.
BUILT_IN = ("max_re", "max_abs", quantities.PERIOD)
DIRECTIONS = {
    "both": "both",
    "forward": "forward",
    "up": "forward",
    "backward": "backward",
    "down": "backward",
}


@dataclass(frozen=True)
class Mark:
    """Values of a parameter or observable to be marked (UZ), and whether its extrema are."""

    name: str
    values: tuple[float, ...]
    extremum: bool = False


@dataclass(frozen=True)
class Loci:
    """Curves in two parameters: the second and its range, the points they are of, those followed."""

    second: str
    range: tuple[float, float]
    of: frozenset[str]
    follow: frozenset[str]


@dataclass(frozen=True)
class ReportAt:
    """Where the state of an orbit is reported: at an event, or where a state passes a value."""

    event: str | None = None
    side: str | None = None
    section: tuple[str, float] | None = None
    direction: str | None = None


@dataclass(frozen=True)
class Measured:
    """Names that have a value changing along a branch."""

    problems: Problems
    system: System
    free: str
    varying: tuple[str, ...]

    def check(self, key: Key, name: str) -> None:
        """Note a problem at `key` unless `name` changes along the branch."""
        observables = self.system.observable_names
        known = tuple(dict.fromkeys((self.free, *self.varying, *observables, *BUILT_IN)))
        if name in (*known, *quantities.every_extreme(self.system.state_names)):
            return
        if name in self.system.parameter_names:
            sentence = f"'{name}' is a parameter that does not change along the branch."
        elif name in self.system.state_names:
            sentence = f"'{name}' is a state, not an observable."
            problem = f"Of orbits, its extremes may be: max:{name}, min:{name}, amp:{name}. {allowed(known)}"
            self.problems.add(key, sentence, problem)
            return
        else:
            sentence = f"'{name}' is neither the free parameter nor an observable of '{self.system.name}'."
            self.problems.add(key, sentence, allowed(known, name))
            return
        self.problems.add(key, sentence, allowed(known))


def free_parameter(problems: Problems, system: System, model: RunModel) -> str | None:
    """The name of the free parameter, `path` on a parameter path."""
    name, two = model.continue_.parameter, model.continue_.parameters
    if two is not None:
        return _first_of_two(problems, system, model, two)
    if model.path is not None:
        if name is not None:
            problems.add(
                ("continue", "parameter"), f"both '{name}' and a path are given.", "Remove one of the two."
            )
        return PATH
    if name is None:
        problems.add(
            ("continue", "parameter"),
            "nothing is continued.",
            f"Give a parameter here, or a path. {allowed(system.parameter_names)}",
        )
        return None
    return name if parameter_named(problems, ("continue", "parameter"), system, name) else None


def _first_of_two(problems: Problems, system: System, model: RunModel, two: tuple[str, ...]) -> str | None:
    """The first of two free parameters, both checked."""
    key: Key = ("continue", "parameters")
    other = "parameter" if model.continue_.parameter is not None else "path" if model.path is not None else ""
    if other:
        problems.add(key, f"both two parameters and a {other} are given.", "Remove one of the two.")
    if len(two) != 2 or two[0] == two[1]:
        what = "names the same parameter twice." if len(two) == 2 else f"has {len(two)} names."
        problems.add(key, what, "Allowed: [first, second], two parameters of the system.")
        return None
    known = [parameter_named(problems, (*key, index), system, name) for index, name in enumerate(two)]
    if any(start.from_ is None for start in model.start):
        problems.add(
            ("start",),
            "a curve in two parameters starts at a special point of a database.",
            "Give {from: other.h5, point: b1/HB1}.",
        )
    for name in ("loci", "sweep"):
        if getattr(model, name) is not None:
            problems.add((name,), "belongs to a study along one parameter.", "Remove it.")
    return two[0] if all(known) else None


def second_range(
    problems: Problems, system: System, model: RunModel, free: str | None
) -> tuple[str, tuple[float, float]] | None:
    """The second of two free parameters, with its range."""
    two = model.continue_.parameters
    if free is None or two is None:
        return None
    return two[1], _ends(problems, system, two[1], ("continue", "range", two[1]), _range_of(model, two[1]))


def loci(problems: Problems, system: System, model: RunModel, free: str | None) -> Loci | None:
    """Curves in two parameters from all special points of a study."""
    given = model.loci
    if given is None or free is None:
        return None
    if parameter_named(problems, ("loci", "with"), system, given.with_):
        if given.with_ == free:
            problems.add(("loci", "with"), f"'{free}' is continued already.", "Name another parameter.")
        elif model.path is not None:
            problems.add(
                ("loci",), "curves in two parameters do not go along a path.", "Remove one of the two."
            )
        ends = _ends(problems, system, given.with_, ("loci", "range"), given.range)
        return Loci(given.with_, ends, frozenset(given.of), frozenset(given.follow))
    return None


def _range_of(model: RunModel, name: str | None) -> tuple[float, ...] | None:
    """What the file gives as the range of a parameter."""
    ends = model.continue_.range
    return ends.get(name or "") if isinstance(ends, dict) else ends


def _ends(
    problems: Problems, system: System, name: str, key: Key, ends: tuple[float, ...] | None
) -> tuple[float, float]:
    """A range of a parameter, lower end first, within its bounds."""
    if ends is None or len(ends) != 2:
        sentence = "the key is missing." if ends is None else f"has {len(ends)} numbers."
        problems.add(key, sentence, "Allowed: two numbers, [lowest, highest].")
        return 0.0, 0.0
    low, high = ends
    if not low < high:
        shown = f"[{low:.12g}, {high:.12g}]"
        problems.add(key, f"is empty or the wrong way round: {shown}.", "Allowed: [lowest, highest].")
    _check_size(problems, key, low, high)
    for parameter in system.parameters:
        if parameter.name == name:
            for value in ends:
                check_bounds(problems, key, parameter, value)
    return low, high


def _check_size(problems: Problems, key: Key, low: float, high: float) -> None:
    """Refuse ranges of which squares, as the metric of a branch has them, are not finite or vanish."""
    if max(abs(low), abs(high)) > LARGEST or 0.0 < high - low < 1.0 / LARGEST:
        problems.add(
            key,
            f"is [{low:.12g}, {high:.12g}], of a size whose square double precision cannot hold.",
            f"Allowed: numbers up to {LARGEST:g} that are {1.0 / LARGEST:g} apart or more. Measure the "
            "parameter in another unit.",
        )


def continued_range(
    problems: Problems, system: System, model: RunModel, free: str | None
) -> tuple[float, float]:
    """The range of the free parameter, lower end first."""
    key: Key = ("continue", "range")
    two, on_path = model.continue_.parameters, model.path is not None
    if two is not None:
        if not isinstance(model.continue_.range, dict):
            name = two[1] if len(two) > 1 else "second"
            problems.add(
                key,
                "gives no range for each of two parameters.",
                f"Allowed: {{{two[0] if two else 'first'}: [lowest, highest], {name}: [lowest, highest]}}.",
            )
            return 0.0, 0.0
        for name in model.continue_.range:
            if name not in two:
                problems.add((*key, name), f"'{name}' is not free.", allowed(two, name))
        return (
            (0.0, 0.0)
            if free is None
            else _ends(problems, system, free, (*key, free), _range_of(model, free))
        )
    if isinstance(model.continue_.range, dict):
        problems.add(
            key, "gives ranges by name.", "Allowed: two numbers, [lowest, highest], of one parameter."
        )
        return 0.0, 0.0
    ends = model.continue_.range
    if ends is None and on_path:
        return 0.0, 1.0
    if ends is None or len(ends) != 2:
        sentence = "the key is missing." if ends is None else f"has {len(ends)} numbers."
        problems.add(key, sentence, "Allowed: two numbers, [lowest, highest].")
        return 0.0, 0.0
    low, high = ends
    if not low < high:
        what = "is empty: both ends are" if low == high else "is the wrong way round:"
        values = f"{low:.12g}" if low == high else f"[{low:.12g}, {high:.12g}]"
        problems.add(
            key,
            f"{what} {values}.",
            "Allowed: [lowest, highest]; the direction is said with direction: forward or backward.",
        )
    _check_size(problems, key, low, high)
    if on_path and (min(ends) < 0.0 or max(ends) > 1.0):
        problems.add(key, f"[{low:.12g}, {high:.12g}] leaves the path.", "Allowed: within [0, 1].")
    for parameter in system.parameters:
        if parameter.name == free and not on_path:
            for value in ends:
                check_bounds(problems, key, parameter, value)
    return low, high


def check_starts_in_range(
    problems: Problems,
    starts: tuple[StartSpec, ...],
    free: str,
    ends: tuple[float, float],
    key: Key = ("continue", "range"),
) -> None:
    """Note a problem for a start outside the range; that of a stored point is not known here."""
    low, high = ends
    for start in starts:
        value = start.parameters.get(free, math.nan)
        known = start.kind != "from" and not math.isnan(value)
        if known and low < high and not low <= value <= high:
            problems.add(
                key,
                f"the start has {free} = {value:.12g}, outside the range [{low:.12g}, {high:.12g}].",
                f"Widen the range, or set {free} under parameters to a value inside it.",
            )


def marks(problems: Problems, measured: Measured | None, model: RunModel) -> tuple[Mark, ...]:
    """The marked values in the order of the file."""
    result = []
    for name, written in model.mark.items():
        if measured is not None:
            measured.check(("mark", name), name)
        if not written:
            problems.add(("mark", name), "lists no value.", "Allowed: numbers, or the word extremum.")
        values = tuple(dict.fromkeys(value for value in written if isinstance(value, float)))
        result.append(Mark(name, values, "extremum" in written))
    return tuple(result)


def stops(problems: Problems, measured: Measured | None, model: RunModel) -> dict[str, tuple[float, ...]]:
    """Values at which a branch ends, by the name of what has them."""
    for name, values in model.continue_.stop_at.items():
        key = ("continue", "stop_at", name)
        if measured is not None:
            measured.check(key, name)
        if not values:
            problems.add(key, "lists no value.", "Allowed: a number or a list of numbers.")
    return dict(model.continue_.stop_at)


def report_place(problems: Problems, system: System, place: ReportPlace | None) -> ReportAt | None:
    """Where orbits are reported, its names checked."""
    if place is None:
        return None
    if place.event is not None:
        _check_event(problems, system, place.event)
        return ReportAt(event=place.event, side=place.side or "before")
    ((name, value),) = (place.section or {}).items()
    if name not in system.state_names:
        problems.add(
            ("report_at", "section", name),
            f"'{name}' is not a state of '{system.name}'.",
            allowed(system.state_names, name),
        )
    return ReportAt(section=(name, value), direction=place.direction)


def _check_event(problems: Problems, system: System, event: str) -> None:
    """Orbits have states at events that act, and there only."""
    acting = tuple(dict.fromkeys(transition.name for transition in system.acting))
    if event in acting:
        return
    sentence, remedy = f"'{event}' is not an event of '{system.name}'.", allowed(acting, event)
    if any(transition.name == event for transition in system.transitions):
        sentence = f"'{event}' is only watched, and no orbit has a state there."
        section = f"{{section: {{{system.state_names[0]}: 0.0}}}}"
        remedy = f"{allowed(acting)} Or give a value that a state passes there, as in {section}."
    problems.add(("report_at", "event"), sentence, remedy)
