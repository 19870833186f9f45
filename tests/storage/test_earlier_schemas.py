"""Databases that an earlier version of contwalk has written are read, and gone on with."""

from __future__ import annotations

import gzip
from pathlib import Path

import h5py
import numpy as np
import pytest

import contwalk as cw
from contwalk.branch import BranchInfo, SpecialPoint
from contwalk.errors import DatabaseError
from contwalk.storage.schema import (
    LABEL,
    SCHEMA_VERSION,
    special_from_text,
    special_record,
    special_record_dtype,
)

# Written by contwalk when its schema version was 1, from these two files.
WRITTEN = Path(__file__).parent / "version_1.h5.gz"
PLUGIN = '''"""A fold and its image."""

from contwalk.system import Mode, Parameter, State, System


def field(t, x, p, dx):
    dx[0] = p.a + x[0] - x[0] ** 3


SYSTEM = System("cubic", states=(State("x"),), parameters=(Parameter("a", -1.0),), modes=(Mode("only", field),))
'''  # noqa: E501 - as it was
RUN_FILE = """system: ./cubic.py
start: {state: {x: -1.3}}
continue: {parameter: a, range: [-2, 2], max_points: 40}
mark: {a: [-0.5]}
output: version_1.h5
"""


@pytest.fixture
def written(tmp_path) -> Path:
    (tmp_path / "cubic.py").write_text(PLUGIN)
    (tmp_path / "cubic.yaml").write_text(RUN_FILE)
    path = tmp_path / "version_1.h5"
    path.write_bytes(gzip.decompress(WRITTEN.read_bytes()))
    return path


def schema_version(path: Path) -> int:
    with h5py.File(path) as file:
        return int(file.attrs["schema_version"])


def test_a_database_of_version_1_is_read(written) -> None:
    before = written.read_bytes()
    assert schema_version(written) == 1
    with cw.open_database(written) as db:
        branch = db.branch("b1")
    assert [point.name for point in branch.special_points] == ["EP1", "UZ1", "EP2"]
    assert branch.special("UZ1").parameters["a"] == -0.5
    x = branch["x"]
    np.testing.assert_allclose(branch["a"], x**3 - x, atol=1e-15)
    assert written.read_bytes() == before


def test_a_database_of_version_1_is_gone_on_with(written) -> None:
    with cw.open_database(written) as db:
        known = db.branch("b1").points
    run_file = cw.read_run_file(
        written.with_name("cubic.yaml"), ["continue.max_points=400"], output=str(written)
    )
    cw.run(run_file, resume=True, figures=False)
    assert schema_version(written) == SCHEMA_VERSION
    with cw.open_database(written) as db:
        branch = db.branch("b1")
    assert branch.outcome.reason == "bound"
    assert [point.label for point in branch.special_points] == ["EP", "UZ", "LP", "LP", "EP"]
    folds = [point.parameters["a"] for point in branch.special_points if point.label == "LP"]
    np.testing.assert_allclose(sorted(folds), [-2.0 / 27.0**0.5, 2.0 / 27.0**0.5], rtol=1e-15)
    assert branch.points[: len(known)].tobytes() == known.tobytes()  # backwards it had come to its end


def test_labels_of_any_length_are_kept_or_refused() -> None:
    info = BranchInfo("b1", "locus", ("x",), (), ("a", "b"), {"a": 0.0, "b": 0.0}, 2, 1)
    dtype = special_record_dtype(info)
    long = "L" * LABEL
    assert special_record(info, SpecialPoint(label=long, s=0.0), dtype)["label"][0] == long.encode()
    with pytest.raises(DatabaseError, match=f"has more than {LABEL} bytes"):
        special_record(info, SpecialPoint(label=long + "L", s=0.0), dtype)


@pytest.mark.parametrize(("states", "spectrum"), [(1, 200), (200, 0)])
def test_a_special_point_with_all_that_its_branch_announces_fits(states, spectrum) -> None:
    """Many eigenvalues or many states, of numbers that take as many characters as a float can: 24."""
    names, number = tuple(f"x{i}" for i in range(states)), -1.2345678901234567e-300
    info = BranchInfo("b1", "periodic_orbit", names, (), ("a",), {"a": 0.0}, states + 1, spectrum)
    point = SpecialPoint(
        label="LP",
        s=number,
        parameters={"a": number},
        state=dict.fromkeys(names, number),
        period=-number,
        spectrum=(complex(number, number),) * spectrum,
        spectrum_full=(complex(number, number),) * spectrum,
        unknowns=(number,) * info.unknowns,
        tangent=(number,) * (info.unknowns + 1),
    )
    record = special_record(info, point, special_record_dtype(info))
    assert special_from_text(record["record"][0].decode()) == point
