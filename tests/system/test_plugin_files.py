"""The files of a plugin, found without running them."""

from __future__ import annotations

import os
import sys

from contwalk.system import load_system
from contwalk.system import plugin_files as plugin_files_module
from contwalk.system.loading import load_declaration, plugin_files
from contwalk.system.plugin_files import hash_of, hashes_of_file


def write(folder, **files):
    for name, text in files.items():
        path = folder / f"{name.replace('__', '/')}.py"
        path.parent.mkdir(exist_ok=True)
        path.write_text(text, encoding="utf-8")


def test_files_that_are_imported_count(tmp_path):
    write(
        tmp_path,
        machine="import numpy, json\nimport masses\nfrom parts import springs\n",
        masses="def f():\n    import late\n",
        late="import machine\n",  # a circle
        parts__springs="from .dampers import c\nfrom .. import outside\n",
        parts__dampers="c = 1.0\n",
        unrelated="",
        outside="",
    )
    (tmp_path / "parts" / "__init__.py").write_text("", encoding="utf-8")
    found = hashes_of_file(tmp_path / "machine.py")
    package = [f"parts/{name}.py" for name in ("__init__", "dampers", "springs")]
    assert list(found) == ["late.py", "machine.py", "masses.py", "outside.py", *package]


def test_imports_are_found_wherever_statements_stand(tmp_path):
    blocks = {
        "if 0:\n    pass\nelse:\n    import {}": "in_else",
        "try:\n    import {}\nexcept ValueError:\n    pass": "in_try",
        "try:\n    pass\nexcept ValueError:\n    import {}": "in_except",
        "try:\n    pass\nfinally:\n    import {}": "in_finally",
        "with open('x'):\n    import {}": "in_with",
        "for i in ():\n    while i:\n        import {}": "in_loops",
        "match 1:\n    case 2:\n        import {}": "in_match",
        "class A:\n    async def f(self):\n        import {}": "in_method",
    }
    text = "\n".join(block.format(name) for block, name in blocks.items())
    write(tmp_path, machine=text, **dict.fromkeys(blocks.values(), ""))
    found = hashes_of_file(tmp_path / "machine.py")
    assert sorted(found) == sorted(["machine.py", *(f"{name}.py" for name in blocks.values())])


def test_statements_are_kept_under_the_text(tmp_path, monkeypatch):
    monkeypatch.setenv("CONTWALK_CACHE_DIR", str(tmp_path / "cache"))
    plugin_files_module._import_statements.cache_clear()
    folder = tmp_path / "plugin"
    folder.mkdir()
    write(folder, machine="from . import masses, springs as s\n", masses="", springs="", dampers="")
    first = hashes_of_file(folder / "machine.py")
    assert list(first) == ["machine.py", "masses.py", "springs.py"]
    plugin_files_module._import_statements.cache_clear()
    monkeypatch.setattr(plugin_files_module, "_read", None)  # a text that has been read is not parsed again
    assert hashes_of_file(folder / "machine.py") == first
    monkeypatch.undo()
    write(folder, machine="from . import masses, dampers\n")
    assert list(hashes_of_file(folder / "machine.py")) == ["dampers.py", "machine.py", "masses.py"]


def test_the_hash_depends_on_each_of_them(tmp_path):
    write(tmp_path, machine="import masses\n", masses="m = 1.0\n")
    before = hash_of(hashes_of_file(tmp_path / "machine.py"))
    write(tmp_path, masses="m = 2.0\n")
    assert hash_of(hashes_of_file(tmp_path / "machine.py")) != before


def test_what_is_no_python_is_a_file_all_the_same(tmp_path):
    write(tmp_path, broken="def f(:\n", deep="(" * 3000)
    for name in ("broken", "deep"):
        assert list(hashes_of_file(tmp_path / f"{name}.py")) == [f"{name}.py"]
    assert hashes_of_file(tmp_path / "missing.py") == {}


def test_an_installed_system_has_the_files_of_its_package():
    found = plugin_files("autobalancer")
    assert {"__init__.py", "autobalancer/isotropic.py", "autobalancer/parameters.py"} <= set(found)
    assert not any("walker" in name for name in found)
    assert load_system("autobalancer").source == hash_of(found)
    assert plugin_files("no_such_system") == {}


def test_a_plugin_that_is_written_anew_within_a_second_is_the_new_one(tmp_path, monkeypatch):
    monkeypatch.setattr(sys, "dont_write_bytecode", False)
    text = (
        "from contwalk.system import Mode, Parameter, State, System\n"
        "def field(t, x, p, dx):\n    dx[0] = p.k - x[0]\n"
        'SYSTEM = System(name="own", states=(State("x"),), parameters=(Parameter("k", 1.0),),\n'
        '                modes=(Mode("free", field),))\n'
    )
    defaults = []
    for number in ("1.0", "2.0"):
        file = tmp_path / "own.py"
        file.write_text(text.replace("1.0", number), encoding="utf-8")
        os.utime(file, (1e9, 1e9))
        defaults.append(load_declaration(str(file)).parameters[0].default)
    assert defaults == [1.0, 2.0]
