"""The command line: click commands, one per file, without algorithms.

Rules
-----
1. A module here imports only the standard library and click when it is imported; whatever computes, stores or
   draws is imported inside the command that needs it. So `contwalk --help` and every
   `contwalk COMMAND --help` answer at once.
2. Results go to stdout, everything about the run itself (progress, warnings, errors) to stderr.
3. Exit codes: 0; 1 where computing failed; 2 for bad input, with nothing written; 130 on Ctrl-C.
"""

from contwalk.cli.entry import main

__all__ = ["main"]
