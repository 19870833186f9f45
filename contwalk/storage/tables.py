"""A run as tables: CSV files, and a pandas table of one branch."""

from __future__ import annotations

import csv
import json
from collections.abc import Iterable, Mapping, Sequence
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from contwalk.branch import Branch
from contwalk.errors import ContwalkError
from contwalk.storage.database import Database
from contwalk.storage.document import document
from contwalk.storage.failures import explained


def write_tables(db: Database, directory: str | Path) -> list[Path]:
    """Write `branches.csv`, `special_points.csv` and one table per branch, such as `b1.csv`.

    The directory is made where missing; tables of these names in it are replaced. Floats are written with as
    many digits as reading them back exactly needs.

    Returns
    -------
    list of Path
        The files written.

    Raises
    ------
    DatabaseError
        If the directory or a file cannot be written.
    """
    directory = Path(directory)
    described = document(db)["branches"]
    try:
        directory.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise explained(directory, "create", error) from error
    written = [
        _write(directory / "branches.csv", *_table(map(_branch_row, described))),
        _write(directory / "special_points.csv", *_table(_special_rows(described))),
    ]
    for name in db.branch_names():
        columns = branch_columns(db.branch(name))
        rows = zip(*(column.tolist() for column in columns.values()), strict=True)
        written.append(_write(directory / f"{name}.csv", list(columns), rows))
    return written


def branch_columns(branch: Branch) -> dict[str, np.ndarray]:
    """The columns of a branch by name, one entry a point.

    Free parameters, observables and states have their own names. One whose name is taken already gets the
    kind in front, such as `state_period`. Eigenvalues or multipliers are `re_1`, `im_1`, `re_2`, ...
    """
    columns = {"s": branch.points["s"], "special_point": _names_by_row(branch)}
    own = [name for name in branch.points.dtype.names or () if branch.points.dtype[name].shape == ()]
    taken = {*own, "special_point"}
    for column, names in (
        ("free", branch.info.free),
        ("observables", branch.info.observables),
        ("state", branch.info.states),
    ):
        for position, name in enumerate(names):
            name = name if name not in taken else f"{column}_{name}"
            taken.add(name)
            columns[name] = branch.points[column][:, position]
    for position in range(branch.info.spectrum):
        columns[f"re_{position + 1}"] = branch.points["spectrum"][:, position].real
        columns[f"im_{position + 1}"] = branch.points["spectrum"][:, position].imag
    return columns | {name: branch.points[name] for name in own}


def to_pandas(branch: Branch) -> Any:
    """The columns of a branch as a `pandas.DataFrame`.

    Raises
    ------
    ContwalkError
        If pandas is not installed.
    """
    try:
        pandas = import_module("pandas")
    except ImportError as error:
        raise ContwalkError(
            "A branch as a pandas table needs pandas, which is not installed.",
            "Install it with: pip install pandas. Or write CSV files with: contwalk export DB --csv DIR",
        ) from error
    return pandas.DataFrame(branch_columns(branch))


def _names_by_row(branch: Branch) -> np.ndarray:
    """Names of the special points in the rows they have, separated by a space where they share one."""
    names = [""] * len(branch)
    for point in branch.special_points:
        if point.index < len(names):
            names[point.index] = f"{names[point.index]} {point.name}".strip()
    return np.array(names, dtype=object)


def _branch_row(entry: Mapping[str, Any]) -> dict[str, Any]:
    row = {key: value for key, value in entry.items() if key not in ("special_points", "cost")}
    for key in ("free", "signature"):
        row[key] = " ".join(entry[key] or ())
    return row | {key: entry["cost"][key] for key in ("seconds", "rhs")}


def _special_rows(described: Sequence[Mapping[str, Any]]) -> Iterable[dict[str, Any]]:
    for entry in described:
        for point in entry["special_points"]:
            row = {"branch": entry["name"]}
            for key, value in point.items():
                if key in ("parameters", "state"):
                    row |= {f"{key}.{name}": number for name, number in value.items()}
                elif isinstance(value, list | dict):
                    row[key] = json.dumps(value)
                else:
                    row[key] = value
            yield row


def _table(rows: Iterable[Mapping[str, Any]]) -> tuple[list[str], list[list[Any]]]:
    """Header and rows of a table whose rows may lack columns that others have."""
    rows = list(rows)
    header = list(dict.fromkeys(key for row in rows for key in row))
    return header, [[row.get(key) for key in header] for row in rows]


def _write(path: Path, header: Sequence[str], rows: Iterable[Sequence[Any]]) -> Path:
    try:
        with path.open("w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(header)
            writer.writerows([_cell(value) for value in row] for row in rows)
    except OSError as error:
        raise explained(path, "create", error) from error
    return path


def _cell(value: Any) -> Any:
    if isinstance(value, bool):
        return "true" if value else "false"
    return repr(value) if isinstance(value, float) else value
