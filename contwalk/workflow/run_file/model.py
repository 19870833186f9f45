"""The form of a run file: which keys there are, and the form of each.

What depends on the system (names, bounds) is checked afterwards, in the modules beside this one. The
description of a key says what is allowed there; error messages quote it.
"""

from __future__ import annotations

from typing import Any

from contwalk.workflow.run_file.faults import wrong
from contwalk.workflow.run_file.forms import (
    anything,
    list_of,
    mapping_of,
    one_of,
    text,
    whole,
    written_as,
)
from contwalk.workflow.run_file.motions import Sampling, Simulation
from contwalk.workflow.run_file.section import Section, key
from contwalk.workflow.run_file.values import (
    ACTION,
    ACTIONS,
    BORN,
    CURVES,
    FIGURES,
    FOLLOWED,
    angle,
    as_accuracy,
    as_born,
    as_curves,
    as_diagram,
    as_figure,
    as_labels,
    as_list,
    as_starts,
    file_name,
    mark_value,
    number,
    numbers,
    positive,
    start_until,
    text_or_texts,
    text_or_values,
    values,
)

MODE, AT = "the name of a mode of the system", "the transition that the state comes right before"
INTERVAL = list_of(number, written=as_list)


class Simulate(Section):
    """A start by simulation."""

    state: dict[str, float] = key(values, "{state: value, ...} with every state")
    until: float | str = key(start_until, "settled, a positive number of seconds, or 0", "settled")
    mode: str | None = key(text, MODE, None)
    at: str | None = key(text, AT, None)


class Start(Section):
    """Where branches begin."""

    equilibrium: tuple[str, ...] | None = key(
        list_of(text), "the name of an equilibrium, a list of names, or all", None
    )
    state: dict[str, float] | None = key(values, "{state: value, ...} with every state", None)
    mode: str | None = key(text, MODE, None)
    at: str | None = key(text, AT, None)
    simulate: Simulate | None = key(Simulate, "{state: {...}, until: settled}", None)
    from_: str | None = key(file_name, "the path of a database, other.h5", None, written="from")
    point: str | None = key(text, "a stored point, as b1/HB1 or b1/12", None)
    parameters: dict[str, float] = key(values, "{parameter: value, ...} for this start only", {})

    def fit(self) -> None:
        """One way to start, with what belongs to it."""
        given = [kind for kind in ("equilibrium", "state", "simulate") if getattr(self, kind) is not None]
        given += ["from"] if self.from_ is not None else []
        allowed = "Allowed: exactly one of equilibrium, state, simulate, from."
        if len(given) != 1:
            raise wrong(f"has {' and '.join(given) or 'none of the ways to start'}.", allowed)
        if (self.point is None) != (self.from_ is None):
            lacks, has = ("point", "from") if self.point is None else ("from", "point")
            raise wrong(f"has {has} but no {lacks}.", "Give both, as in {from: other.h5, point: b1/HB1}.")
        for name in ("mode", "at"):
            if self.state is None and getattr(self, name) is not None:
                inside = "simulate" if self.simulate is not None else "state"
                example = f"{{state: {{...}}, {name}: NAME}}"
                example = f"{{simulate: {example}}}" if inside == "simulate" else example
                raise wrong(f"has {name} without a state of its own.", f"It belongs to one, as in {example}.")
        if self.equilibrium == ():
            raise wrong("lists no equilibrium.", "Name one, or write equilibrium: all.")


def interval_or_two(value: Any) -> tuple[float, ...] | dict[str, tuple[float, ...]]:
    """The range of one parameter, or those of two by name."""
    return mapping_of(INTERVAL)(value) if isinstance(value, dict) else INTERVAL(value)


class Continue(Section):
    """What is continued."""

    parameter: str | None = key(text, "the name of a parameter of the system", None)
    parameters: tuple[str, ...] | None = key(
        list_of(text), "the names of two parameters, [first, second], for a curve in two", None
    )
    range: tuple[float, ...] | dict[str, tuple[float, ...]] | None = key(
        interval_or_two, "two numbers, [lowest, highest], or {parameter: [lowest, highest], ...} of two", None
    )
    direction: str = key(
        one_of("both", "forward", "backward", "up", "down"),
        "both, forward = up (growing parameter), or backward = down",
        "both",
    )
    max_points: int = key(whole(1), "a whole number from 1 up", 1000)
    stop_at: dict[str, tuple[float, ...]] = key(
        mapping_of(numbers), "{parameter or observable: value or [values]}", {}
    )


class Loci(Section):
    """Curves in two parameters from the special points of a study."""

    with_: str = key(text, "the name of the second parameter", written="with")
    range: tuple[float, ...] = key(INTERVAL, "two numbers, [lowest, highest], of the second parameter")
    of: tuple[str, ...] = key(
        list_of(one_of(*CURVES), written=as_curves),
        f"a list of labels ({', '.join(CURVES)}), or all",
        CURVES,
    )
    follow: tuple[str, ...] = key(
        list_of(one_of(*BORN), written=as_born), f"a list of labels ({', '.join(BORN)}), all, or none", BORN
    )


class ParameterPath(Section):
    """A line through the parameters."""

    from_: str | dict[str, float] = key(
        text_or_values, "a preset, or {parameter: value, ...}", written="from"
    )
    to: str | dict[str, float] = key(text_or_values, "a preset, or {parameter: value, ...}")


class Diagram(Section):
    """Which branches are followed."""

    follow: tuple[str, ...] = key(
        list_of(one_of(*FOLLOWED), written=as_labels),
        f"a list of labels ({', '.join(FOLLOWED)}), all, or none",
        ("BP", "HB", "PD"),
    )
    depth: int = key(whole(0), "a whole number from 0 up", 5)


class Events(Section):
    """What becomes of a branch at limits."""

    GR: str = key(ACTION, ACTIONS, "stop")
    OC: str = key(ACTION, ACTIONS, "switch")
    AZ: str = key(ACTION, ACTIONS, "ignore")


class ReportPlace(Section):
    """Where orbits are reported."""

    event: str | None = key(text, "the name of a transition of the system", None)
    side: str | None = key(one_of("before", "after"), "before or after", None)
    section: dict[str, float] | None = key(values, "{state: value}", None)
    direction: str | None = key(one_of("rising", "falling"), "rising or falling", None)

    def fit(self) -> None:
        """An event or a section."""
        allowed = "Allowed: {event: NAME, side: before} or {section: {STATE: VALUE}, direction: rising}."
        if (self.event is None) == (self.section is None):
            raise wrong("needs either an event or a section.", allowed)
        if self.event is not None and self.direction is not None:
            raise wrong("has a direction, which belongs to a section.", allowed)
        if self.section is not None and self.side is not None:
            raise wrong("has a side, which belongs to an event.", allowed)
        if self.section is not None and (len(self.section) != 1 or self.direction is None):
            raise wrong("needs a section of exactly one state, and a direction.", allowed)


class FigureOptions(Section):
    """What is drawn, and how."""

    x: str | None = key(text, "a parameter, state or observable", None)
    y: str | tuple[str, ...] | None = key(
        text_or_texts,
        "a parameter, state or observable; of a time_series, a list of them as well",
        None,
    )
    z: str | None = key(text, "a state, for a phase_portrait in space", None)
    xlim: tuple[float, ...] | None = key(INTERVAL, "two numbers, [left, right]", None)
    ylim: tuple[float, ...] | None = key(INTERVAL, "two numbers, [lowest, highest]", None)
    file: str | None = key(file_name, "a file name", None)


class Span(Section):
    """Values at equal distances."""

    from_: float = key(number, "a number", written="from")
    to: float = key(number, "a number")
    count: int = key(whole(2, 10_000), "a whole number from 2 to 10000")


class Engine(Section):
    """How branches are computed."""

    step: float | None = key(positive, "a positive number: the first relative arclength step", None)
    min_step: float | None = key(positive, "a positive number", None)
    max_step: float | None = key(positive, "a positive number", None)
    max_angle: float | None = key(angle, "degrees above 0, up to 90", None)
    max_share: float | None = key(
        positive, "a positive number: the largest step, in parts of the range", None
    )
    newton_iterations: int | None = key(whole(1), "a whole number from 1 up", None)
    method: str | None = key(
        one_of("auto", "dop853", "verner98", "radau5", "radau9"),
        "auto, dop853, verner98, radau5 or radau9",
        None,
    )
    discretization: str | None = key(
        one_of("shooting", "collocation"), "shooting (the default) or collocation", None
    )
    tolerance: float | None = key(positive, "a positive number: local error of the flow", None)
    segments: int | None = key(whole(1, 200), "a whole number from 1 to 200", None)
    phase: str | None = key(one_of("section", "integral"), "section or integral", None)
    mirror_images: str | None = key(one_of("known", "walked"), "known (the default) or walked", None)

    def fit(self) -> None:
        """Steps in order, and an integrator only where one is asked for."""
        given = [step for step in (self.min_step, self.step, self.max_step) if step is not None]
        if given != sorted(given):
            raise wrong("has steps out of order.", "Allowed: min_step <= step <= max_step.")
        if self.discretization == "collocation" and self.method not in (None, "auto"):
            raise wrong(
                f"asks for collocation and for the integrator {self.method}.",
                "Allowed with discretization: collocation: method: auto, or none. Remove one of the two.",
            )


def swept(value: Any) -> tuple[float, ...] | Span:
    """Values in a list, or at equal distances."""
    return Span.read(value) if isinstance(value, dict) else numbers(value)


class RunModel(Section):
    """Every key of a run file."""

    contwalk: int = key(whole(1, 1), "1, the version of this format", 1)
    system: str = key(text, "an installed system's name, or the path of a plugin file, ./my_model.py")
    model: dict[str, Any] = key(mapping_of(anything), "{choice: value, ...}", {})
    preset: str | None = key(text, "the name of a preset of the system", None)
    parameters: dict[str, float] = key(values, "{parameter: value, ...}", {})
    accuracy: float = key(as_accuracy, "a number", 1e-8)
    start: tuple[Start, ...] = key(
        list_of(Start.read, written=as_starts),
        "{equilibrium: NAME}, {state: {...}}, {simulate: {state: {...}, until: settled}}, "
        "{from: other.h5, point: b1/HB1}, or a list of these",
        (),
        inside=Start,
    )
    continue_: Continue = key(
        Continue, "{parameter: NAME, range: [lowest, highest], ...}", Continue(), written="continue"
    )
    path: ParameterPath | None = key(ParameterPath, "{from: preset or values, to: preset or values}", None)
    diagram: Diagram = key(
        written_as(as_diagram, Diagram.read),
        "{follow: [labels], depth: 5}, all, or none",
        Diagram(),
        inside=Diagram,
    )
    loci: Loci | None = key(Loci, "{with: parameter, range: [lowest, highest], of: all, follow: all}", None)
    mark: dict[str, tuple[float | str, ...]] = key(
        mapping_of(list_of(mark_value)), "{parameter or observable: [values, extremum]}", {}
    )
    events: Events = key(Events, "{GR: stop, OC: switch, AZ: ignore}", Events())
    report_at: ReportPlace | None = key(
        ReportPlace, "{event: NAME, side: before} or {section: {STATE: VALUE}, direction: rising}", None
    )
    output: str | None = key(file_name, "a file name, results.h5", None)
    figures: tuple[dict[str, FigureOptions], ...] = key(
        list_of(written_as(as_figure, mapping_of(FigureOptions.read))),
        f"a list of {', '.join(FIGURES)}",
        (),
        inside=FigureOptions,
    )
    sweep: dict[str, tuple[float, ...] | Span] | None = key(
        mapping_of(swept),
        "{parameter: [values]} or {parameter: {from: 0, to: 1, count: 11}}",
        None,
        inside=Span,
    )
    engine: Engine = key(
        Engine,
        "{step, min_step, max_step, max_angle, max_share, newton_iterations, method, "
        "discretization, tolerance, segments, phase, mirror_images}, all optional",
        Engine(),
    )
    simulate: Simulation | None = key(
        Simulation, "{until: settled, points: 1000, perturb: {state: value}, ...}", None
    )
    sample: Sampling | None = key(
        Sampling, "{count: 1000, seed: 1, draw: {...}, measure: {...}, settled: {...}, ...}", None
    )
