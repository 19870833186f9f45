"""Branches written down by hand from closed forms, as the driver would store them."""

from __future__ import annotations

import numpy as np

from contwalk.branch import Branch, BranchInfo, Outcome, SpecialPoint, named


def branch(
    columns: dict[str, np.ndarray],
    *,
    free: tuple[str, ...] = ("mu",),
    states: tuple[str, ...] = ("x",),
    observables: tuple[str, ...] = (),
    spectrum: np.ndarray | None = None,
    unstable=0,
    admissible=True,
    special: tuple[SpecialPoint, ...] = (),
    name: str = "b1",
    problem: str = "equilibrium",
    parameters: dict[str, float] | None = None,
    s: np.ndarray | None = None,
    parent: tuple[str, float] | None = None,
) -> Branch:
    """A branch with these columns by name; special points get their rows by `s`, as `named` gives them."""
    k = len(next(iter(columns.values())))
    spectrum = np.full((k, 0), np.nan, dtype=complex) if spectrum is None else spectrum
    info = BranchInfo(
        name=name,
        problem=problem,
        states=states,
        observables=observables,
        free=free,
        parameters={**dict.fromkeys(free, 0.0), **(parameters or {})},
        unknowns=len(states),
        spectrum=spectrum.shape[1],
        parent=parent,
    )
    points = np.zeros(k, dtype=info.point_dtype())
    points["s"] = np.arange(k, dtype=float) if s is None else s
    points["period"] = np.nan
    for column, names in (("free", free), ("state", states), ("observables", observables)):
        for i, each in enumerate(names):
            points[column][:, i] = columns[each]
    points["spectrum"] = spectrum
    points["unstable"] = unstable
    points["stable"] = points["unstable"] == 0
    points["admissible"] = admissible
    records = named(list(special), points)
    for record in records:
        if record.index < k and points["s"][record.index] == record.s:
            points["special"][record.index] = True
    return Branch(info, points, records, Outcome("complete", "bound", "Done."))


def pitchfork() -> list[Branch]:
    """x' = mu x - x^3: the trivial branch, with BP at mu = 0 on row 20, and x = +-sqrt(mu)."""
    mu = np.linspace(-1, 1, 41)
    special = (
        SpecialPoint("EP", 0.0),
        SpecialPoint("BP", 20.0, kind="pitchfork", unstable_before=0, unstable_after=1),
        SpecialPoint("EP", 40.0, unstable_before=1, unstable_after=1),
    )
    # Rounding decides the count of the special row itself; here it says unstable.
    trivial = branch({"mu": mu, "x": 0 * mu}, unstable=(mu >= 0).astype(int), special=special)
    a = np.linspace(-1, 1, 41)
    end = (SpecialPoint("EP", 0.0), SpecialPoint("EP", 40.0))
    forked = branch({"mu": a**2, "x": a}, special=end, name="b2")
    return [trivial, forked]


def fold() -> Branch:
    """x' = mu + x^2: mu = -x^2, stable for x < 0, LP at row 30."""
    x = np.linspace(-1.5, 1.0, 51)
    special = (SpecialPoint("LP", 30.0, unstable_before=0, unstable_after=1),)
    return branch({"mu": -(x**2), "x": x}, unstable=(x > 1e-9).astype(int), special=special, name="b1")


def hopf(name: str = "b1", c: float = 1.0) -> Branch:
    """Linear part with the eigenvalues mu +- i c and -2: HB at mu = 0, row 30."""
    mu = np.linspace(-1.5, 1.0, 51)
    spectrum = np.stack([mu + 1j * c, mu - 1j * c, np.full_like(mu, -2.0) + 0j], axis=1)
    return branch(
        {"mu": mu, "x": np.sin(mu), "y": np.cos(mu), "amplitude": 0.2 + mu**2, "max_re": mu},
        states=("x", "y"),
        observables=("max_re", "amplitude"),
        spectrum=spectrum,
        unstable=2 * (mu > 1e-9),
        special=(SpecialPoint("HB", 30.0, unstable_before=0, unstable_after=2),),
        name=name,
        parameters={"c": c},
    )
