"""Which branches of two databases are the same, by what they are and not by name.

Branches of one kind (problem, free parameters, closure, events, what is followed) are laid beside each other
as curves. What lies on each other belongs together, however it is cut into pieces and whichever way it was
walked. What is left is compared by what no symmetry changes; and what is still left, by how it began.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Sequence
from dataclasses import dataclass
from itertools import chain

import numpy as np

from contwalk.branch import ORBITS, Branch
from contwalk.comparing.curve import BESIDE, Curve, Foot, leading, place_names, scale_of
from contwalk.signatures import told_problem

CURVE, IMAGE, BEGINNING = "curve", "image", "beginning"
# So many rows of one branch on another one are no crossing.
ENOUGH = 3


@dataclass(frozen=True)
class Family:
    """Branches of A and those of B that are the same.

    Parameters
    ----------
    a, b : tuple of Branch
    by : str
        `CURVE`: they lie on each other; `IMAGE`: parameters, periods and leading eigenvalues do, states do
        not; `BEGINNING`: they begin alike, and go another way.
    """

    a: tuple[Branch, ...]
    b: tuple[Branch, ...]
    by: str = CURVE

    def curves(self) -> tuple[list[Curve], list[Curve]]:
        """The branches of A and of B as curves in what they are told apart by."""
        names = names_of(self.a + self.b, self.by == IMAGE)
        names += tuple(sorted(set(_told_apart(self.a) + _told_apart(self.b)) - set(names)))
        scale = scale_of(self.a + self.b, names)
        return [Curve(x, names, scale) for x in self.a], [Curve(x, names, scale) for x in self.b]


def _told_apart(branches: Sequence[Branch]) -> tuple[str, ...]:
    """Parameters that are constant along branches of one database and not alike in all: lines of a chart."""
    values = [branch.info.parameters for branch in branches]
    held = set(values[0]).difference(*(branch.info.free for branch in branches)) if values else set()
    return tuple(name for name in held if len({own.get(name) for own in values}) > 1)


def kind_of(branch: Branch) -> Hashable:
    """What branches have in common that can be the same."""
    info = branch.info
    # A signature begins where the run says, and may begin anywhere: its events are counted.
    events = tuple(sorted(info.signature)) if info.signature is not None else None
    of = info.settings.get("of"), info.settings.get("of_problem")
    return info.problem, frozenset(info.free), info.closure, events, info.subharmonic, of


def _may_be(branch: Branch) -> Hashable:
    """What branches of different models have in common that are laid beside each other."""
    info = branch.info
    return info.problem, frozenset(info.free), info.settings.get("of"), info.settings.get("of_problem")


def names_of(branches: Sequence[Branch], image: bool = False) -> tuple[str, ...]:
    """The columns in which branches are compared; those that no symmetry changes for images."""
    names = place_names(branches)
    if not image:
        return names
    free = set(branches[0].info.free)
    return tuple(name for name in names if name in free or name == "period")


def families(a: Sequence[Branch], b: Sequence[Branch]) -> tuple[list[Family], list[Branch], list[Branch]]:
    """Branches that are the same, and those that only A and only B has."""
    a, b = [x for x in a if len(x)], [x for x in b if len(x)]
    found: list[Family] = []
    kinds = list(dict.fromkeys(kind_of(x) for x in a))
    for kind in kinds:
        of_a, of_b = [x for x in a if kind_of(x) == kind], [x for x in b if kind_of(x) == kind]
        if of_b:
            found += _together(of_a, of_b, CURVE)
    for kind in kinds:
        of_a = [x for x in _left(a, found, "a") if kind_of(x) == kind]
        of_b = [x for x in _left(b, found, "b") if kind_of(x) == kind]
        if of_a and of_b:
            found += _together(of_a, of_b, IMAGE)
    for x in _left(a, found, "a"):
        alike = [y for y in _left(b, found, "b") if _may_be(y) == _may_be(x) and _begun(x, y, found)]
        alike.sort(key=lambda y: kind_of(y) != kind_of(x))
        if alike:
            found.append(Family((x,), (alike[0],), BEGINNING))
    order = {x.name: k for k, x in enumerate(a)}
    found.sort(key=lambda family: min(order[x.name] for x in family.a))
    return found, _left(a, found, "a"), _left(b, found, "b")


def _left(branches: Iterable[Branch], found: Sequence[Family], side: str) -> list[Branch]:
    taken = {x.name for x in chain.from_iterable(getattr(family, side) for family in found)}
    return [x for x in branches if x.name not in taken]


def _together(a: Sequence[Branch], b: Sequence[Branch], by: str) -> list[Family]:
    """Connected groups of branches that lie on each other."""
    curves = Family(tuple(a), tuple(b), by).curves()
    pairs = [
        (i, j)
        for i, x in enumerate(curves[0])
        for j, y in enumerate(curves[1])
        if _lie_on(x, y, by) or _lie_on(y, x, by)
    ]
    found = []
    while pairs:
        left, right = {pairs[0][0]}, {pairs[0][1]}
        while more := [p for p in pairs if p[0] in left or p[1] in right]:
            left.update(i for i, _ in more)
            right.update(j for _, j in more)
            pairs = [p for p in pairs if p not in more]
        found.append(Family(tuple(a[i] for i in sorted(left)), tuple(b[j] for j in sorted(right)), by))
    return found


def _lie_on(x: Curve, y: Curve, by: str) -> bool:
    """Whether enough rows of one curve lie on another; of images their leading eigenvalues do as well."""
    own = leading(x.branch)
    count = 0
    needed = min(ENOUGH, len(x))
    for node in range(len(x)):
        row = x.rows[node]
        if not y.may_hold(x.values[row]):
            continue
        foot = y.foot(x.values[row])
        if foot.on and (by == CURVE or _same_lead(y, foot, own[row])):
            count += 1
            if count >= needed:
                return True
    return False


def _same_lead(curve: Curve, foot: Foot, value: float) -> bool:
    if not np.isfinite(value):
        return True
    there, spread = curve.at(curve.lead, foot.segment, foot.t)
    size = max(float(np.ptp(curve.lead)), abs(value))
    return abs(float(there) - value) <= float(spread) + BESIDE**2 * size


def _begun(x: Branch, y: Branch, found: Sequence[Family]) -> bool:
    """Whether two branches of one kind began alike: from a start, or at a point of the same label."""
    if (x.info.parent is None) != (y.info.parent is None):
        return False
    if x.info.parent is None or y.info.parent is None:
        return True
    parents = x.info.parent[0], y.info.parent[0]
    return any(
        parents[0] in [each.name for each in family.a] and parents[1] in [each.name for each in family.b]
        for family in found
    )


def described(branch: Branch) -> str:
    """What a branch is, in words: `periodic orbit over delta, 0.003 to 0.0061, 64 points, from b1`."""
    info = branch.info
    said = [told_problem(info.problem_by_name)]
    if info.settings.get("of"):
        said[0] = f"curve of {info.settings['of']} of {str(info.settings['of_problem']).replace('_', ' ')}"
    if info.closure not in (None, "full"):
        said[0] += f" closed by {info.closure}"
    if info.subharmonic != 1:
        said[0] += f" of {info.subharmonic} periods"
    if info.signature:
        said[0] += f" with {len(info.signature)} events"
    for name in info.free:
        values = branch[name]
        said.append(f"{name} from {values.min():.6g} to {values.max():.6g}" if len(values) else name)
    said.append(f"{len(branch)} point{'' if len(branch) == 1 else 's'}")
    if info.problem in ORBITS and len(branch):
        said.append(f"period {np.nanmin(branch['period']):.6g} to {np.nanmax(branch['period']):.6g}")
    begun = f"begun at s = {info.parent[1]:.6g} of {info.parent[0]}" if info.parent else info.origin
    return ", ".join([*said, begun] if begun else said)
