"""What holds for every test."""

# ruff: noqa: E402  (the number of threads is settled before NumPy is imported)
import gc
import hashlib
import os

# Nine thousand tests and what they import live to the end: the collector of cycles need not look through them
# each time that some more are there.
USUAL = gc.get_threshold()
gc.set_threshold(50_000, *USUAL[1:])

for library in ("OPENBLAS", "MKL", "OMP"):  # as the command line does: two workers on two cores are enough
    os.environ.setdefault(f"{library}_NUM_THREADS", "1")

from collections.abc import Iterator
from functools import cache
from pathlib import Path

import jsonschema
import pytest
from drawing import given_seed, leave_to_long
from order import longest_first, table
from turns import HERE, leave_bits_out, listed, wait_for_their_turn
from turns import table as taking_turns

from contwalk.errors import DatabaseError
from contwalk.storage import document, interface_schema, open_database


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> Iterator[None]:
    """Draws come before marks are looked at; where processes share tests, the longest files come first."""
    wait_for_their_turn(items, given_seed(), taking_turns())
    leave_to_long(items, given_seed())
    leave_bits_out(items, os.environ.get("CONTWALK_NOISE", ""), listed(HERE / "bits.txt"))
    yield
    if hasattr(config, "workerinput"):
        files = [item.nodeid.split("::")[0] for item in items]
        slow = [item.get_closest_marker("slow") is not None for item in items]
        items[:] = [items[k] for k in longest_first(files, slow, table())]


def pytest_report_header() -> str:
    """So that what failed can be tried again: which draw, of variants and of costly tests that take turns."""
    return f"draw: CONTWALK_TEST_DRAW={given_seed()}"


def pytest_collection_finish() -> None:
    """The tests run with the collector as it is in any process."""
    gc.freeze()
    gc.set_threshold(*USUAL)


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
            content = hashlib.sha256(path.read_bytes()).digest()
            if content in OBEYED:
                continue
            with open_database(path) as db:
                described = document(db, points=True)
        except (DatabaseError, OSError):
            continue
        _obedience().validate(described)
        OBEYED.add(content)


# Digests of databases that obeyed: tests of one file often begin with copies of the same one.
OBEYED: set[bytes] = set()


@cache
def _obedience() -> jsonschema.Draft202012Validator:
    """What looks at documents; the schema itself is looked at once, which takes longer than most of them."""
    schema = interface_schema()
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema)
