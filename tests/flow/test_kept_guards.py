"""What is compiled of a guard is derived once, and found by the next process under the guard's graph."""

from __future__ import annotations

import numpy as np
import pytest

from contwalk.flow.events import guard_code
from contwalk.flow.events.guard_code import GuardCode
from contwalk.system import Mode, Parameter, State, System


def _system() -> System:
    return System(
        name="kept",
        states=(State("x"), State("v")),
        parameters=(Parameter("k", 2.0),),
        modes=(Mode("free", lambda t, x, p: (x[1], -p.k * x[0])),),
    )


def _guard(t, x, p):
    return x[0] * x[1] - p.k * t


@pytest.fixture
def derived(tmp_path, monkeypatch):
    """How often a text has been derived."""
    monkeypatch.setenv("CONTWALK_CACHE_DIR", str(tmp_path))
    made: list[str] = []
    text = GuardCode._text
    monkeypatch.setattr(
        GuardCode, "_text", lambda self, name, change: made.append(name) or text(self, name, change)
    )
    monkeypatch.setattr(guard_code, "_KNOWN", {})
    return made


def test_a_guard_is_derived_once(derived):
    texts = []
    for _ in range(2):
        code = GuardCode(_system(), _guard, "free")
        assert code.address
        assert code.slopes_address
        texts.append(sorted(guard_code._KNOWN))
        guard_code._KNOWN.clear()
    assert derived == ["guard", "slopes"]
    assert texts[0] == texts[1]
    assert len(texts[0]) == 2


def test_another_guard_is_another_one(derived):
    assert GuardCode(_system(), _guard, "free").address
    assert GuardCode(_system(), lambda t, x, p: x[0] * x[1] - 2.0 * p.k * t, "free").address
    assert derived == ["guard", "guard"]


def test_another_text_derives_anew(derived, monkeypatch):
    assert GuardCode(_system(), _guard, "free").address
    monkeypatch.setattr(guard_code, "generator", lambda module: "another")
    assert GuardCode(_system(), _guard, "free").address
    assert derived == ["guard", "guard"]


def test_names_are_those_of_the_parameters_that_are_there():
    system = _system()
    assert system.parameter_names == tuple(parameter.name for parameter in system.parameters) == ("k",)
    assert system.state_names == ("x", "v")
    assert np.isfinite(list(system.defaults().values())).all()
