"""A run file whose form has been checked before is read without what checks it, and says the same."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import fields
from pathlib import Path

import pytest

from contwalk import object_cache
from contwalk.errors import RunFileError
from contwalk.workflow.run_file import kept_form
from contwalk.workflow.run_file.form import checked_form, written_out
from contwalk.workflow.run_file.kept_form import KeptSection, form_of, read_back
from contwalk.workflow.run_file.model import RunModel
from contwalk.workflow.run_file.reading import read_run_file

RUNS = Path(__file__).parents[2] / "runs"
# Run files whose sections hold more than plain values.
CHECKED_EACH_TIME = ("basin", "monte_carlo")


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv("CONTWALK_CACHE_DIR", str(tmp_path))
    return tmp_path


def _seen(of):
    """All that a section says, with the names that were given."""
    if hasattr(of, "model_fields_set"):
        names = type(of).model_fields if isinstance(of, RunModel.__mro__[1]) else of._names
        return {name: _seen(getattr(of, name)) for name in names}, set(of.model_fields_set)
    if isinstance(of, dict):
        return {key: _seen(value) for key, value in of.items()}
    if isinstance(of, list | tuple):
        return type(of)(_seen(each) for each in of)
    return type(of), of


@pytest.mark.parametrize("path", sorted(RUNS.glob("*.yaml")), ids=lambda path: path.stem)
def test_a_kept_form_says_what_the_checked_one_does(path, folder):
    text = path.read_text(encoding="utf-8")
    overrides = ["accuracy=1e-9", "diagram=none"]
    document, model = checked_form(text, "first", overrides)
    form_of(text, "first", overrides)
    again, kept = form_of(text, "second", overrides)
    assert again.name == "second"
    assert (again.data, again.origins) == (document.data, document.origins)
    assert list(again.data) == list(document.data)
    assert _seen(kept) == _seen(model)
    assert isinstance(kept, KeptSection) != any(word in path.stem for word in CHECKED_EACH_TIME)
    for section in ("events", "engine"):
        for options in ({}, {"exclude_none": True}):
            dumped, checked = (getattr(of, section).model_dump(**options) for of in (kept, model))
            assert list(dumped.items()) == list(checked.items())


@pytest.mark.parametrize("name", ["autobalancer_cascade", "planar_slope", "autobalancer_load_drag_chart"])
def test_a_run_file_is_the_same_the_second_time(name, folder):
    first, second = (read_run_file(RUNS / f"{name}.yaml") for _ in range(2))
    for field in fields(first):
        if field.name not in ("system", "starts"):
            assert getattr(first, field.name) == getattr(second, field.name)
    assert [vars(start).keys() for start in first.starts] == [vars(start).keys() for start in second.starts]
    assert second.same_study(first.data)


def test_what_is_wrong_is_told_each_time(folder):
    for _ in range(2):
        with pytest.raises(RunFileError, match=r"line 2, key acuracy: unknown key."):
            form_of("system: autobalancer\nacuracy: 1e-8\n", "wrong.yaml", ())
    wrong_override = r"--set accuracy=5.*is 5."
    form_of("system: autobalancer\n", "right.yaml", ())
    with pytest.raises(RunFileError, match=wrong_override):
        form_of("system: autobalancer\n", "right.yaml", ("accuracy=5",))


def test_other_versions_check_anew(folder, monkeypatch):
    form_of("system: autobalancer\n", "x", ())
    assert isinstance(form_of("system: autobalancer\n", "x", ())[1], KeptSection)
    monkeypatch.setattr(kept_form, "_checked_by", lambda: ["another text"])
    assert isinstance(form_of("system: autobalancer\n", "x", ())[1], RunModel)


def test_a_damaged_form_is_checked_anew(folder):
    form_of("system: autobalancer\n", "x", ())
    (file,) = (folder / "objects").iterdir()
    file.write_bytes(file.read_bytes()[:-3])
    assert isinstance(form_of("system: autobalancer\n", "x", ())[1], RunModel)


def test_overrides_are_no_part_of_the_text(folder):
    form_of("system: autobalancer\n", "x", ("accuracy=1e-9",))
    assert form_of("system: autobalancer\n", "x", ())[1].accuracy == 1e-8
    assert form_of("system: autobalancer\n", "x", ("accuracy=1e-9",))[1].accuracy == 1e-9


def test_plain_values_come_back():
    model = RunModel.model_validate({"system": "x", "model": {"list": [1, (2.5, None)], "none": None}})
    assert read_back(written_out(model)).model == {"list": [1, (2.5, None)], "none": None}
    with pytest.raises(TypeError, match="set is not written out"):
        written_out({"a": {1}})


def test_a_known_run_file_takes_no_pydantic(folder):
    program = (
        "import sys\n"
        "from contwalk.workflow.run_file.reading import read_run_file\n"
        f"read_run_file({str(RUNS / 'autobalancer_cascade.yaml')!r})\n"
        "print([name for name in ('pydantic', 'ruamel.yaml') if name in sys.modules])\n"
    )
    first, second = (
        subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True).stdout
        for _ in range(2)
    )
    assert first.strip() == "['pydantic', 'ruamel.yaml']"
    assert second.strip() == "[]"
    assert object_cache.directory() == folder
