"""What is derived from a field is kept, and made anew where it is damaged, foreign or of another field."""

from __future__ import annotations

import marshal

import numpy as np
import pytest

from contwalk import object_cache
from contwalk.fields.trace import trace
from contwalk.flow.compiled import derived as kept
from contwalk.flow.compiled import field as compiled
from contwalk.flow.compiled.field import Field

STATES = [("x", 0), ("x", 1)]


def field(factor: float = 2.0, columns=(), outputs: int = 2) -> Field:
    def rates(tracer):
        x, y, p = tracer.symbol("x", 0), tracer.symbol("x", 1), tracer.symbol("p", 0)
        return [y * (p * p + 1.0), -factor * x * x - p * y, x + y][:outputs]

    return Field(trace(rates), STATES, {"p": 1}, columns, outputs=outputs)


def told(own: Field) -> list:
    c = own.constants([3.0])
    values, slopes = own.linearized(0.0, [0.5, 0.25], c)
    return [values.tolist(), slopes.tolist(), own.row_ptr.tolist(), own.col.tolist(), own.ones, c.tolist()]


@pytest.fixture(autouse=True)
def cache_of_its_own(tmp_path, monkeypatch):
    monkeypatch.setenv("CONTWALK_CACHE_DIR", str(tmp_path))


def entries(tmp_path) -> list:
    """Files of what is derived, which are no object code."""
    found = []
    for path in (tmp_path / "objects").glob("*.o"):
        content = object_cache.load(path.stem)
        try:
            if marshal.loads(content)[0] == path.stem:
                found.append(path)
        except (ValueError, TypeError, EOFError):
            continue
    return found


def test_no_derivative_is_built_where_an_earlier_process_has_kept_it(monkeypatch):
    first = told(field())
    monkeypatch.setattr(compiled, "jacobian", None)
    monkeypatch.setattr(compiled, "function", None)
    assert told(field()) == first


@pytest.mark.parametrize(("factor", "columns"), [(2.5, ()), (2.0, (("p", 0),))])
def test_another_field_or_other_columns_are_another_entry(factor, columns):
    told(field())
    slopes = np.array(told(field(factor=factor, columns=columns))[1])
    assert slopes.shape == (2, 2 + len(columns))
    np.testing.assert_allclose(slopes[:, :2], [[0.0, 10.0], [-factor, -3.0]], rtol=1e-15)


def test_another_generator_makes_its_own_entry(monkeypatch):
    told(field())
    asked = []
    monkeypatch.setattr(kept, "generator", lambda module: "another version")
    monkeypatch.setattr(compiled, "jacobian", lambda *a, own=compiled.jacobian: asked.append(1) or own(*a))
    told(field())
    assert asked


@pytest.mark.parametrize("damage", ["cut", "flipped", "foreign", "no entry"])
def test_a_damaged_or_foreign_entry_is_made_anew(tmp_path, damage):
    first = told(field())
    (path,) = entries(tmp_path)
    good = path.read_bytes()
    if damage == "cut":
        path.write_bytes(good[:-7])
    elif damage == "flipped":
        path.write_bytes(good[:-7] + bytes([good[-7] ^ 1]) + good[-6:])
    elif damage == "foreign":  # sound in itself, but of another field
        told(field(factor=7.0))
        other = next(one for one in entries(tmp_path) if one != path)
        path.write_bytes(other.read_bytes())
    else:
        object_cache.store(path.stem, marshal.dumps(3))
    assert told(field()) == first
    assert path.read_bytes() == good


def test_ones_of_a_map_with_other_outputs_than_states():
    """x + y has two ones; they are told by the entries alone, wherever these begin."""
    own = field(outputs=3)
    ones = [(int(np.searchsorted(own.row_ptr, i, side="right")) - 1, int(own.col[i])) for i in own.ones]
    assert ones == [(2, 0), (2, 1)]
