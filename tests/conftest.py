"""What holds for every test."""

# ruff: noqa: E402  (the number of threads is settled before NumPy is imported)
import os

for library in ("OPENBLAS", "MKL", "OMP"):  # as the command line does: two workers on two cores are enough
    os.environ.setdefault(f"{library}_NUM_THREADS", "1")

from collections.abc import Iterator
from pathlib import Path

import jsonschema
import pytest

from contwalk.errors import DatabaseError
from contwalk.storage import document, interface_schema, open_database


@pytest.fixture(autouse=True)
def _every_database_obeys_the_interface(request: pytest.FixtureRequest) -> Iterator[None]:
    """Whatever database a test leaves behind, `contwalk show --json --points` of it obeys the schema.

    Databases that a test has damaged on purpose do not open, and are left alone. A test without a folder of
    its own leaves none, and gets none made for it: to name one, pytest reads the names of all that are there.
    """
    folder: Path | None = request.getfixturevalue("tmp_path") if "tmp_path" in request.fixturenames else None
    yield
    for path in () if folder is None else folder.rglob("*.h5"):
        try:
            with open_database(path) as db:
                described = document(db, points=True)
        except DatabaseError:
            continue
        jsonschema.validate(described, interface_schema())
