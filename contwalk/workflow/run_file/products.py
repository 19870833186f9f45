"""Products in a run file: a number that may depend on parameters, as `0.4*m1*l1/M`."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from contwalk.workflow.run_file.document import shown
from contwalk.workflow.run_file.values import number, wrong

FORM = "a number, or a product of numbers, pi and parameters, as 0.4*m1*l1/M"
_FACTOR = re.compile(r"(?P<number>(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?)|(?P<name>[^\W\d]\w*)")


@dataclass(frozen=True)
class Product:
    """Factors, each with whether it is divided by, and their sign.

    Parameters
    ----------
    text : str
        As it is written in the file.
    factors : tuple of (float or str, bool)
        A number or the name of a parameter; true: it is divided by.
    """

    text: str
    factors: tuple[tuple[float | str, bool], ...]

    @property
    def names(self) -> tuple[str, ...]:
        """The parameters in it."""
        return tuple(factor for factor, _ in self.factors if isinstance(factor, str))

    def value(self, parameters: Mapping[str, float]) -> float:
        """The number that it is; not finite where it divides by zero."""
        result = 1.0
        for factor, divides in self.factors:
            plain = parameters[factor] if isinstance(factor, str) else factor
            if divides and plain == 0.0:
                return math.nan
            result = result / plain if divides else result * plain
        return result


def product(value: Any) -> Product:
    """A number or a text as a product; an error of validation for anything else."""
    if not isinstance(value, str):
        return Product(f"{number(value):.12g}", ((number(value), False),))
    text = value.strip()
    factors: list[tuple[float | str, bool]] = []
    if text[:1] in ("-", "+"):
        factors.append((-1.0 if text[0] == "-" else 1.0, False))
        text = text[1:].strip()
    operator = "*"
    for part in re.split(r"([*/])", text):
        if part in ("*", "/"):
            operator = part
            continue
        found = _FACTOR.fullmatch(part.strip())
        if found is None:
            raise wrong(f"is {shown(value)}, in which '{part.strip()}' is no factor.", f"Allowed: {FORM}.")
        name = found["name"]
        plain = math.pi if name == "pi" else name if name else number(float(found["number"]))
        factors.append((plain, operator == "/"))
    return Product(value.strip(), tuple(factors))


def as_products(values: Any) -> Any:
    """The two ends of an interval."""
    if not isinstance(values, list | tuple) or len(values) != 2:
        raise wrong(f"is {shown(values)}.", f"Allowed: [lowest, highest], each {FORM}.")
    return tuple(product(value) for value in values)


def names_in(products: Iterable[Product]) -> list[str]:
    """All parameters in some products, each once."""
    return list(dict.fromkeys(name for each in products for name in each.names))
