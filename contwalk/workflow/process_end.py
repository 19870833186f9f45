"""A plugin that calls `os._exit` raises an exception, as one that calls `sys.exit` does.

Nothing of Python runs after `os._exit`: a run would end in the middle with the plugin's exit code, 0 perhaps,
and without a word. A C library that ends the process by itself cannot be met like this.
"""

from __future__ import annotations

import os
from typing import NoReturn

# Ends this process at once, whatever `os._exit` stands for.
end_process = os._exit


def refuse_exit() -> None:
    """From here on `os._exit` raises `SystemExit` in this process, but not in those forked from it."""
    own = os.getpid()

    def raise_instead(status: int) -> NoReturn:
        if os.getpid() != own:
            end_process(status)
        raise SystemExit(status)

    os._exit = raise_instead
