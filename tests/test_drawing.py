"""Draws of a matrix of variants show each value of each parameter, and are the same on every machine."""

from __future__ import annotations

import random
from itertools import product

import pytest
from drawing import draw, leave_to_long

MATRIX = [{"a": a, "b": b, "c": c} for a, b, c in product(range(3), range(4), range(2))]


def shown(chosen, variants=MATRIX):
    return {pair for k in chosen for pair in variants[k].items()}


@pytest.mark.parametrize("seed", range(5))
def test_each_value_of_each_parameter_is_shown_by_few_variants(seed):
    chosen = draw(MATRIX, None, random.Random(seed))
    assert shown(chosen) == shown(range(len(MATRIX)))
    assert (
        4 <= len(chosen) <= 7
    )  # as many as the longest parameter has values, and one more for each of the others'


def test_another_seed_draws_others_and_the_same_one_the_same():
    draws = [frozenset(draw(MATRIX, None, random.Random(seed))) for seed in range(20)]
    assert len(set(draws)) > 10
    assert [frozenset(draw(MATRIX, None, random.Random(seed))) for seed in range(20)] == draws


def test_of_so_many_each_shows_something_new_as_long_as_it_can():
    chosen = draw(MATRIX, 3, random.Random(1))
    assert len(chosen) == 3
    assert {MATRIX[k]["a"] for k in chosen} == {0, 1, 2}
    assert {MATRIX[k]["c"] for k in chosen} == {0, 1}
    assert len(draw(MATRIX, 50, random.Random(1))) == len(MATRIX)
    assert len(draw([{"seed": k} for k in range(9)], 4, random.Random(1))) == 4


def test_what_is_not_drawn_is_long_and_marks_are_looked_at_afterwards(variants_left):
    tried, long, all_of_them = variants_left("not slow"), variants_left("long"), variants_left("")
    assert len(tried) == 3
    assert tried.isdisjoint(long)
    assert tried | long == all_of_them
    assert len(all_of_them) == 9


class Drawing:
    """The hook of `conftest.py`."""

    @pytest.hookimpl(wrapper=True, tryfirst=True)
    def pytest_collection_modifyitems(self, items):
        leave_to_long(items, "1")
        yield


@pytest.fixture
def variants_left(tmp_path, capfd):
    """Which variants of a test marked `drawn` a marker expression leaves, by its node."""
    source = "import pytest\n\n\n@pytest.mark.drawn\n@pytest.mark.parametrize('a', 'xyz')\n"
    source += "@pytest.mark.parametrize('b', 'xyz')\ndef test_it(a, b):\n    pass\n"
    (tmp_path / "test_matrix.py").write_text(source, encoding="utf-8")
    (tmp_path / "pytest.ini").write_text(
        "[pytest]\nmarkers =\n    slow\n    long\n    drawn\n", encoding="utf-8"
    )

    def left(expression: str) -> set[str]:
        capfd.readouterr()
        options = [str(tmp_path), "--collect-only", "-q", "-m", expression, "-p", "no:cacheprovider"]
        pytest.main(options, plugins=[Drawing()])
        return {line.rpartition("::")[2] for line in capfd.readouterr().out.splitlines() if "::" in line}

    return left
