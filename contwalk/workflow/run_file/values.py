"""Types of the values in a run file: what is accepted, and the sentence where it is not."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import BaseModel, BeforeValidator, Discriminator, PlainValidator, Tag
from pydantic_core import PydanticCustomError

from contwalk.equations.loading import PREFIX
from contwalk.workflow.run_file.document import shown
from contwalk.workflow.run_file.names import BORN, CURVES, FOLLOWED, LOWEST_ACCURACY

LEAST_BORDER_ACCURACY, MOST_BORDER_ACCURACY = 1e-12, 0.5
MOST_INSTANTS = 1000


def wrong(sentence: str, remedy: str = "") -> PydanticCustomError:
    """A validation error with its sentence and remedy; without a remedy, the field's description is one."""
    return PydanticCustomError("wrong", "{sentence}", {"sentence": sentence, "remedy": remedy})


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


def _number_or_expression(value: Any) -> float | str:
    return value if isinstance(value, str) else number(value)


def _within(low: float, high: float, words: str) -> Callable[[Any], float]:
    def check(value: Any) -> float:
        result = number(value)
        if not low < result <= high:
            raise wrong(f"is {shown(result)}.", f"Allowed: {words}.")
        return result

    return check


def _accuracy(value: Any) -> float:
    result = _within(0.0, 0.5, f"a number from {LOWEST_ACCURACY:g} to 0.5")(value)
    if result < LOWEST_ACCURACY:
        raise wrong(
            f"is {shown(result)}, finer than double precision can give.",
            f"Allowed: a number from {LOWEST_ACCURACY:g} to 0.5; 1e-10 is already fine.",
        )
    return result


def _tolerance(value: Any) -> float:
    result = _within(0.0, 1e-2, "a number from 1e-14 to 0.01")(value)
    if result < LOWEST_ACCURACY:
        raise wrong(f"is {shown(result)}, finer than double precision can give.", "Allowed: 1e-14 to 0.01.")
    return result


def _file_name(value: Any) -> str:
    if not isinstance(value, str):
        raise wrong(f"is {shown(value)}, which is not a text.")
    if not value.strip() or "\0" in value:
        raise wrong("is empty." if not value.strip() else "holds a null character.")
    return value


def _until(value: Any) -> float | str:
    if value == "settled":
        return "settled"
    if isinstance(value, str):
        raise wrong(f"is {shown(value)}.", "Allowed: settled, or a positive number of seconds.")
    return _within(0.0, math.inf, "settled, or a positive number of seconds")(value)


def _until_or_at_once(value: Any) -> float | str:
    return 0.0 if value == 0 and not isinstance(value, bool) else _until(value)


def _mark_value(value: Any) -> float | str:
    if value == "extremum":
        return "extremum"
    if isinstance(value, str):
        raise wrong(f"is {shown(value)}.", "Allowed: a number, or the word extremum.")
    return number(value)


def as_tuple(value: Any) -> Any:
    """A list as a tuple; a single value as a tuple of one; null stays."""
    if value is None or isinstance(value, tuple):
        return value
    return tuple(value) if isinstance(value, list) else (value,)


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


def as_system(value: Any) -> Any:
    """Equations as the reference that stands for them; a name or a path as it is."""
    if not isinstance(value, dict):
        return value
    form = 'Allowed: a name, a path, or {equations: "x\' = a - x; a = 1"}.'
    if set(value) != {"equations"}:
        raise wrong("is a mapping that has not the one key equations.", form)
    if not isinstance(value["equations"], str):
        raise wrong(f"has equations that are {shown(value['equations'])}, not a text.", form)
    return PREFIX + value["equations"]


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


def _text_or_values(value: Any) -> str:
    return "(preset)" if isinstance(value, str) else "(values)"


def _one_or_list(value: Any) -> str:
    return "(list)" if isinstance(value, list | tuple) else "(one)"


def _one_or_two(value: Any) -> str:
    return "(two)" if isinstance(value, dict) else "(one)"


def list_or_span(value: Any) -> str:
    """The tag of the form in which swept values are written, or have been read."""
    return "(span)" if isinstance(value, dict | BaseModel) else "(list)"


def _border_accuracy(value: Any) -> float:
    found = number(value)
    if not LEAST_BORDER_ACCURACY <= found <= MOST_BORDER_ACCURACY:
        raise wrong(f"is {shown(value)}.", "Allowed: a number from 1e-12 to 0.5.")
    return found


def _instants(value: Any) -> int | tuple[float, ...]:
    """A number of them, or the parts of the closure."""
    if isinstance(value, int) and not isinstance(value, bool) and 1 <= value <= MOST_INSTANTS:
        return value
    if isinstance(value, list) and value:
        found = tuple(number(each) for each in value)
        outside = [each for each in found if not 0.0 <= each < 1.0]
        if outside:
            raise wrong(
                f"has {outside[0]:.12g}.", "Allowed: numbers from 0 to below 1, parts of the closure."
            )
        return found
    raise wrong(
        f"is {shown(value)}.",
        "Allowed: a whole number from 1 to 1000, or a list of numbers from 0 to below 1.",
    )


def _effort(value: Any) -> float | None:
    """A positive number; None for as much as it takes."""
    if value is None or value == "none":
        return None
    return _within(0.0, math.inf, "a positive number, or none")(value)


Number = Annotated[float, PlainValidator(number)]
Positive = Annotated[float, PlainValidator(_within(0.0, math.inf, "a positive number"))]
BorderAccuracy = Annotated[float, PlainValidator(_border_accuracy)]
Angle = Annotated[float, PlainValidator(_within(0.0, 90.0, "degrees above 0, up to 90"))]
Accuracy = Annotated[float, PlainValidator(_accuracy)]
Tolerance = Annotated[float, PlainValidator(_tolerance)]
Effort = Annotated[float | None, PlainValidator(_effort)]
Until = Annotated[float | str, PlainValidator(_until)]
StartUntil = Annotated[float | str, PlainValidator(_until_or_at_once)]
MarkValue = Annotated[float | str, PlainValidator(_mark_value)]
Instants = Annotated[int | tuple[float, ...], PlainValidator(_instants)]
FileName = Annotated[str, PlainValidator(_file_name)]
Numbers = Annotated[tuple[Number, ...], BeforeValidator(as_tuple)]
Texts = Annotated[tuple[str, ...], BeforeValidator(as_tuple)]
OneOrSeveral = Annotated[
    Annotated[str, Tag("(one)")] | Annotated[Texts, Tag("(list)")], Discriminator(_one_or_list)
]
Values = dict[str, Number]
NumbersOrExpressions = dict[str, Annotated[float | str, PlainValidator(_number_or_expression)]]
Range = Annotated[tuple[Number, ...], BeforeValidator(lambda v: tuple(v) if isinstance(v, list) else v)]
Names = Annotated[tuple[str, ...], BeforeValidator(lambda v: tuple(v) if isinstance(v, list) else v)]
OneOrTwoRanges = Annotated[
    Annotated[Range, Tag("(one)")] | Annotated[dict[str, Range], Tag("(two)")], Discriminator(_one_or_two)
]
End = Annotated[
    Annotated[str, Tag("(preset)")] | Annotated[Values, Tag("(values)")], Discriminator(_text_or_values)
]
Action = Literal["stop", "ignore", "switch"]
if TYPE_CHECKING:
    FollowedLabel = str
    CurveLabel = str
    BornLabel = str
else:
    FollowedLabel = Literal[FOLLOWED]
    CurveLabel = Literal[CURVES]
    BornLabel = Literal[BORN]
