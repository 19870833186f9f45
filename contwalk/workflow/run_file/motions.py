"""The form of the sections `simulate` and `sample` of a run file."""

from __future__ import annotations

from contwalk.workflow.run_file.forms import mapping_of, one_of, text, whole
from contwalk.workflow.run_file.products import FORM, Product, as_products, product
from contwalk.workflow.run_file.section import Section, key
from contwalk.workflow.run_file.values import as_tolerance, positive, until_when, values

METHODS = ("dop853", "verner98", "radau5", "radau9")


class Simulation(Section):
    """`contwalk simulate`: one motion."""

    until: float | str = key(until_when, "settled, or a positive length of time", "settled")
    points: int = key(whole(2, 1_000_000), "a whole number of stored instants from 2 to 1000000", 1000)
    perturb: dict[str, float] = key(values, "{state: what is added to it at the start, ...}", {})
    tolerance: float = key(as_tolerance, "a number from 1e-14 to 0.01", 1e-10)
    method: str = key(one_of(*METHODS), ", ".join(METHODS), "dop853")


class Measure(Section):
    """What is taken from each motion: when an observable crosses a level."""

    observable: str = key(text, "an observable of the system")
    level: Product = key(product, FORM)
    direction: str = key(one_of("falling", "rising"), "falling or rising", "falling")
    crossing: str = key(one_of("last", "first"), "last or first", "last")


class TimeUnit(Section):
    """In what times are told."""

    name: str = key(text, "a word for the figure, as revolutions")
    length: Product = key(product, FORM)


class Settled(Section):
    """When a motion has come to rest."""

    equilibrium: str = key(text, "the name of an equilibrium of the system")
    within: dict[str, float] = key(mapping_of(positive), "{state: distance, ...}")


class Sampling(Section):
    """`contwalk sample`: many motions from drawn states and parameters."""

    count: int = key(whole(1, 10_000_000), "a whole number from 1 to 10000000")
    seed: int = key(whole(0), "a whole number from 0 up", 1)
    draw: dict[str, tuple[Product, Product]] = key(
        mapping_of(as_products), "{state or parameter: [lowest, highest], ...}"
    )
    measure: Measure = key(Measure, "{observable: NAME, level: VALUE, direction: falling, crossing: last}")
    settled: Settled = key(Settled, "{equilibrium: NAME, within: {state: distance, ...}}")
    until: float = key(positive, "a positive number of the unit of time")
    time_unit: TimeUnit | None = key(TimeUnit, "{name: revolutions, length: 2*pi/omega}", None)
    tolerance: float = key(as_tolerance, "a number from 1e-14 to 0.01", 1e-8)
