"""Which database a file is kept in, by the end of its name."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path

from contwalk.storage.file_database import FileDatabase

# End of the name -> module and class of a `FileDatabase`, imported when such a file is first asked for.
BACKENDS = {".h5": "contwalk.storage.hdf5:Hdf5Database"}
# Files of any other name are HDF5.
DEFAULT = ".h5"


def backend_of(path: str | Path) -> type[FileDatabase]:
    """The kind of database that a file of this name is."""
    module, _, name = BACKENDS.get(Path(path).suffix, BACKENDS[DEFAULT]).partition(":")
    found: type[FileDatabase] = getattr(import_module(module), name)
    return found
