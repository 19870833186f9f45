"""The form of the sections `simulate`, `sample` and `margins` of a run file."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BeforeValidator, Field, PlainValidator

from contwalk.workflow.run_file.products import FORM, Product, as_products, product
from contwalk.workflow.run_file.section import Section
from contwalk.workflow.run_file.values import (
    BorderAccuracy,
    FileName,
    Instants,
    Positive,
    Texts,
    Tolerance,
    Until,
    Values,
    as_tuple,
)

ProductValue = Annotated[Product, PlainValidator(product)]
Interval = Annotated[tuple[Product, Product], PlainValidator(as_products)]
METHODS = ("dop853", "verner98", "radau5", "radau9")


class Simulation(Section):
    """`contwalk simulate`: one motion."""

    until: Until = Field(default="settled", description="settled, or a positive length of time")
    points: int = Field(
        default=1000, ge=2, le=1_000_000, description="a whole number of stored instants from 2 to 1000000"
    )
    perturb: Values = Field(default={}, description="{state: what is added to it at the start, ...}")
    tolerance: Tolerance = Field(default=1e-10, description="a number from 1e-14 to 0.01")
    method: Literal["dop853", "verner98", "radau5", "radau9"] = Field(
        default="dop853", description=", ".join(METHODS)
    )


class Measure(Section):
    """What is taken from each motion: when an observable crosses a level."""

    observable: str = Field(description="an observable of the system")
    level: ProductValue = Field(description=FORM)
    direction: Literal["falling", "rising"] = Field(default="falling", description="falling or rising")
    crossing: Literal["last", "first"] = Field(default="last", description="last or first")


class TimeUnit(Section):
    """In what times are told."""

    name: str = Field(description="a word for the figure, as revolutions")
    length: ProductValue = Field(description=FORM)


class Settled(Section):
    """When a motion has come to rest."""

    equilibrium: str = Field(description="the name of an equilibrium of the system")
    within: dict[str, Positive] = Field(description="{state: distance, ...}")


class Sampling(Section):
    """`contwalk sample`: many motions from drawn states and parameters."""

    count: int = Field(ge=1, le=10_000_000, description="a whole number from 1 to 10000000")
    seed: int = Field(default=1, ge=0, description="a whole number from 0 up")
    draw: dict[str, Interval] = Field(description="{state or parameter: [lowest, highest], ...}")
    measure: Measure = Field(
        description="{observable: NAME, level: VALUE, direction: falling, crossing: last}"
    )
    settled: Settled = Field(description="{equilibrium: NAME, within: {state: distance, ...}}")
    until: Positive = Field(description="a positive number of the unit of time")
    time_unit: TimeUnit | None = Field(default=None, description="{name: revolutions, length: 2*pi/omega}")
    tolerance: Tolerance = Field(default=1e-8, description="a number from 1e-14 to 0.01")


class Pushed(Section):
    """Which solution is pushed."""

    from_: FileName = Field(alias="from", description="the name of a database, other.h5")
    point: str = Field(description="a point of it, b1/UZ1 or b1/12")


class Survive(Section):
    """What surviving means."""

    periods: Positive | None = Field(default=None, description="a positive number of periods")
    time: Positive | None = Field(default=None, description="a positive number of the unit of time")
    sequence: Literal["kept", "ignored"] = Field(default="kept", description="kept or ignored")
    returns: Positive | None = Field(
        default=None, description="a positive number, in units of the states' magnitudes"
    )


class RandomDirections(Section):
    """Directions that are drawn."""

    count: int = Field(ge=1, le=100_000, description="a whole number from 1 to 100000")
    seed: int = Field(default=1, ge=0, description="a whole number from 0 up")


class Basin(Section):
    """A plane of pushes of two states, labelled by what the motions come to."""

    states: dict[str, Interval] = Field(description="{state: [lowest, highest], other: [lowest, highest]}")
    instant: int = Field(default=0, ge=0, description="the number of one of the instants")
    cells: int = Field(default=16, ge=1, le=1000, description="a whole number from 1 to 1000")
    levels: int = Field(default=3, ge=0, le=12, description="a whole number from 0 to 12")


class Margins(Section):
    """`contwalk margins`: how far a motion may be pushed."""

    of: Pushed = Field(description="{from: other.h5, point: b1/UZ1}")
    instants: Instants = Field(
        default=5, description="a whole number from 1 to 1000, or a list of parts of the closure"
    )
    states: Annotated[Texts, BeforeValidator(as_tuple)] = Field(
        default=("all",), description="all, or a list of states"
    )
    directions: dict[str, Values] = Field(
        default={}, description="{name: {state: its share in a push of size 1, ...}, ...}"
    )
    modes: int = Field(default=0, ge=0, le=1000, description="a whole number from 0 up")
    random: RandomDirections | None = Field(default=None, description="{count: 20, seed: 1}")
    basin: Basin | None = Field(
        default=None, description="{states: {x: [-2, 2], v: [-2, 2]}, instant: 0, cells: 16, levels: 3}"
    )
    survive: Survive = Field(default=Survive(), description="{periods: 20}")
    accuracy: BorderAccuracy = Field(
        default=0.01, description="a number from 1e-12 to 0.5: relative width of what a border lies in"
    )
    scan: int = Field(
        default=4,
        ge=0,
        le=10_000,
        description="a whole number from 0 up: further sizes that are tried on each side",
    )
    farthest: Positive = Field(default=1000.0, description="a positive number of the states' magnitudes")
    tolerance: Tolerance | None = Field(default=None, description="a number from 1e-14 to 0.01")
    method: Literal["dop853", "verner98", "radau5", "radau9"] = Field(
        default="dop853", description=", ".join(METHODS)
    )
