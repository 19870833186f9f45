"""All databases, and branches with every awkward value that a run can produce."""

from __future__ import annotations

import math

import numpy as np
import pytest
from page_backend import json_lines

from contwalk.branch import BranchInfo, SpecialPoint
from contwalk.storage import Hdf5Database, MemoryDatabase, RunHeader


@pytest.fixture
def header() -> RunHeader:
    return RunHeader(
        "autobalancer",
        {"masses": 2, "suspension": "isotropic"},
        "contwalk: 1\nsystem: autobalancer  # Δ in metres\n",
        {"contwalk_version": "0.1.0", "accuracy": 1e-8, "bound": math.inf},
    )


@pytest.fixture(params=["hdf5", "memory", "page"])
def db(request, tmp_path, header):
    """An empty database that can be written; `page`: the one of the page on storage backends."""
    if request.param == "memory":
        made = MemoryDatabase(header)
    elif request.param == "hdf5":
        made = Hdf5Database.create(tmp_path / "run.h5", header)
    else:
        made = json_lines().JsonLinesDatabase.create(tmp_path / "run.jsonl", header)
    yield made
    made.close()


@pytest.fixture
def reread(tmp_path):
    """The same database as the next process would see it."""

    def again(db, writable=False):
        if db.path is None:
            return db
        db.close()
        return type(db).open(db.path, writable)

    return again


@pytest.fixture
def make_info():
    def make(name="b1", **changes):
        values = {
            "name": name,
            "problem": "equilibrium",
            "states": ("q1", "q2"),
            "observables": ("max_re",),
            "free": ("delta",),
            "parameters": {"delta": 0.0055, "omega": 5.0, "c": 2.0},
            "unknowns": 3,
            "spectrum": 2,
            "origin": "start: equilibrium balanced",
            "settings": {"mesh": [0.0, 0.5, 1.0], "highest": math.inf},
        }
        return BranchInfo(**(values | changes))

    return make


@pytest.fixture
def make_row():
    def make(info, s, **changes):
        """A point at arclength s whose numbers are all different."""
        row = np.zeros((), info.point_dtype())
        values = {
            "s": s,
            "free": [s / 7 + k for k in range(len(info.free))],
            "state": [s / 3 + k for k in range(len(info.states))],
            "observables": [s / 11 + k for k in range(len(info.observables))],
            "period": math.nan,
            "spectrum": [complex(-s, k + 0.1) for k in range(info.spectrum)],
            "unstable": 2,
            "stable": False,
            "admissible": True,
            "unknowns": [s * k for k in range(info.unknowns)],
            "tangent": [1.0] + [0.0] * info.unknowns,
            "step": 0.01,
            "residual": 0.5,
            "iterations": 3,
            "rhs": 40,
            "seconds": 0.25,
        }
        for column, value in (values | changes).items():
            row[column] = value
        return row

    return make


@pytest.fixture
def make_special():
    def make(label="HB", s=0.2, **changes):
        values = {
            "parameters": {"delta": 0.0045 + s, "omega": 5.0, "c": 2.0},
            "state": {"q1": 0.1, "q2": -0.2},
            "period": 1.2566370614359172,
            "period_full": 2.5132741228718345,
            "spectrum": (complex(0.0, 5.0), complex(math.nan, -math.inf)),
            "spectrum_full": (complex(1.0, 0.0),),
            "trivial_error": 1e-11,
            "unstable_before": 0,
            "unstable_after": 2,
            "error": 3e-12,
            "criticality": "subcritical",
            "coefficients": {"l1": 0.2, "convention": "Kuznetsov", "l2": math.nan, "nan": "nan"},
            "margin": {"friction": -math.inf},
            "note": "strong resonance 1:2, ω₁ = ω₂",
            "unknowns": (0.1, -0.2, 1 / 3),
            "tangent": (1.0, 0.0, 0.0, 1e-300),
        }
        return SpecialPoint(label, s, **(values | changes))

    return make
