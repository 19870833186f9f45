"""How files are written: beside what there is, locked, and put in its place when they are whole."""
