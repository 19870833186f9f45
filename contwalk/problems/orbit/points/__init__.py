"""The kinds of special points of orbits, a file each; `catalogue` lists them."""
