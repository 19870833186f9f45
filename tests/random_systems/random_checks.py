"""What must hold of every study, whatever its machine: each check answers with faults."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import combinations, pairwise

import numpy as np
from random_exact import miscounted
from random_independent import Machine, Unchecked
from random_recipe import Recipe
from random_rows import Round, parameters_of, rounds
from random_wide import WIDE

from contwalk.branch import Branch, SpecialPoint

EPSILON = 2.2e-16
# The corrector ends at some roundings of the terms, and the stored state is rounded itself.
RESIDUAL = 1e3 * EPSILON
# Complex steps and LAPACK give eigenvalues to some roundings of the matrix times their condition; a count is
# certain where the real part exceeds this part of the matrix.
CERTAIN = 1e-9
# Local errors of 1e-6 that a run with an accuracy of 1e-8 asks of its orbits; a hundred of them may add up.
LOCAL = 1e-4
# Where the flow's own multiplier is off by this, the others of the product are worth nothing.
LOST = 0.1
BIFURCATIONS = ("LP", "BP", "HB", "PD", "NS")
LIMITS = ("GR", "OC", "AZ")
STATUS = {
    **dict.fromkeys(("bound", "closed", "shrunk", "rejoined"), ("complete",)),
    **dict.fromkeys(("max_points", "stop_at", "homoclinic", "inadmissible", "event_lost"), ("stopped",)),
    **dict.fromkeys(("grazing", "order_change"), ("stopped", "complete")),
    "unbounded": ("complete", "stopped"),
    **dict.fromkeys(("step_too_small", "no_convergence", "not_finite", "plugin_error"), ("failed",)),
}
# A branch that leaves its Hopf point gets this far from it, in units of the states; or has moved the
# parameter by this part of the range, or the period by this part.
LEFT = 1e-3
# Orbits that look alike to this part of their size, and equilibria to this, are one.
ALIKE_ORBIT, ALIKE = 3e-3, 1e-6


@dataclass(frozen=True)
class Fault:
    """What does not hold, as a code, where, and a sentence."""

    code: str
    where: str
    text: str

    def __str__(self) -> str:
        return f"{self.code} at {self.where}: {self.text}"


@dataclass(frozen=True)
class Study:
    """What a run has left behind."""

    recipe: Recipe
    branches: list[Branch]
    notes: Mapping[str, str]
    code: int
    said: str
    warned: tuple[str, ...] = ()


def faults(study: Study, left_out: list[str] | None = None) -> Iterator[Fault]:
    """Everything that does not hold of a study; to `left_out` goes each row that no integration can check."""
    yield from _conduct(study)
    machine = Machine(study.recipe)
    looks: dict[str, list[Round]] = {}
    for branch in study.branches:
        yield from _ends(study, branch)
        yield from _counts_between(branch)
        if branch.info.problem == "equilibrium":
            yield from _equilibria(machine, branch)
        elif len(branch):
            try:
                looks[branch.name] = rounds(machine, branch)
                if left_out is not None:
                    left_out += [branch.name] * (len(branch) - len(looks[branch.name]))
            except Unchecked:
                yield Fault("unchecked", branch.name, "an independent integration was too long")
                continue
            yield from _orbits(branch, looks[branch.name])
    yield from _children(study, looks)
    yield from _known_twice(machine, study, looks)


# -- the run -------------------------------------------------------------------------------------------------


def _conduct(study: Study) -> Iterator[Fault]:
    """Exit code, what is printed, warnings."""
    for text in ("internal error", "Traceback", "Warning"):
        if text in study.said:
            yield Fault("internal", "run", study.said.strip()[-300:])
            return
    for warning in study.warned:
        yield Fault("warning", "run", warning[:300])
    failed = any(b.outcome.status == "failed" for b in study.branches)
    if study.code != int(failed):
        yield Fault("exit-code", "run", f"exit code {study.code}: {study.said.strip()[-200:]}")


# -- ends ----------------------------------------------------------------------------------------------------


def _ends(study: Study, branch: Branch) -> Iterator[Fault]:
    """Every direction has an end with a reason, and the reason is true."""
    name, outcome = branch.name, branch.outcome
    if outcome.status not in STATUS.get(outcome.reason, ()):
        yield Fault("reason", name, f"{outcome.status} with {outcome.reason}")
    if not outcome.message.rstrip().endswith((".", ".)")):
        yield Fault("message", name, f"no sentence: {outcome.message!r}")
    if not branch.complete:
        yield Fault("incomplete", name, "the branch is not complete in the database")
    if not len(branch):
        if outcome.status != "failed":
            yield Fault("empty", name, f"no points, and {outcome.reason}")
        return
    ends = [p for p in branch.special_points if p.label == "EP"]
    sides = {np.sign(p.s) for p in ends}
    around = any(p.kind == "closed" for p in ends)
    if not ends or (len(ends) < 2 and not around and not _one_sided(study, branch)):
        yield Fault("direction", name, f"{len(ends)} end for two directions: {outcome.message}")
    if len(ends) == 2 and len(sides) == 1 and sides != {0.0}:
        yield Fault("direction", name, "both ends are on one side")
    rows = branch.points
    for end in ends:
        row = rows[end.index]
        yield from _end(study, branch, end, row)
    s = rows["s"]
    if np.any(np.diff(s) < 0.0) or not np.any(s == 0.0):
        yield Fault("order", name, "rows are not in the order of arclength, or the start is missing")


def _one_sided(study: Study, branch: Branch) -> bool:
    """Orbits that are born at a Hopf point or at a period doubling leave it one way."""
    if branch.info.parent is None:
        return False
    return branch.info.origin.rpartition("/")[2].startswith(("HB", "PD", "GR", "OC"))


def _end(study: Study, branch: Branch, end: SpecialPoint, row: np.void) -> Iterator[Fault]:
    """An end point's own reason, against its row."""
    low, high = study.recipe.range
    lam, where = float(row["free"][0]), f"{branch.name}/{end.name}"
    reason = str(end.kind)
    if reason == "bound" and min(abs(lam - low), abs(lam - high)) > 1e-9 * (high - low):
        yield Fault("end", where, f"the end of the range is not at {lam}")
    if not low - 1e-9 <= lam <= high + 1e-9:
        yield Fault("end", where, f"{lam} lies outside the range")
    if reason == "max_points" and len(branch) < study.recipe.max_points:
        yield Fault("end", where, f"{len(branch)} points of {study.recipe.max_points}")
    if reason == "closed":
        start = branch.points[np.flatnonzero(branch["s"] == 0.0)[0]]
        apart = abs(lam - float(start["free"][0]))
        if branch.info.problem == "equilibrium":
            apart = max(apart, float(np.abs(row["state"] - start["state"]).max()))
        # The last point before the start is less than two of the longest steps away.
        if apart > 0.5:
            yield Fault("end", where, f"closed {apart:.3g} away from its start: {end.note}")


# -- counts --------------------------------------------------------------------------------------------------


def _counts_between(branch: Branch) -> Iterator[Fault]:
    """A count changes only where a special point says so, by what the point says."""
    at = {p.index: p for p in branch.special_points if p.label in (*BIFURCATIONS, *LIMITS)}
    rows = branch.points
    for i, (a, b) in enumerate(pairwise(rows)):
        before = at[i].unstable_after if i in at and a["special"] else int(a["unstable"])
        after = at[i + 1].unstable_before if i + 1 in at and b["special"] else int(b["unstable"])
        if before == after or None in (before, after):  # None is told where it is not known
            continue
        if branch.info.parent is not None and 0.0 in (a["s"], b["s"]):
            continue  # at the point that the branch was born at the count is its parent's
        if any((a["special"] and i in at) or (b["special"] and i + 1 in at) for _ in (0,)):
            where = at.get(i) or at.get(i + 1)
            yield Fault("count", f"{branch.name}/{where.name}", f"{before} unstable beside {after}")
        else:
            yield Fault(
                "count",
                branch.name,
                f"{before} -> {after} unstable at {a['free'][0]:.6g} .. {b['free'][0]:.6g}",
            )
        return


def _equilibria(machine: Machine, branch: Branch) -> Iterator[Fault]:
    rows, n = branch.points, len(branch.info.states)
    x, p = rows["state"].T, parameters_of(branch, rows)
    matrices = machine.jacobians(x, p)
    each = [
        {k: float(v[i]) if isinstance(v, np.ndarray) else v for k, v in p.items()} for i in range(len(rows))
    ]
    terms = np.array([machine.terms(row["state"], own) for row, own in zip(rows, each, strict=True)])
    for i, row in enumerate(rows):
        left = np.abs(machine.residual(row["state"], each[i]))
        moved = np.abs(matrices[i]) @ np.maximum(np.abs(row["state"]), row["weights"][:n])
        claimed = float(np.nan_to_num(row["error"], posinf=1.0)) * (np.abs(matrices[i]) @ row["weights"][:n])
        allowed = RESIDUAL * (terms[i] + moved) + claimed + 1e-290
        if np.any(left > allowed):
            yield Fault(
                "residual", branch.name, f"residual {left.max():.3g} at {row['free'][0]:.10g}, row {i}"
            )
            break
    if machine.recipe.family in WIDE:
        for text in miscounted(machine, rows, each):
            yield Fault("unstable", branch.name, text)
            break
    if machine.recipe.family == "ring":
        yield from _of_ring(machine.recipe, branch)
    if machine.recipe.family == "graded" or branch.info.settings.get("pins"):
        return  # the quotient's spectrum is another one
    scale = rows["weights"][:, :n]
    scaled = matrices / scale[:, :, None] * scale[:, None, :]
    # Where all entries vanish with the parameter, they are known as it is: to a rounding of its own size.
    vanishing = np.finfo(float).eps * float(np.linalg.norm(scaled, axis=(1, 2)).max())
    for i, values in enumerate(np.linalg.eigvals(matrices)):
        # Entries are rounded as the terms are that they are derivatives of, and known as well as the state.
        rounded = RESIDUAL * float(np.linalg.norm(terms[i] / scale[i]))
        doubt = CERTAIN * float(np.linalg.norm(scaled[i])) + rounded + vanishing
        least, most = int(np.sum(values.real > doubt)), int(np.sum(values.real >= -doubt))
        if not least <= rows["unstable"][i] <= most:
            yield Fault(
                "unstable",
                branch.name,
                f"{rows['unstable'][i]} stored, {least} to {most} by eigenvalues, row {i}",
            )
            break


def _of_ring(recipe: Recipe, branch: Branch) -> Iterator[Fault]:
    """At rest all units of a ring pass at lam = 2 c (1 - cos 2 pi k / N): their waves, in closed form."""
    if branch.info.parent is not None or branch.outcome.reason == "max_points":
        return
    units = recipe.states // (1 if "BP" in {p.label for p in branch.special_points} else 2)
    coupling = recipe.parameters["mu"]
    for k in range(units // 2 + 1):
        place = 2.0 * coupling * (1.0 - np.cos(2.0 * np.pi * k / units))
        near = [p for p in branch.special_points if abs(p.parameters["lam"] - place) < 1e-9]
        if place < recipe.range[1] and not near:
            yield Fault("lost", branch.name, f"wave {k} of {units} units passes at {place}")


def _orbits(branch: Branch, found: list[Round]) -> Iterator[Fault]:
    """Orbits close, and as many multipliers lie outside the unit circle as is stored."""
    for turn in found:
        row = branch.points[turn.row]
        allowed = (LOCAL + 1e3 * turn.rounding) * turn.growth + _claimed(row, turn)
        if not turn.gap <= allowed:
            yield Fault(
                "residual",
                branch.name,
                f"misses by {turn.gap:.2g} of {allowed:.2g} at {row['free'][0]:.10g}, row {turn.row}",
            )
            break
    for turn in found:
        if turn.multipliers is None:
            continue
        row = branch.points[turn.row]
        others, own_error = _without_own(branch, turn.multipliers)
        if own_error > LOST:
            continue
        moduli = np.abs(others)
        # An eigenvalue of a matrix that is off by d is off by sqrt(d) where two meet; the flow's own one,
        # which is 1, tells how well these are known where an event arrives with little rate.
        doubt = 3e-3 + np.sqrt((LOCAL + 1e3 * turn.rounding) * 1e-2) * max(turn.norm, 1.0)
        doubt += float(row["spectrum_error"]) + 10.0 * own_error
        least, most = int(np.sum(moduli > 1.0 + doubt)), int(np.sum(moduli >= 1.0 - doubt))
        if not least <= row["unstable"] <= most:
            yield Fault(
                "unstable",
                branch.name,
                f"{row['unstable']} stored, {least} to {most} by multipliers {np.round(turn.multipliers, 6)} "
                f"at {row['free'][0]:.10g}, row {turn.row}",
            )
            break


def _claimed(row: np.void, turn: Round) -> float:
    """What a row says that its states may be off by, in units of the half ranges that gaps are told in.

    A state that moves by a millionth of its weight is a constant to the steps of a branch.
    """
    weights, half = row["weights"][: len(turn.least)], (turn.most - turn.least) / 2
    units = np.where(half > 1e-12 * weights, half, weights)  # what stands still has its weight for a unit
    return float(np.nan_to_num(row["error"], nan=0.0, posinf=np.inf) * np.max(weights / units))


def _without_own(branch: Branch, values: np.ndarray) -> tuple[np.ndarray, float]:
    """Multipliers without the flow's own, the one nearest to one, of an autonomous machine; and how near."""
    count = branch.info.spectrum
    if len(values) <= count:
        return values, 0.0
    own = int(np.argmin(np.abs(values - 1.0)))
    return np.delete(values, own), float(abs(values[own] - 1.0))


# -- what leaves a point -------------------------------------------------------------------------------------


def _children(study: Study, looks: dict[str, list[Round]]) -> Iterator[Fault]:
    """What is followed has a branch, or a sentence why not; a branch that was born leaves its point."""
    generations = _generations(study.branches)
    for branch in study.branches:
        if generations[branch.name] >= study.recipe.depth:
            continue
        for point in branch.special_points:
            if point.label not in ("HB", "BP", "PD") or point.status != "located":
                continue
            if branch.info.parent is not None and abs(point.s) < 1e-9:
                continue
            where = f"{branch.name}/{point.name}"
            born = [b for b in study.branches if b.info.origin == where]
            told = any(where in text for text in study.notes.values()) or bool(point.note)
            if not born and not told:
                yield Fault(
                    "no-child",
                    where,
                    f"no branch and no note at {point.parameters.get(branch.info.free[0])}",
                )
            for child in born:
                yield from _leaves(study, child, point, looks)


def _generations(branches: list[Branch]) -> dict[str, int]:
    depth: dict[str, int] = {}
    for branch in branches:
        depth[branch.name] = 0 if branch.info.parent is None else depth[branch.info.parent[0]] + 1
    return depth


def _leaves(
    study: Study, child: Branch, point: SpecialPoint, looks: dict[str, list[Round]]
) -> Iterator[Fault]:
    """A cycle that was born at a Hopf point grows, or moves the parameter."""
    if point.label != "HB" or child.outcome.status == "failed":
        return
    low, high = study.recipe.range
    moved = np.abs(child["free"][:, 0] - point.unknowns[-1]).max() / (high - low)
    # Near a Bogdanov-Takens point a family lives in little of the parameter, and its period grows in it.
    born = float(child.points["period"][child.points["s"] == 0.0][0])
    moved = max(moved, np.abs(child.points["period"] / born - 1.0).max())
    size = 0.0
    for turn in looks.get(child.name, []):
        size = max(size, float(np.max(turn.most - turn.least)))
    edge = min(abs(point.unknowns[-1] - low), abs(point.unknowns[-1] - high)) / (high - low)
    if max(moved, size) < LEFT and edge > LEFT:
        yield Fault(
            "creeps",
            child.name,
            f"{len(child)} points, moved by {moved:.2g}, amplitude {size:.2g}: {child.outcome.message}",
        )


# -- branches that are told twice ----------------------------------------------------------------------------


def _known_twice(machine: Machine, study: Study, looks: dict[str, list[Round]]) -> Iterator[Fault]:
    for a, b in combinations(study.branches, 2):
        if a.info.problem != b.info.problem or min(len(a), len(b)) < 4:
            continue
        if a.info.problem == "equilibrium":
            share = max(_equal_equilibria(machine, a, b, image) for image in _images(machine, a))
        else:
            if not (looks.get(a.name) and looks.get(b.name)) or a.info.subharmonic != b.info.subharmonic:
                continue
            share = max(_equal_orbits(machine, a, b, looks, image) for image in _images(machine, a))
        if share > 0.5:
            yield Fault(
                "twice",
                b.name,
                f"{100 * share:.0f} % of its first points lie on {a.name}, or are images of its points",
            )


def _first(branch: Branch) -> np.ndarray:
    """The first rows on both sides of a start, but for that at which the branch was born.

    Farther on, a branch may run into one that had used up its points.
    """
    rows = branch.points
    regular = np.flatnonzero(~rows["special"] & (rows["s"] != 0.0))
    return regular[np.argsort(np.abs(rows["s"][regular]), kind="stable")][:7][1:]


def _images(machine: Machine, branch: Branch) -> list[np.ndarray]:
    n = len(branch.info.states)
    found = [np.eye(n)]
    if "image" in machine.recipe.functions:
        found.append(machine.written("image", 0.0, np.eye(n), {}))
    return found


def _equal_equilibria(machine: Machine, a: Branch, b: Branch, image: np.ndarray) -> float:
    """Share of the first rows of b that Newton's method finds on a's polygon at the same parameter."""
    rows, hits = b.points[_first(b)], 0
    for row in rows:
        x, lam = image @ row["state"], float(row["free"][0])
        hits += any(np.abs(y - x).max() < ALIKE * (1.0 + np.abs(x).max()) for y in _at(machine, a, lam, x))
    return hits / len(rows) if len(rows) else 0.0


def _at(machine: Machine, branch: Branch, lam: float, near: np.ndarray) -> Iterator[np.ndarray]:
    """Solutions of a branch at a parameter value, as far as its polygon comes near a state."""
    free, states = branch["free"][:, 0], branch.points["state"]
    inside = np.flatnonzero((free[:-1] - lam) * (free[1:] - lam) <= 0.0)
    for i in inside:
        width = free[i + 1] - free[i]
        share = 0.5 if width == 0.0 else (lam - free[i]) / width
        guess = states[i] + share * (states[i + 1] - states[i])
        step = np.abs(states[i + 1] - states[i]).max() + 1e-9
        if np.abs(guess - near).max() > step:
            continue
        p = {**branch.info.parameters, branch.info.free[0]: lam}
        x = guess.copy()
        for _ in range(5):
            matrix = machine.jacobians(x[:, None], p)[0]
            with np.errstate(all="ignore"):
                x = x - np.linalg.lstsq(matrix, machine.field(0.0, x, p), rcond=1e-12)[0]
        if np.abs(x - guess).max() <= step:
            yield x


def _equal_orbits(
    machine: Machine, a: Branch, b: Branch, looks: dict[str, list[Round]], image: np.ndarray
) -> float:
    """Share of the first rows of b whose period and extremes are those between two rows of a."""
    chosen = _first(b)
    turns = [t for t in looks[b.name] if t.row in chosen]
    hits = sum(_like(a, looks[a.name], t, float(b.points["free"][t.row, 0]), image) for t in turns)
    return hits / len(turns) if turns else 0.0


def _like(a: Branch, own: list[Round], turn: Round, lam: float, image: np.ndarray) -> bool:
    seen = np.abs(image)
    signs = image.sum(axis=1)
    least = np.where(signs > 0, seen @ turn.least, -(seen @ turn.most))
    most = np.where(signs > 0, seen @ turn.most, -(seen @ turn.least))
    look = np.concatenate([least, most, [turn.period]])
    size = np.concatenate([most - least, most - least, [turn.period]]) + 1e-6
    for u, v in pairwise(own):
        f, g = float(a.points["free"][u.row, 0]), float(a.points["free"][v.row, 0])
        if (f - lam) * (g - lam) > 0.0 or f == g:
            continue
        share = (lam - f) / (g - f)
        there = [np.concatenate([r.least, r.most, [r.period]]) for r in (u, v)]
        between = there[0] + share * (there[1] - there[0])
        if np.all(np.abs(between - look) <= ALIKE_ORBIT * size):
            return True
    return False
