"""Phase planes of the stored points of a branch: nullclines, the field's way, equilibria and manifolds."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from contwalk.branch import Branch
from contwalk.errors import ContwalkError
from contwalk.explorer.packing import packed, predicted, short, varints
from contwalk.plotting.phase_plane import Plane
from contwalk.system import System
from contwalk.workflow.phase_plane import plane_of, window_about
from contwalk.workflow.stored.orbit_motions import Motion

# Points of the grid, and arrows, along each axis; how near to the window's size manifolds are.
PICTURE = {"grid": 97, "arrows": 24, "accuracy": 1e-6}
# Levels of a place within the window; of a direction within a turn, the last one for none.
LEVELS = {"place": 4096, "turn": 255}
# Points of a manifold within the width of the window, and of all of it.
POINTS = {"width": 128, "most": 512}


def planes_of(system: System, branch: Branch, motions: Sequence[Motion | None]) -> str:
    """The phase planes of all rows, packed; empty where the system has none.

    Parameters
    ----------
    system : System
    branch : Branch
    motions : sequence of Motion, one for each row
        None where nothing moves.
    """
    body, header, before = bytearray(), [], None
    everywhere = branch.points["state"][:, : len(system.states)]
    for row, motion in enumerate(motions):
        at_rest = branch.info.problem == "equilibrium"
        if motion is None and not at_rest:
            continue
        window = window_about(everywhere if motion is None else motion.states)
        parameters = {name: float(branch.parameters_at(row)[name]) for name in system.parameter_names}
        try:
            with np.errstate(all="ignore"):
                plane = plane_of(
                    system,
                    parameters,
                    system.state_names,
                    everywhere[row],
                    window,
                    points=int(PICTURE["grid"]),
                    accuracy=PICTURE["accuracy"],
                )
        except (ContwalkError, ArithmeticError, ValueError):  # a field that is not finite there
            continue
        field = _directions(plane)
        body += varints(predicted(field, before))
        before = field
        curves = _curves(plane)
        for _, curve in curves:
            body += varints(
                predicted(np.round(LEVELS["place"] * _within(curve, window)).astype(np.int64), None)
            )
        rests = [[*short(rest.place), rest.stable] for rest in plane.rests]
        shown = [[kind, len(curve)] for kind, curve in curves]
        header.append({"row": row, "window": short(window.ravel()), "curves": shown, "rests": rests})
    told: dict[str, Any] = {**LEVELS, "arrows": PICTURE["arrows"], "planes": header}
    return packed(told, bytes(body)) if header else ""


def _within(curve: np.ndarray, window: np.ndarray) -> np.ndarray:
    """Places of a curve (k, 2) in parts of the window, (2, 2)."""
    return np.asarray((curve - window[:, 0]) / (window[:, 1] - window[:, 0]))


def _directions(plane: Plane) -> np.ndarray:
    """The way of the field on the paper as whole numbers, shape (a**2, 1), a line of arrows after the
    other from below.
    """
    across, up = (
        np.linspace(0, len(values) - 1, int(PICTURE["arrows"])).astype(int) for values in (plane.x, plane.y)
    )
    rates = plane.rates[np.ix_(up, across)] / np.array([np.ptp(plane.x), np.ptp(plane.y)])
    turns = np.arctan2(rates[..., 1], rates[..., 0]) / (2.0 * np.pi) % 1.0
    found = np.where(
        np.isfinite(rates).all(axis=-1), np.round(LEVELS["turn"] * turns) % LEVELS["turn"], LEVELS["turn"]
    )
    return found.astype(np.int64).reshape(-1, 1)


def _curves(plane: Plane) -> list[tuple[str, np.ndarray]]:
    """Nullclines of both states, then manifolds: what each is, and its points (k, 2)."""
    found = [(f"null{k}", curve) for k, curves in enumerate(plane.nullclines) for curve in curves]
    size = np.array([np.ptp(plane.x), np.ptp(plane.y)])
    for curve, unstable in plane.manifolds:
        way = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(curve, axis=0) / size, axis=1)))
        count = int(min(POINTS["most"], POINTS["width"] * way[-1] + 2))
        at = np.linspace(0.0, way[-1], count)
        even = np.stack([np.interp(at, way, column) for column in curve.T], axis=1)
        found.append(("out" if unstable else "in", even))
    return found
