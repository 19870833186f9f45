"""A branch for libraries that are not needed otherwise: pandas, xarray, and matplotlib by the package's door.

A branch knows nothing of what draws it. So its method asks, when it is called, what users ask.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

from contwalk.errors import ContwalkError


def as_axes(branch: Any, *where: Any, **options: Any) -> Any:
    """The branch as `cw.plot_bifurcation_diagram` draws it, or `cw.plot_locus` a curve in two parameters."""
    door = import_module("contwalk")
    drawn = door.plot_bifurcation_diagram if len(branch.info.free) < 2 else door.plot_locus
    return drawn([branch], *where, **options)


def as_pandas(branch: Any) -> Any:
    """`branch.columns()` as a `pandas.DataFrame`; `ContwalkError` if pandas is not installed."""
    return _library("pandas").DataFrame(branch.columns())


def as_xarray(branch: Any) -> Any:
    """The branch as an `xarray.Dataset`; `ContwalkError` if xarray is not installed.

    `columns()` over `point`, of which the arclength `s` and `special_point` are coordinates; `spectrum`,
    complex, over `point` and `number`; parameters, the problem and how it ended as attributes.
    """
    over, parts = ("s", "special_point"), ("re", "im")
    spectral = {f"{part}_{number + 1}" for part in parts for number in range(branch.info.spectrum)}
    columns = {name: ("point", values) for name, values in branch.columns().items() if name not in spectral}
    return _library("xarray").Dataset(
        {name: column for name, column in columns.items() if name not in over}
        | {"spectrum": (("point", "number"), branch.points["spectrum"])},
        coords={name: columns[name] for name in over},
        attrs={
            "branch": branch.name,
            "problem": branch.info.problem_by_name,
            "free": list(branch.info.free),
            **{f"parameter_{name}": value for name, value in branch.info.parameters.items()},
            "status": branch.outcome.status,
            "reason": branch.outcome.reason,
        },
    )


def _library(name: str) -> Any:
    try:
        return import_module(name)
    except ImportError as error:
        raise ContwalkError(
            f"A branch for {name} needs {name}, which is not installed.",
            f"Install it with: pip install {name}. Or write CSV files with: contwalk export DB --csv DIR",
        ) from error
