"""What accuracy costs, point by point: a panel for each integrator, a line for each special point."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from matplotlib.axes import Axes
from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, NullLocator

from contwalk.errors import ContwalkError
from contwalk.plotting.style import GREY, INK, new_panels, title
from contwalk.plotting.tradeoff import plot_tradeoff

Pairs = Sequence[tuple[float, float]]


def plot_tradeoff_panels(
    panels: Mapping[str, Mapping[str, Pairs]],
    asked: Mapping[str, Pairs],
    *,
    doubt: float = 0.0,
    xlabel: str = "CPU time (s)",
    ylabel: str = "true relative error",
) -> list[Axes]:
    """Draw time against true error, a panel for each integrator.

    Parameters
    ----------
    panels : mapping
        Name of an integrator to names of special points, each with pairs (time, true error).
    asked : mapping
        Name of an integrator to pairs (time, accuracy asked for): a grey line; below it the promise is kept.
    doubt : float
        Errors below it are not told apart from the truth's own: the region is shaded.
    xlabel, ylabel : str

    Raises
    ------
    ContwalkError
        If there is no panel, or one without a point.
    """
    if not panels:
        raise ContwalkError("There is nothing to draw.", "Give the points of one integrator at least.")
    axes = new_panels("tradeoff", len(panels))
    for ax, (name, series) in zip(axes, panels.items(), strict=True):
        times, accuracies = zip(*asked[name], strict=True) if asked.get(name) else ((), ())
        ax.plot(
            times,
            accuracies,
            color=GREY,
            linestyle=(0, (4.0, 2.0)),
            marker="_",
            markersize=9.0,
            linewidth=1.0,
            label="asked for",
            zorder=1.8,
            gid=f"asked-{name}",
        )
        plot_tradeoff(series, ax, xlabel=xlabel if ax is axes[-1] else "", ylabel=ylabel)
        for at, accuracy in zip(times, accuracies, strict=True):
            text = f"{accuracy:.0e}".replace("e-0", "e-")
            ax.annotate(
                text,
                (at, accuracy),
                xytext=(0, 6),
                textcoords="offset points",
                ha="center",
                fontsize=7.5,
                color=INK,
            )
        title(ax, name)
    _common_limits(axes)
    _plain_times(axes)
    if doubt > 0.0:
        for ax in axes:
            low, _ = ax.get_ylim()
            ax.axhspan(low, max(doubt, low), color="#F0F0F0", zorder=0, gid="doubt")
    return axes


def _plain_times(axes: Sequence[Axes]) -> None:
    """Seconds as plain numbers; times often span less than a decade."""
    low, high = axes[0].get_xlim()
    for ax in axes:
        ax.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)) if high > 10.0 * low else MaxNLocator(6))
        ax.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        ax.xaxis.set_minor_locator(NullLocator())


def _common_limits(axes: Sequence[Axes]) -> None:
    """The same scales in all panels, so that they can be compared."""
    xs, ys = zip(*[(ax.get_xlim(), ax.get_ylim()) for ax in axes], strict=True)
    for ax in axes:
        ax.set_xlim(min(x[0] for x in xs), max(x[1] for x in xs))
        ax.set_ylim(min(y[0] for y in ys), max(y[1] for y in ys))
