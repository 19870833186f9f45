"""Seals of files: whole, damaged, cut short, and of nothing."""

from __future__ import annotations

import pytest

from contwalk.storage.seal import LENGTH, MARK, SHORTEST, append_seal, intact, intact_file


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
def test_a_file_that_lacks_its_last_bytes_is_noticed(tmp_path, size):
    path = tmp_path / "file"
    path.write_bytes(b"x" * size)
    append_seal(path)
    whole = path.read_bytes()
    for missing in range(1, LENGTH - SHORTEST + 1):
        path.write_bytes(whole[:-missing])
        assert intact(whole[:-missing]) is False, missing
        assert intact_file(path) is False, missing
    path.write_bytes(whole + MARK)
    assert intact_file(path) is intact(whole + MARK) is False
    for left in range(SHORTEST):
        assert intact(whole[: size + left]) is None
