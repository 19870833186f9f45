"""The kinds of special points of curves of orbits, a file each; `catalogue` lists them."""
