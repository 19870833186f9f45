"""`contwalk new`: what it writes runs as it is."""

from __future__ import annotations

import contwalk as cw


def test_plugin_and_run_file_run_as_they_are(contwalk, folder):
    done = contwalk("new", "my_model")
    assert done.code == 0
    assert "Next: contwalk continue my_model.yaml" in done.out
    assert contwalk("continue", "my_model.yaml", "--quiet").code == 0
    assert cw.open_database("my_model.h5")["b1"].special_points["HB1"].parameters["B"] == 2.0
    assert "0 warnings, 0 errors" in contwalk("systems", "check", "my_model.py").out


def test_init_of_a_new_plugin_runs_too(contwalk, folder):
    contwalk("new", "my_model")
    assert contwalk("init", "./my_model.py", "-o", "other.yaml").code == 0
    assert "start: {state: {x: 1.0, y: 1.5}}" in (folder / "other.yaml").read_text()
    assert contwalk("continue", "other.yaml", "--quiet").code == 0


def test_nothing_is_replaced(contwalk, folder):
    (folder / "my_model.yaml").write_text("mine")
    done = contwalk("new", "my_model")
    assert (done.code, "my_model.yaml exists" in done.err) == (2, True)
    assert not (folder / "my_model.py").exists()
    for name in ("2x", "a-b", "class", ""):
        assert contwalk("new", name).code == 2
