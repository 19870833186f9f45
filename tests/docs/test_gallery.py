"""docs/gallery.md: its commands make its pictures."""

from __future__ import annotations

import pytest
from code_blocks import ROOT, blocks, commands
from PIL import Image

from tools import gallery

PAGE = "docs/gallery.md"


def test_the_pictures_are_there_and_small_enough_to_keep():
    assert len(gallery.pictures()) >= 10
    assert len(blocks(PAGE, "console")) == 8
    for name in gallery.pictures():
        assert 0 < (ROOT / "docs/images" / name).stat().st_size < 300_000


@pytest.mark.slow
def test_the_commands_make_the_pictures(tmp_path):
    assert gallery.commands() == commands(PAGE)
    gallery.make(tmp_path)
    for name in gallery.pictures():
        with Image.open(tmp_path / name) as made, Image.open(ROOT / "docs/images" / name) as kept:
            # a text that another library sets wider may move an edge by some pixels
            assert made.size == pytest.approx(kept.size, abs=30), name
