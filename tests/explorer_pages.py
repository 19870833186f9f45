"""What stands in a page that `contwalk explore` writes, read by Python's own zlib."""

from __future__ import annotations

import base64
import json
import re
import zlib
from typing import Any

BLOCK = re.compile(r'<script type="application/octet-stream" data-block="([^"]*)">([^<]*)</script>')


def blocks(page: str) -> dict[str, tuple[Any, bytes]]:
    """Header and bytes of each block by its name."""
    found = {}
    for name, text in BLOCK.findall(page):
        whole = zlib.decompress(base64.b64decode(text))
        length = int.from_bytes(whole[:4], "little")
        found[name] = json.loads(whole[4 : 4 + length]), whole[4 + length :]
    return found


def numbers(body: bytes) -> list[int]:
    """Whole numbers of seven bits a byte, the lowest first, zigzag."""
    found, value, shift = [], 0, 0
    for byte in body:
        value |= (byte & 127) << shift
        shift += 7
        if byte < 128:
            found.append(-(value + 1) // 2 if value & 1 else value // 2)
            value = shift = 0
    return found
