"""No two files of the package know each other in a circle: in functions and for annotations neither."""

from __future__ import annotations

from tools.house.imports import PACKAGE, House, circles


def test_no_files_import_each_other_in_a_circle():
    house = House.read()
    # The package itself names the public interface, each name imported when it is first used.
    imports = {name: found - {PACKAGE} for name, found in house.imports.items() if name != PACKAGE}
    assert {tuple(sorted(group)) for group in circles(imports).values() if len(group) > 1} == set()


def test_a_circle_over_an_annotation_and_a_lazy_import_is_seen(tmp_path):
    folder = tmp_path / PACKAGE
    folder.mkdir()
    (tmp_path / "pyproject.toml").write_text(
        '[[tool.importlinter.contracts]]\nname = "Layers import downwards only"\nlayers = ["contwalk.a"]\n',
        encoding="utf-8",
    )
    texts = {
        "__init__": '"""All."""\n',
        "a": '"""A."""\nfrom typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from contwalk.b import B\n',
        "b": '"""B."""\nfrom contwalk import c\n',
        "c": '"""C."""\ndef f():\n    import contwalk.a\n',
    }
    for name, text in texts.items():
        (folder / f"{name}.py").write_text(text, encoding="utf-8")
    house = House.read(tmp_path)
    assert circles(house.imports)["contwalk.a"] == {"contwalk.a", "contwalk.b", "contwalk.c"}
