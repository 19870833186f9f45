"""The root locus: eigenvalues of equilibria in the complex plane along the branch."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from matplotlib.axes import Axes

from contwalk.branch import Branch
from contwalk.plotting.spectrum import SHADE, choose, draw_spectra, every_spectrum
from contwalk.plotting.style import INK, dress, new_axes
from contwalk.plotting.wide_axis import scale


def plot_eigenvalues(
    branches: Sequence[Branch], ax: Axes | None = None, *, units: Mapping[str, str] | None = None
) -> Axes:
    """Draw the eigenvalues of branches of equilibria, coloured by the free parameter.

    A cross marks the start of each branch and a ring its end; on a branch walked both ways from its start
    these are its ends in the order of growing `s`. The imaginary axis is drawn strong, the unstable
    half-plane shaded. Where eigenvalues differ widely in size, as those of stiff machines do, an axis is
    linear near zero and logarithmic beyond.

    Parameters
    ----------
    branches : sequence of Branch
        Branches of orbits are left out: they have multipliers.
    ax : Axes, optional
        Where to draw; new axes by default.
    units : mapping, optional
        Units by name, as from `units_of(system)`, for the colour bar.

    Raises
    ------
    ContwalkError
        If no branch is one of equilibria with a spectrum.
    """
    chosen = choose(branches, ("equilibrium",), "eigenvalues", "for orbits use the figure `multipliers`")
    ax = ax or new_axes("eigenvalues")
    dress(ax, "real part", "imaginary part")
    draw_spectra(ax, chosen, units)
    found = every_spectrum(chosen)
    _, right = scale(ax, "x", found.real)
    scale(ax, "y", found.imag)
    ax.axvspan(0.0, right, color=SHADE, linewidth=0, zorder=0)
    ax.axvline(0.0, color=INK, linewidth=1.2, zorder=1, gid="imaginary-axis")
    ax.axhline(0.0, color=INK, linewidth=0.4, zorder=1)
    return ax
