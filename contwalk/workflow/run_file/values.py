"""Values in a run file: what is accepted, and the sentence where it is not."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from contwalk.labels import END, MARK, MEANINGS
from contwalk.workflow.run_file.faults import wrong
from contwalk.workflow.run_file.forms import as_tuple, list_of, mapping_of, one_of, text
from contwalk.workflow.run_file.yaml_lines import shown

FOLLOWED = tuple(label for label in MEANINGS if label not in (END, MARK))
# Special points of equilibria that curves are of, and those on curves at which other curves begin.
CURVES = ("LP", "HB")
BORN = ("BT", "ZH", "HH")
DIAGRAM_FIGURES = (
    "bifurcation_diagram",
    "eigenvalues",
    "multipliers",
    "stability_map",
    "locus",
    "machine",
    "phase_portrait",
    "stick_figure",
)
MOTION_FIGURES = ("time_series", "phase_portrait")
SAMPLE_FIGURES = ("histogram",)
# each command draws its own
FIGURES = tuple(dict.fromkeys((*DIAGRAM_FIGURES, *MOTION_FIGURES, *SAMPLE_FIGURES)))
LOWEST_ACCURACY = 1e-14  # below it, rounding in double precision decides, not the method


def number(value: Any) -> float:
    """A finite number; true and false are none."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise wrong(f"is {shown(value)}, which is not a number.", "Allowed: a number, such as 0.5 or 1e-8.")
    try:
        result = float(value)
    except OverflowError:
        result = math.inf
    if not math.isfinite(result):
        raise wrong(f"is {shown(value)}, which is not finite.", "Allowed: a finite number.")
    return result


def _within(low: float, high: float, words: str) -> Callable[[Any], float]:
    def check(value: Any) -> float:
        result = number(value)
        if not low < result <= high:
            raise wrong(f"is {shown(result)}.", f"Allowed: {words}.")
        return result

    return check


def as_accuracy(value: Any) -> float:
    """A number that points can be right to."""
    result = _within(0.0, 0.5, f"a number from {LOWEST_ACCURACY:g} to 0.5")(value)
    if result < LOWEST_ACCURACY:
        raise wrong(
            f"is {shown(result)}, finer than double precision can give.",
            f"Allowed: a number from {LOWEST_ACCURACY:g} to 0.5; 1e-10 is already fine.",
        )
    return result


def as_tolerance(value: Any) -> float:
    """A local error."""
    result = _within(0.0, 1e-2, "a number from 1e-14 to 0.01")(value)
    if result < LOWEST_ACCURACY:
        raise wrong(f"is {shown(result)}, finer than double precision can give.", "Allowed: 1e-14 to 0.01.")
    return result


def file_name(value: Any) -> str:
    """The name of a file."""
    if not isinstance(value, str):
        raise wrong(f"is {shown(value)}, which is not a text.")
    if not value.strip() or "\0" in value:
        raise wrong("is empty." if not value.strip() else "holds a null character.")
    return value


def until_when(value: Any) -> float | str:
    """How long to simulate."""
    if value == "settled":
        return "settled"
    if isinstance(value, str):
        raise wrong(f"is {shown(value)}.", "Allowed: settled, or a positive number of seconds.")
    return _within(0.0, math.inf, "settled, or a positive number of seconds")(value)


def start_until(value: Any) -> float | str:
    """How long to simulate before a start; 0 takes the state as it is."""
    return 0.0 if value == 0 and not isinstance(value, bool) else until_when(value)


def mark_value(value: Any) -> float | str:
    """What is marked of a quantity."""
    if value == "extremum":
        return "extremum"
    if isinstance(value, str):
        raise wrong(f"is {shown(value)}.", "Allowed: a number, or the word extremum.")
    return number(value)


def as_list(value: Any) -> Any:
    """A list as a tuple; anything else as it is."""
    return tuple(value) if isinstance(value, list) else value


def as_curves(value: Any) -> Any:
    """`all` as the labels it stands for."""
    return CURVES if value == "all" else as_tuple(value)


def as_born(value: Any) -> Any:
    """`all` and `none` as the labels they stand for."""
    if value == "all":
        return BORN
    return () if value == "none" else as_tuple(value)


def as_starts(value: Any) -> Any:
    """One start as a list of one; there must be one."""
    if value == []:
        raise wrong("is an empty list.")
    return as_tuple(value)


def as_figure(value: Any) -> Any:
    """The name of a figure as a figure without options."""
    return {value: {}} if isinstance(value, str) else value


def as_diagram(value: Any) -> Any:
    """`all`, `none` or a list as what is to be followed."""
    return {"follow": value} if isinstance(value, str | list) else value


def as_labels(value: Any) -> Any:
    """`all` and `none` as the labels they stand for."""
    if value == "all":
        return FOLLOWED
    return () if value == "none" else as_tuple(value)


positive = _within(0.0, math.inf, "a positive number")
angle = _within(0.0, 90.0, "degrees above 0, up to 90")
numbers = list_of(number)
values = mapping_of(number)
_texts = list_of(text)
ACTIONS = "stop, ignore or switch"
ACTION = one_of("stop", "ignore", "switch")


def text_or_values(value: Any) -> str | dict[str, float]:
    """The name of a preset, or the values themselves."""
    return value if isinstance(value, str) else values(value)


def text_or_texts(value: Any) -> str | tuple[str, ...]:
    """A name, or a list of them."""
    return _texts(value) if isinstance(value, list) else text(value)
