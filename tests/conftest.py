"""What holds for every test."""

from collections.abc import Iterator
from pathlib import Path

import jsonschema
import pytest

from contwalk.errors import DatabaseError
from contwalk.storage import document, interface_schema, open_database


@pytest.fixture(autouse=True)
def _every_database_obeys_the_interface(tmp_path: Path) -> Iterator[None]:
    """Whatever database a test leaves behind, `contwalk show --json --points` of it obeys the schema.

    Databases that a test has damaged on purpose do not open, and are left alone.
    """
    yield
    for path in tmp_path.rglob("*.h5"):
        try:
            with open_database(path) as db:
                described = document(db, points=True)
        except DatabaseError:
            continue
        jsonschema.validate(described, interface_schema())
