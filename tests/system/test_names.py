"""Names in declarations."""

from __future__ import annotations

from contwalk.system.names import free_name


def test_a_free_name_is_none_of_those_taken():
    assert free_name("fallen", ()) == "fallen"
    assert free_name("fallen", {"fallen", "fallen_", "other"}) == "fallen__"
