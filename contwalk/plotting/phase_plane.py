"""The phase plane: where each rate is zero, the way of the field, equilibria and their manifolds, orbits."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from contwalk.plotting.phase_portrait import STABLE, UNSTABLE
from contwalk.plotting.quantities import axis_label
from contwalk.plotting.style import GREY, INK, PALETTE, dress, legend_beside, light, new_axes

# Manifolds, by whether they are unstable.
MANIFOLD: dict[bool, dict[str, Any]] = {True: {**STABLE, "color": INK}, False: {**UNSTABLE, "color": INK}}


@dataclass(frozen=True, eq=False)
class Rest:
    """An equilibrium of the plane.

    Parameters
    ----------
    place : ndarray, shape (2,)
    eigenvalues : ndarray, shape (2,)
    slopes : ndarray, shape (2, 2)
        The Jacobian there.
    """

    place: np.ndarray
    eigenvalues: np.ndarray
    slopes: np.ndarray

    @property
    def stable(self) -> bool:
        """Whether both eigenvalues are left of the imaginary axis."""
        return bool(np.all(self.eigenvalues.real < 0))

    @property
    def saddle(self) -> bool:
        """Whether one is left of it, and the other right."""
        return bool(np.prod(np.sign(self.eigenvalues.real)) < 0)


@dataclass(frozen=True, eq=False)
class Plane:
    """What is drawn.

    Parameters
    ----------
    names : pair of str
        The states.
    x, y : ndarray, shapes (k,) and (m,)
        Values of the grid.
    rates : ndarray, shape (m, k, 2)
        The rates of both states there; NaN where there are none.
    nullclines : pair of list of ndarray
        Curves on which a rate is zero, each of shape (q, 2), of both rates.
    rests : tuple of Rest
    manifolds : tuple of (ndarray, bool)
        Curves, shape (q, 2), and whether they are unstable ones.
    """

    names: tuple[str, ...]
    x: np.ndarray
    y: np.ndarray
    rates: np.ndarray
    nullclines: tuple[list[np.ndarray], ...]
    rests: tuple[Rest, ...]
    manifolds: tuple[tuple[np.ndarray, bool], ...]


def plot_phase_plane(
    plane: Plane,
    orbits: Sequence[np.ndarray] = (),
    ax: Axes | None = None,
    *,
    stable: Sequence[bool] = (),
    units: Mapping[str, str] | None = None,
    arrows: int = 20,
) -> Axes:
    """Draw a phase plane.

    Parameters
    ----------
    plane : Plane
    orbits : sequence of arrays of shape (k, 2)
        Closed orbits at the same parameters.
    ax : Axes, optional
    stable : sequence of bool
        Whether each orbit is.
    units : mapping, optional
        Units by name, as from `units_of(system)`.
    arrows : int
        Of the field, along each axis.
    """
    ax = ax or new_axes("phase_portrait")
    dress(ax, *(axis_label(name, units) for name in plane.names))
    _draw_field(ax, plane, arrows)
    handles: dict[str, Line2D] = {}  # one of each name
    look: dict[str, Any]
    for number, name in enumerate(plane.names):
        look = {**STABLE, "color": PALETTE[number]}
        for curve in plane.nullclines[number]:
            ax.plot(*curve.T, gid=f"nullcline-{number}", zorder=2, **look)
            _enter(handles, f"{name} rests", look)
    for curve, unstable in plane.manifolds:
        ax.plot(*curve.T, gid="manifold", zorder=2.5, **MANIFOLD[unstable])
    for unstable, words in ((True, "unstable manifold"), (False, "stable manifold")):
        if any(which is unstable for _, which in plane.manifolds):
            _enter(handles, words, MANIFOLD[unstable])
    for number, curve in enumerate(orbits):
        look = {
            "color": PALETTE[2],
            "linewidth": 1.9,
            "linestyle": "-" if stable[number] else "--",
        }
        ax.plot(*curve.T, gid=f"orbit-{number}", zorder=3, **look)
        _enter(handles, "stable orbit" if stable[number] else "unstable orbit", look)
    for rest in plane.rests:
        look = {"marker": "o", "color": INK, "markersize": 5.0, "linestyle": "none"}
        look["fillstyle"] = "full" if rest.stable else "none"
        ax.plot(*rest.place[:, None], gid="equilibrium", zorder=4, **look)
        _enter(handles, "stable equilibrium" if rest.stable else "unstable equilibrium", look)
    ax.set_xlim(plane.x[0], plane.x[-1])
    ax.set_ylim(plane.y[0], plane.y[-1])
    if handles:
        legend_beside(ax, list(handles.values()))
    return ax


def _enter(handles: dict[str, Line2D], words: str, look: Mapping[str, Any]) -> None:
    """Enter a look into a legend, once."""
    handles.setdefault(words, Line2D([], [], label=words, **look))


def _draw_field(ax: Axes, plane: Plane, number: int) -> None:
    """Arrows of one length on the paper: a picture of directions."""
    thin = [np.linspace(0, len(values) - 1, number).astype(int) for values in (plane.x, plane.y)]
    rates = plane.rates[np.ix_(thin[1], thin[0])]
    size = np.array([np.ptp(plane.x), np.ptp(plane.y)])
    with np.errstate(all="ignore"):
        way = rates / size / np.linalg.norm(rates / size, axis=-1, keepdims=True) * size
    ax.quiver(
        plane.x[thin[0]],
        plane.y[thin[1]],
        *np.moveaxis(way, -1, 0),
        angles="xy",
        scale_units="xy",
        scale=1.5 * number,
        pivot="mid",
        width=0.0022,
        color=light(GREY, 0.4),
        gid="field",
        zorder=1,
    )
