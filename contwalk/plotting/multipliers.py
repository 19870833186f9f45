"""Multipliers of orbits in the complex plane along the branch, with the unit circle."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle

from contwalk.branch import ORBITS, Branch
from contwalk.plotting.full_orbits import full_orbits
from contwalk.plotting.multiplier_moduli import OTHER, draw_moduli, name_points
from contwalk.plotting.quantities import called
from contwalk.plotting.spectrum import SHADE, choose, draw_spectra, with_margin
from contwalk.plotting.style import INK, dress, new_axes, new_grid, title

FARTHEST = 3.0  # modulus that is still shown: beyond it the unit circle would shrink to a dot


# Branches that have panels of their own; more share theirs.
MOST_BRANCHES = 6


def plot_multiplier_panels(
    branches: Sequence[Branch],
    *,
    full: bool = False,
    together: bool = False,
    units: Mapping[str, str] | None = None,
    report: Callable[[str], None] = lambda text: None,
) -> list[Axes]:
    """Draw the multipliers of each branch in the plane and, beside it, their moduli over the parameter.

    Parameters
    ----------
    branches, units
        As for `plot_multipliers`. More than six branches share one pair of panels.
    full : bool
        Multipliers of full orbits, not of what is closed up to a symmetry.
    together : bool
        All branches share one pair of panels, however few there are.
    report : callable
        As for `plot_multiplier_moduli`.

    Returns
    -------
    list of Axes
        The plane and the moduli of the first branch, then those of the next one.

    Raises
    ------
    ContwalkError
        If no branch is one of orbits with a spectrum.
    """
    chosen = choose(branches, ORBITS, "multipliers", OTHER)
    chosen = [full_orbits(branch) for branch in chosen] if full else chosen
    apart = len(chosen) <= MOST_BRANCHES and not together
    groups = [[branch] for branch in chosen] if apart else [chosen]
    axes = new_grid("multiplier_panels", 2 * len(groups), 2)
    unnamed = []
    for number, group in enumerate(groups):
        plane, moduli = axes[2 * number : 2 * number + 2]
        plot_multipliers(group, plane, units=units)
        unnamed.append(draw_moduli(group, moduli, units=units))
        if len(chosen) > 1 and len(group) == 1:
            info = group[0].info
            text = called(chosen)[number] + (f", from {info.origin}" if info.origin else "")
            legend = plane.get_legend()
            lines = 0 if legend is None else -(-len(legend.get_texts()) // 2)
            title(plane, text, above=14.0 * lines)
    for number, figure in enumerate(unnamed):  # they move as long as panels are added; names do not move them
        name_points(figure, report, settled=number > 0)
    return axes


def plot_multipliers(
    branches: Sequence[Branch], ax: Axes | None = None, *, units: Mapping[str, str] | None = None
) -> Axes:
    """Draw the multipliers of branches of orbits, coloured by the free parameter.

    The unit circle is drawn strong, the unstable outside shaded. What lies beyond modulus 3 is left out and
    told in words, so that the circle stays visible. Starts and ends are marked as by `plot_eigenvalues`.

    Parameters
    ----------
    branches, ax, units
        As for `plot_eigenvalues`; branches of equilibria are left out.

    Returns
    -------
    Axes

    Raises
    ------
    ContwalkError
        If no branch is one of orbits with a spectrum.
    """
    chosen = choose(branches, ORBITS, "multipliers", OTHER)
    ax = ax or new_axes("multipliers")
    dress(ax, "real part", "imaginary part")
    numbers = draw_spectra(ax, chosen, units)
    ax.set_facecolor(SHADE)
    ax.add_patch(Circle((0, 0), 1.0, facecolor="white", edgecolor="none", zorder=0))
    ax.add_patch(Circle((0, 0), 1.0, fill=False, edgecolor=INK, linewidth=1.2, zorder=1, gid="unit-circle"))
    ax.axhline(0.0, color=INK, linewidth=0.4, zorder=1)
    ax.axvline(0.0, color=INK, linewidth=0.4, zorder=1)
    moduli = np.abs(numbers)
    # What lies beyond is seen to leave the figure.
    shown = numbers * np.minimum(1.0, FARTHEST / np.maximum(moduli, FARTHEST))
    both = {"x": shown.real, "y": shown.imag}
    air = 0.07
    if moduli.max(initial=0.0) > FARTHEST:
        air = 0.18  # for the words below the circle
        ax.text(
            0.98,
            0.02,
            f"moduli up to {moduli.max():.3g} lie outside",
            transform=ax.transAxes,
            ha="right",
            fontsize=8.5,
            color=INK,
            gid="outside",
        )
    # The circle and what is there: a square would be empty where the multipliers are real.
    ax.set(aspect="equal", **{f"{x}lim": with_margin(parts, [-1.0, 1.0], air) for x, parts in both.items()})
    return ax
