"""What `contwalk margins` pushes, and how: the stored solution, the rule of surviving, and the rays."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import numpy as np

from contwalk.branch import NOT_KNOWN, Branch, SpecialPoint
from contwalk.errors import ContwalkError, StartError
from contwalk.studies.margins.conserved import changed_quantities
from contwalk.studies.margins.directions import (
    drawn_directions,
    existing,
    given_direction,
    state_direction,
    unit_of,
)
from contwalk.studies.margins.modes import ModeDirections, mode_directions
from contwalk.studies.margins.solution import Solution, solution_at
from contwalk.studies.margins.survival import MEANINGS, SURVIVED, Rule
from contwalk.workflow.margin_rays import Ray, Study, survival_of
from contwalk.workflow.run_file.margins import MarginsFile
from contwalk.workflow.stored.points import branch_of, place_of

PERIODS = 20.0  # to survive, where nobody says
# A smooth motion that nothing ends must have come back so near, in units of the magnitudes.
RETURNS = 0.1
# Local errors of motions where nobody says: they must not move a border by its own accuracy.
TOLERANCE, SHARE, LEAST_TOLERANCE = 1e-8, 1e-4, 1e-13
# Of a small push no more than this part is left of what is forgotten.
FORGOTTEN = 0.5
CHANGED = "The system's files have changed since the database was computed."


def study_of(run: MarginsFile) -> tuple[Study, list[ModeDirections], list[str]]:
    """The study, the directions of modes that are asked for, and what is to be said of it.

    Raises
    ------
    ContwalkError
    """
    from contwalk.storage import open_database

    wanted, system = run.margins, run.system
    fractions = (
        tuple(k / wanted.instants for k in range(wanted.instants))
        if isinstance(wanted.instants, int)
        else wanted.instants
    )
    with _located(run, "of", "from"):
        database = open_database(run.database)
    with database as db:
        with _located(run, "of", "point"):
            branch = branch_of(db, run.database, wanted.of.point, system)
            point = place_of(branch, run.database, wanted.of.point)
            notes = _check_stable(branch, point, wanted.of.point)
        stored = str(db.header.provenance.get("plugin_sha256", system.source))
        notes += [] if stored == system.source else [CHANGED]
        if branch.info.problem == "equilibrium":
            if not isinstance(wanted.instants, int):
                notes.append("An equilibrium is the same at all instants; it is pushed once.")
            fractions = (0.0,)
        with _located(run, "of", "point"):
            solution = solution_at(system, branch, point, fractions)
        modes = []
        if wanted.modes:
            with _located(run, "modes"):
                modes = mode_directions(system, branch, point, solution, wanted.modes)
    if wanted.basin is not None and wanted.basin.instant >= len(solution.instants):
        raise run.refusal(
            ("margins", "basin", "instant"),
            f"is {wanted.basin.instant}, and an equilibrium is the same at all instants.",
            "Leave it out.",
        )
    for name, value in run.parameters.items():
        if solution.parameters[name] != value:
            raise run.refusal(
                ("parameters", name),
                f"is {value:.12g}; at {wanted.of.point} of {run.database} it is "
                f"{solution.parameters[name]:.12g}.",
                "Margins are of a stored solution: leave the parameter out, or name another point.",
            )
    rule = _rule(run, solution)
    notes += _slowly_forgotten(branch, point, rule.duration, solution.period)
    return (
        Study(
            reference=run.system_reference,
            model=dict(run.model),
            base=str(run.path.parent.resolve()),
            source=system.source,
            solution=solution,
            rule=rule,
            accuracy=wanted.accuracy,
            scan=wanted.scan,
            farthest=wanted.farthest,
        ),
        modes,
        notes,
    )


def _check_stable(branch: Branch, point: SpecialPoint | int, name: str) -> list[str]:
    """Refuse what is unstable on both sides: any push along its unstable direction is lost in time.

    What is not known, as of motions that conserve energy, is noted.
    """
    sides = (
        [int(branch["unstable"][point])]
        if isinstance(point, int)
        else [NOT_KNOWN if n is None else n for n in (point.unstable_before, point.unstable_after)]
    )
    unstable = min(sides)
    if unstable > 0:
        raise StartError(
            f"{name} is unstable in {unstable} direction{'s' * (unstable > 1)}: every push that has a share "
            "in them is lost sooner or later.",
            "Margins are of stable motions: name a point where `contwalk show` counts 0 unstable directions.",
        )
    if 0 in sides:
        return []
    return [
        f"Whether {name} is stable is not known: what is critical is within its error of where that changes."
    ]


@contextmanager
def _located(run: MarginsFile, *key: str) -> Iterator[None]:
    """What is wrong with what a key of the section names is told with the file, the line and the key."""
    try:
        yield
    except ContwalkError as error:
        if error.exit_code != ContwalkError.exit_code:
            raise
        raise run.refusal(("margins", *key), error.args[0], error.remedy) from error


def _slowly_forgotten(branch: Branch, point: SpecialPoint | int, duration: float, period: float) -> list[str]:
    """A sentence where what is left of a small push in its slowest direction is much, when the motion has
    survived."""
    if isinstance(point, int):
        spectrum = np.asarray(branch.points["spectrum"][point])
    else:
        spectrum = np.asarray(point.spectrum)
    spectrum = spectrum[np.isfinite(spectrum)]
    if not len(spectrum):
        return []
    if np.isnan(period):
        left = float(np.exp(spectrum.real.max() * duration))
    else:
        closures = duration / period * int(branch.info.settings.get("fold", 1))
        left = float(np.abs(spectrum).max() ** closures)
    if left < FORGOTTEN:
        return []
    return [
        f"Of a small push in the slowest direction {min(left, 1.0):.2g} is left when a motion counts as "
        "surviving: some that survive may be lost later. Ask for more with survive."
    ]


def _rule(run: MarginsFile, solution: Solution) -> Rule:
    survive, wanted, system = run.margins.survive, run.margins, run.system
    if np.isnan(solution.period) and survive.time is None:
        raise run.refusal(
            ("margins", "survive"),
            f"gives no time, and the point {wanted.of.point} is an equilibrium, which has no period.",
            "Say for how long a motion must survive: survive: {time: 100}.",
        )
    duration = survive.time if survive.time is not None else (survive.periods or PERIODS) * solution.period
    sequence = survive.sequence == "kept" and bool(solution.cycle)
    judged = system.fallen is not None or sequence
    returns = survive.returns if survive.returns is not None else None if judged else RETURNS
    tolerance = wanted.tolerance or max(min(TOLERANCE, SHARE * wanted.accuracy), LEAST_TOLERANCE)
    return Rule(float(duration), sequence, returns, tolerance, wanted.method)


def rays_of(
    run: MarginsFile, study: Study, modes: Sequence[ModeDirections] = ()
) -> tuple[list[Ray], list[str]]:
    """The rays in their order, and which states are left out, and why."""
    solution, names, wanted = study.solution, run.system.state_names, run.margins
    others = bool(wanted.directions or wanted.modes or wanted.random or wanted.basin)
    pushed = () if others and "states" not in wanted.model_fields_set else wanted.states
    chosen = [name for name in names if pushed == ("all",) or name in pushed]
    notes = []
    neutral = [name for name in chosen if name in solution.neutral]
    if neutral:
        notes.append(f"Left out as neutral, so that no push along them is lost: {', '.join(neutral)}.")
    rays: list[Ray] = []
    for number, instant in enumerate(solution.instants):
        absent = [name for name in chosen if names.index(name) not in instant.exists]
        if absent:
            notes.append(
                f"Left out at instant {number}, as they do not exist in mode '{instant.mode}': "
                f"{', '.join(absent)}."
            )
        left_out = {*neutral, *absent}
        along = {name: state_direction(names, name) for name in chosen if name not in left_out}
        along |= {name: given_direction(names, shares) for name, shares in wanted.directions.items()}
        along |= {mode.name: mode.vectors[number] for mode in modes}
        if wanted.random is not None:
            along |= drawn_directions(wanted.random.count, wanted.random.seed, solution, names, instant)
        for name, vector in along.items():
            there = existing(vector, instant)
            unit = unit_of(there, solution.magnitudes)
            if unit is None:
                notes.append(f"Left out at instant {number}, as it pushes no state that exists: {name}.")
                continue
            push = tuple(there.tolist())
            rays += [Ray(len(rays) + k, number, name, sign, push, unit) for k, sign in enumerate((1, -1))]
    if not rays and wanted.basin is None:
        raise ContwalkError("No state is left to be pushed.", " ".join(notes))
    return rays, notes + _never_forgotten(run, study, rays)


def _never_forgotten(run: MarginsFile, study: Study, rays: Sequence[Ray]) -> list[str]:
    """Sentences where pushes change what is conserved."""
    system, solution, basin, notes = run.system, study.solution, run.margins.basin, []
    pushes = [(solution.instants[ray.instant], ray.unit * np.array(ray.vector)) for ray in rays]
    changed = changed_quantities(system, solution, pushes)
    if changed:
        near = f", within {study.rule.returns:g} of it" if study.rule.returns is not None else ""
        notes.append(
            f"Pushes change what the machine conserves ({', '.join(changed)}), and that is never forgotten: "
            f"what survives stays beside the solution{near}, and does not come back to it. Push along a "
            "level with directions to ask what comes back."
        )
    if basin is not None:
        changed = changed_on_plane(run, study)
        if changed:
            notes.append(
                f"Motions of the basin keep {', '.join(changed)} as they begin, and so come to solutions of "
                "their own: what does not come to a stored one is unknown, and the plane shows no basin of "
                "it."
            )
    return notes


def changed_on_plane(run: MarginsFile, study: Study) -> list[str]:
    """Names of the conserved quantities that differ on the plane of the basin that a run file asks for."""
    basin, names = run.margins.basin, run.system.state_names
    assert basin is not None
    instant = study.solution.instants[basin.instant]
    plane = [study.solution.magnitudes * state_direction(names, name) for name in basin.states]
    return changed_quantities(run.system, study.solution, [(instant, push) for push in plane])


def check_unpushed(study: Study) -> None:
    """Refuse a motion that does not survive without any push.

    Raises
    ------
    ContwalkError
    """
    survival = survival_of(study)
    for number, instant in enumerate(study.solution.instants):
        ended = survival.verdict(instant, np.zeros(len(survival.system.states)))
        if ended != SURVIVED:
            raise ContwalkError(
                f"The motion does not survive unpushed from instant {number}: {MEANINGS[ended]} ({ended}).",
                "Margins are of stable motions. Name another point, or ask for less: survive: {periods: 5}.",
            )
