"""The form of a run file: which keys there are, and the type of each.

What depends on the system (names, bounds) is checked afterwards, in the `run_*` modules beside this one. The
description of a field says what is allowed there; error messages quote it.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Discriminator, Field, Tag
from pydantic import model_validator as validator_of_model

from contwalk.workflow.run_file.motions import Margins, Sampling, Simulation
from contwalk.workflow.run_file.names import BORN, CURVES, FIGURES, FOLLOWED
from contwalk.workflow.run_file.section import Section
from contwalk.workflow.run_file.values import (
    Accuracy,
    Action,
    Angle,
    BornLabel,
    CurveLabel,
    Effort,
    End,
    FileName,
    FollowedLabel,
    MarkValue,
    Names,
    Number,
    Numbers,
    NumbersOrExpressions,
    OneOrSeveral,
    OneOrTwoRanges,
    Positive,
    Range,
    StartUntil,
    Texts,
    Values,
    as_born,
    as_curves,
    as_diagram,
    as_figure,
    as_labels,
    as_starts,
    as_system,
    as_tuple,
    list_or_span,
    wrong,
)

MODE, AT = "the name of a mode of the system", "the transition that the state comes right before"


class Simulate(Section):
    """A start by simulation."""

    state: Values = Field(description="{state: value, ...} with every state")
    until: StartUntil = Field(default="settled", description="settled, a positive number of seconds, or 0")
    mode: str | None = Field(default=None, description=MODE)
    at: str | None = Field(default=None, description=AT)


class Start(Section):
    """Where branches begin."""

    equilibrium: Texts | None = Field(
        default=None, description="the name of an equilibrium, a list of names, or all"
    )
    state: Values | None = Field(default=None, description="{state: value, ...} with every state")
    mode: str | None = Field(default=None, description=MODE)
    at: str | None = Field(default=None, description=AT)
    simulate: Simulate | None = Field(default=None, description="{state: {...}, until: settled}")
    from_: FileName | None = Field(default=None, alias="from", description="the path of a database, other.h5")
    point: str | None = Field(default=None, description="a stored point, as b1/HB1 or b1/12")
    parameters: Values = Field(default={}, description="{parameter: value, ...} for this start only")

    @validator_of_model(mode="after")
    def _one_kind(self) -> Start:
        given = [kind for kind in ("equilibrium", "state", "simulate") if getattr(self, kind) is not None]
        given += ["from"] if self.from_ is not None else []
        allowed = "Allowed: exactly one of equilibrium, state, simulate, from."
        if len(given) != 1:
            raise wrong(f"has {' and '.join(given) or 'none of the ways to start'}.", allowed)
        if (self.point is None) != (self.from_ is None):
            lacks, has = ("point", "from") if self.point is None else ("from", "point")
            raise wrong(f"has {has} but no {lacks}.", "Give both, as in {from: other.h5, point: b1/HB1}.")
        for key in ("mode", "at"):
            if self.state is None and getattr(self, key) is not None:
                inside = "simulate" if self.simulate is not None else "state"
                example = f"{{state: {{...}}, {key}: NAME}}"
                example = f"{{simulate: {example}}}" if inside == "simulate" else example
                raise wrong(f"has {key} without a state of its own.", f"It belongs to one, as in {example}.")
        if self.equilibrium == ():
            raise wrong("lists no equilibrium.", "Name one, or write equilibrium: all.")
        return self


class Continue(Section):
    """What is continued."""

    parameter: str | None = Field(default=None, description="the name of a parameter of the system")
    parameters: Names | None = Field(
        default=None, description="the names of two parameters, [first, second], for a curve in two"
    )
    range: OneOrTwoRanges | None = Field(
        default=None,
        description="two numbers, [lowest, highest], or {parameter: [lowest, highest], ...} of two",
    )
    direction: Literal["both", "forward", "backward", "up", "down"] = Field(
        default="both",
        description="both, forward = up (growing parameter), or backward = down",
    )
    max_points: int = Field(default=1000, ge=1, description="a whole number from 1 up")
    stop_at: dict[str, Numbers] = Field(
        default={}, description="{parameter or observable: value or [values]}"
    )


class Loci(Section):
    """Curves in two parameters from the special points of a study."""

    with_: str = Field(alias="with", description="the name of the second parameter")
    range: Range = Field(description="two numbers, [lowest, highest], of the second parameter")
    of: Annotated[tuple[CurveLabel, ...], BeforeValidator(as_curves)] = Field(
        default=CURVES, description=f"a list of labels ({', '.join(CURVES)}), or all"
    )
    follow: Annotated[tuple[BornLabel, ...], BeforeValidator(as_born)] = Field(
        default=BORN, description=f"a list of labels ({', '.join(BORN)}), all, or none"
    )


class ParameterPath(Section):
    """A line through the parameters."""

    from_: End = Field(alias="from", description="a preset, or {parameter: value, ...}")
    to: End = Field(description="a preset, or {parameter: value, ...}")


# How many times what the first branch of a problem cost a person waits for another one: see the reference.
EFFORT = 50.0


class Diagram(Section):
    """Which branches are followed."""

    follow: Annotated[tuple[FollowedLabel, ...], BeforeValidator(as_labels)] = Field(
        default=("BP", "HB", "PD"), description=f"a list of labels ({', '.join(FOLLOWED)}), all, or none"
    )
    depth: int = Field(default=5, ge=0, description="a whole number from 0 up")
    effort: Effort = Field(default=EFFORT, description="a positive number, or none")


class Events(Section):
    """What becomes of a branch at limits."""

    GR: Action = Field(default="stop", description="stop, ignore or switch")
    OC: Action = Field(default="switch", description="stop, ignore or switch")
    AZ: Action = Field(default="ignore", description="stop, ignore or switch")
    BE: Action = Field(default="stop", description="stop, ignore or switch")


class ReportPlace(Section):
    """Where orbits are reported."""

    event: str | None = Field(default=None, description="the name of a transition of the system")
    side: Literal["before", "after"] | None = Field(default=None, description="before or after")
    section: Values | None = Field(default=None, description="{state: value}")
    direction: Literal["rising", "falling"] | None = Field(default=None, description="rising or falling")

    @validator_of_model(mode="after")
    def _one_kind(self) -> ReportPlace:
        allowed = "Allowed: {event: NAME, side: before} or {section: {STATE: VALUE}, direction: rising}."
        if (self.event is None) == (self.section is None):
            raise wrong("needs either an event or a section.", allowed)
        if self.event is not None and self.direction is not None:
            raise wrong("has a direction, which belongs to a section.", allowed)
        if self.section is not None and self.side is not None:
            raise wrong("has a side, which belongs to an event.", allowed)
        if self.section is not None and (len(self.section) != 1 or self.direction is None):
            raise wrong("needs a section of exactly one state, and a direction.", allowed)
        return self


class FigureOptions(Section):
    """What is drawn, and how."""

    x: str | None = Field(default=None, description="a parameter, state or observable")
    y: OneOrSeveral | None = Field(
        default=None, description="a parameter, state or observable; of a time_series, a list of them as well"
    )
    z: str | None = Field(default=None, description="a state, for a phase_portrait in space")
    xlim: Range | None = Field(default=None, description="two numbers, [left, right]")
    ylim: Range | None = Field(default=None, description="two numbers, [lowest, highest]")
    full: bool | None = Field(default=None, description="true: multipliers of full orbits, or false")
    together: bool | None = Field(default=None, description="true: one pair of panels for all, or false")
    file: FileName | None = Field(default=None, description="a file name")


class Span(Section):
    """Values at equal distances."""

    from_: Number = Field(alias="from", description="a number")
    to: Number = Field(description="a number")
    count: int = Field(ge=2, le=10_000, description="a whole number from 2 to 10000")


class Engine(Section):
    """How branches are computed."""

    step: Positive | None = Field(
        default=None, description="a positive number: the first relative arclength step"
    )
    min_step: Positive | None = Field(default=None, description="a positive number")
    max_step: Positive | None = Field(default=None, description="a positive number")
    max_angle: Angle | None = Field(default=None, description="degrees above 0, up to 90")
    max_share: Positive | None = Field(
        default=None, description="a positive number: the largest step, in parts of the range"
    )
    newton_iterations: int | None = Field(default=None, ge=1, description="a whole number from 1 up")
    method: Literal["auto", "dop853", "verner98", "radau5", "radau9"] | None = Field(
        default=None, description="auto, dop853, verner98, radau5 or radau9"
    )
    discretization: Literal["auto", "shooting", "collocation"] | None = Field(
        default=None, description="auto (the default), shooting or collocation"
    )
    tolerance: Positive | None = Field(default=None, description="a positive number: local error of the flow")
    segments: int | None = Field(default=None, ge=1, le=200, description="a whole number from 1 to 200")
    phase: Literal["section", "integral"] | None = Field(default=None, description="section or integral")
    mirror_images: Literal["known", "walked"] | None = Field(
        default=None, description="known (the default) or walked"
    )
    neutral_saddles: Literal["follow", "stop"] | None = Field(
        default=None, description="follow (the default) or stop"
    )

    @validator_of_model(mode="after")
    def _ordered(self) -> Engine:
        given = [step for step in (self.min_step, self.step, self.max_step) if step is not None]
        if given != sorted(given):
            raise wrong("has steps out of order.", "Allowed: min_step <= step <= max_step.")
        return self

    @validator_of_model(mode="after")
    def _one_method(self) -> Engine:
        if self.discretization == "collocation" and self.method not in (None, "auto"):
            raise wrong(
                f"asks for collocation and for the integrator {self.method}.",
                "Allowed with discretization: collocation: method: auto, or none. Remove one of the two.",
            )
        return self


SweepValues = Annotated[
    Annotated[Numbers, Tag("(list)")] | Annotated[Span, Tag("(span)")], Discriminator(list_or_span)
]


class RunModel(Section):
    """Every key of a run file."""

    contwalk: int = Field(default=1, ge=1, le=1, description="1, the version of this format")
    system: Annotated[str, BeforeValidator(as_system)] = Field(
        description="an installed system's name, the path of a plugin file, ./my_model.py, or "
        '{equations: "x\' = a - x; a = 1"}'
    )
    author: str | None = Field(default=None, description="text: who has made the study")
    description: str | None = Field(default=None, description="text: what the study is of")
    model: dict[str, Any] = Field(default={}, description="{choice: value, ...}")
    preset: str | None = Field(default=None, description="the name of a preset of the system")
    parameters: NumbersOrExpressions = Field(
        default={}, description="{parameter: value, ...}; a value may be an expression of other parameters"
    )
    accuracy: Accuracy = Field(default=1e-8, description="a number")
    start: Annotated[tuple[Start, ...], BeforeValidator(as_starts)] = Field(
        default=(),
        description="{equilibrium: NAME}, {state: {...}}, {simulate: {state: {...}, until: settled}}, "
        "{from: other.h5, point: b1/HB1}, or a list of these",
    )
    continue_: Continue = Field(
        default=Continue(), alias="continue", description="{parameter: NAME, range: [lowest, highest], ...}"
    )
    path: ParameterPath | None = Field(
        default=None, description="{from: preset or values, to: preset or values}"
    )
    diagram: Annotated[Diagram, BeforeValidator(as_diagram)] = Field(
        default=Diagram(), description=f"{{follow: [labels], depth: 5, effort: {EFFORT:g}}}, all, or none"
    )
    loci: Loci | None = Field(
        default=None, description="{with: parameter, range: [lowest, highest], of: all, follow: all}"
    )
    mark: dict[
        str,
        Annotated[tuple[MarkValue, ...], BeforeValidator(as_tuple)],
    ] = Field(default={}, description="{parameter or observable: [values, extremum]}")
    events: Events = Field(default=Events(), description="{GR: stop, OC: switch, AZ: ignore, BE: stop}")
    report_at: ReportPlace | None = Field(
        default=None,
        description="{event: NAME, side: before} or {section: {STATE: VALUE}, direction: rising}",
    )
    output: FileName | None = Field(default=None, description="a file name, results.h5")
    figures: Annotated[
        tuple[Annotated[dict[str, FigureOptions], BeforeValidator(as_figure)], ...],
        BeforeValidator(as_tuple),
    ] = Field(default=(), description=f"a list of {', '.join(FIGURES)}")
    sweep: dict[str, SweepValues] | None = Field(
        default=None, description="{parameter: [values]} or {parameter: {from: 0, to: 1, count: 11}}"
    )
    engine: Engine = Field(
        default=Engine(),
        description="{step, min_step, max_step, max_angle, max_share, newton_iterations, method, "
        "discretization, tolerance, segments, phase, mirror_images, neutral_saddles}, all optional",
    )
    simulate: Simulation | None = Field(
        default=None, description="{until: settled, points: 1000, perturb: {state: value}, ...}"
    )
    margins: Margins | None = Field(
        default=None,
        description="{of: {from: other.h5, point: b1/UZ1}, instants: 5, survive: {periods: 20}, ...}",
    )
    sample: Sampling | None = Field(
        default=None, description="{count: 1000, seed: 1, draw: {...}, measure: {...}, settled: {...}, ...}"
    )
