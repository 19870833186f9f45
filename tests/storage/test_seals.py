"""Seals of files: whole, damaged, cut short, and of nothing."""

from __future__ import annotations

import pytest

from contwalk.storage.seal import LENGTH, MARK, append_seal, intact, intact_file


@pytest.mark.parametrize("size", [0, 1, 1000, (1 << 20) + 1])
def test_a_sealed_file_is_intact_until_a_byte_of_it_changes(tmp_path, size):
    path = tmp_path / "file"
    path.write_bytes(bytes(range(256)) * (size // 256) + bytes(size % 256))
    assert intact_file(path) is None
    append_seal(path)
    assert path.stat().st_size == size + LENGTH
    assert intact_file(path) is True
    content = bytearray(path.read_bytes())
    content[0 if size else -2] ^= 1
    path.write_bytes(content)
    assert intact_file(path) is False


def test_what_is_shorter_than_a_seal_has_none(tmp_path):
    path = tmp_path / "file"
    path.write_bytes(bytes(LENGTH - 1))
    assert intact_file(path) is None


@pytest.mark.parametrize("size", [0, 40, 1000])
def test_a_seal_that_was_cut_is_told_from_one_that_does_not_fit(tmp_path, size):
    """A kill leaves the beginning of the seal that fits; damage before it leaves one that does not."""
    path = tmp_path / "file"
    path.write_bytes(b"x" * size)
    append_seal(path)
    whole = path.read_bytes()
    for left in range(LENGTH):
        cut = whole[: size + left]
        path.write_bytes(cut)
        assert intact(cut) is intact_file(path) is None, left
        # Of the mark alone nothing can be told, of the hash each digit says it 15 times in 16.
        if size and left > len(MARK) + 8:
            damaged = b"y" + cut[1:]
            path.write_bytes(damaged)
            assert intact(damaged) is intact_file(path) is False, left
        if left > len(MARK):
            other = cut[:-1] + (b"g" if left < LENGTH - 1 else b"x")
            path.write_bytes(other)
            assert intact(other) is intact_file(path) is False, left
