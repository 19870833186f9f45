"""Files of motions, samples and margins made to mislead: a sentence, at once, and in little memory."""

from __future__ import annotations

import os
import tracemalloc
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest
from damage import flipped, sealed, truncated, with_seal_of, without_seal
from test_trajectory_files import samples, trajectory

from contwalk.cli.entry import run as command
from contwalk.errors import DatabaseError
from contwalk.storage.trajectory import (
    MARGINS,
    Margins,
    is_of_margins,
    read_margins,
    read_samples,
    read_trajectory,
    write_margins,
    write_samples,
    write_trajectory,
)

TEXT = h5py.string_dtype()


def margins() -> Margins:
    row = {"instant": 0, "state": "x", "sign": 1, "vector": [1.0, 0.0], "border": 0.5, "several": True}
    row |= {"borders": [0.5, 0.7], "ends": "fallen", "simulations": 12, "farthest": 1.0}
    other = {**row, "border": None, "borders": [], "several": False, "sign": -1, "vector": [-1.0, 0.0]}
    instants = tuple({"fraction": f, "time": f, "mode": "m", "state": [0.1, f]} for f in (0.0, 0.5))
    basin = {"states": ("x", "v"), "places": np.array([[0.0, 1.0], [2.0, 3.0]]), "labels": ("", "fallen")}
    header = {"provenance": {}, "units": {"x": "m"}, "parameters": {"c": 1.0}, "notes": ["none"]}
    return Margins("spring", ("x", "v"), (row, other), instants, header, basin)


KINDS: dict[str, tuple[Callable[[Path], object], Callable[[Path], object], str, str, str]] = {
    # Writes and reads one; a table of numbers, texts, and where names of columns are.
    "motion": (
        lambda path: write_trajectory(path, trajectory()),
        read_trajectory,
        "values",
        "events/name",
        "states",
    ),
    "samples": (lambda path: write_samples(path, samples()), read_samples, "draws", "", "names"),
    "margins": (
        lambda path: write_margins(path, margins()),
        read_margins,
        "instants/state",
        "instants/mode",
        "states",
    ),
}


def replaced(file, name, *given, **options):
    attributes = dict(file[name].attrs)
    del file[name]
    dataset = file.create_dataset(name, *given, **options)
    for key, value in attributes.items():
        dataset.attrs[key] = value


def linked(file, name, link):
    del file[name]
    file[name] = link


def one_text_for_all(file, table, texts, names):
    """A text of the file's length that each name of a column is."""
    file[table].attrs[names] = np.array(["x" * 40_000_000] * file[table].shape[1], TEXT)


def same_text_again(file, table, texts, names):
    """The raw references to one long text, a thousand times."""
    if not texts:
        pytest.skip("it has no texts")
    del file[texts]
    dataset = file.create_dataset(texts, (100_000,), TEXT, chunks=(1,), fillvalue=None)
    dataset[0] = "x" * 100_000


CHANGES: dict[str, Callable[[h5py.File, str, str, str], object]] = {
    "packed": lambda f, t, *_: replaced(f, t, (10**6, 2), "f8", chunks=(10**4, 2), compression="gzip"),
    "announced": lambda f, t, *_: replaced(f, t, (10**12, 2), "f8", chunks=(1, 2)),
    "of another file": lambda f, t, *_: replaced(f, t, (5, 2), "f8", external=[("/etc/passwd", 0, 80)]),
    "link to another file": lambda f, t, *_: linked(f, t, h5py.ExternalLink("/etc/passwd", "/x")),
    "soft link": lambda f, t, *_: linked(f, t, h5py.SoftLink("/")),
    "a group": lambda f, t, *_: (f.pop(t), f.create_group(t)),
    "no table": lambda f, t, *_: f.pop(t),
    "of other columns": lambda f, t, *_: replaced(f, t, data=np.ones((5, 7))),
    "of other rows": lambda f, t, *_: replaced(f, t, data=np.ones((77, 2))),
    "of texts": lambda f, t, *_: replaced(f, t, data=np.full((5, 2), "x", object), dtype=TEXT),
    "of nothing": lambda f, t, *_: replaced(f, t, data=h5py.Empty("f8")),
    "of complex numbers": lambda f, t, *_: replaced(f, t, data=np.ones((5, 2), complex)),
    "header of nothing": lambda f, *_: f.attrs.pop("header"),
    "header no JSON": lambda f, *_: f.attrs.__setitem__("header", "{"),
    "header a list": lambda f, *_: f.attrs.__setitem__("header", "[]"),
    "header deep": lambda f, *_: f.attrs.__setitem__("header", "[" * 50_000),
    "header of numbers": lambda f, *_: f.attrs.__setitem__("header", np.ones(3)),
    "a large number": lambda f, *_: f.attrs.__setitem__(
        "header", '{"parameters": {"c": ' + "9" * 4000 + "}}"
    ),
    "no text": lambda f, *_: f.attrs.__setitem__("header", '{"config": "\\ud800"}'),
    "parameters of texts": lambda f, *_: f.attrs.__setitem__("header", '{"parameters": {"c": "x"}}'),
    "provenance a list": lambda f, *_: f.attrs.__setitem__("header", '{"provenance": []}'),
    "version a text": lambda f, *_: f.attrs.__setitem__("schema_version", "one"),
    "names no texts": lambda f, t, _, n: f[t].attrs.__setitem__(n, [1.0, 2.0]),
    "names too many": lambda f, t, _, n: f[t].attrs.__setitem__(n, ["a", "b", "c"]),
    "names long": one_text_for_all,
    "texts again and again": same_text_again,
}


@pytest.fixture(params=KINDS)
def kind(request):
    return KINDS[request.param]


@pytest.mark.parametrize("change", CHANGES)
def test_a_file_that_misleads_is_refused_in_little_memory(tmp_path, kind, change):
    write, read, *places = kind
    path = tmp_path / "x.h5"
    write(path)
    with h5py.File(path, "r+") as file:
        CHANGES[change](file, *places)
    sealed(path)
    size = path.stat().st_size
    tracemalloc.start()
    try:
        if change == "names long" and size > 4e7:  # they are as long as the file is
            read(path)
        else:
            with pytest.raises(DatabaseError, match=r"x\.h5 (is damaged|has version|holds no)") as told:
                read(path)
            assert told.value.remedy
        # The content of the file twice, texts as well, and what Python itself takes.
        assert tracemalloc.get_traced_memory()[1] < 8 * size + 10**6
    finally:
        tracemalloc.stop()


def test_margins_that_name_what_is_not_there(tmp_path):
    path = write_margins(tmp_path / "x.h5", margins())
    for name in ("instant", "borders/row"):
        for number in (-1, 2, 10**9):
            with h5py.File(path, "r+") as file:
                before = file[name][0]
                file[name][0] = number
            sealed(path)
            with pytest.raises(DatabaseError, match="names what is not there"):
                read_margins(path)
            with h5py.File(path, "r+") as file:
                file[name][0] = before


def test_flipped_bits_and_missing_ends_are_noticed(tmp_path, kind):
    write, read, *_ = kind
    path = tmp_path / "x.h5"
    write(path)
    content, damaged = path.read_bytes(), tmp_path / "damaged.h5"
    whole = without_seal(content)
    for copy in (*flipped(whole, 60, seed=3), *truncated(whole, 30, seed=4)):
        damaged.write_bytes(with_seal_of(copy, content))
        with pytest.raises(DatabaseError, match=r"damaged\.h5 is"):
            read(damaged)


@pytest.mark.parametrize("damage", ["flipped", "pipe", "folder", "link to itself", "database of another"])
def test_plot_looks_at_no_file_before_it_is_checked(tmp_path, capsys, monkeypatch, damage):
    monkeypatch.chdir(tmp_path)
    path = write_margins(tmp_path / "x.h5", margins())
    assert is_of_margins(path)
    if damage == "flipped":
        content = bytearray(path.read_bytes())
        content[content.index(MARGINS.encode()) + 3] ^= 4
        path.write_bytes(content)
    else:
        path.unlink()
        if damage == "pipe":
            os.mkfifo(path)
        elif damage == "folder":
            path.mkdir()
        elif damage == "link to itself":
            path.symlink_to(path.name)
        else:
            with h5py.File(path, "w") as file:
                file.attrs["format"] = np.ones(3)
    assert not is_of_margins(path)
    assert command(["plot", "x.h5", "-o", "x.png"]) == 2
    told = capsys.readouterr().err
    assert told.startswith("error: x.h5 ")
    assert not (tmp_path / "x.png").exists()
    if damage == "pipe":
        path.unlink()  # whoever reads all files of this folder would wait
