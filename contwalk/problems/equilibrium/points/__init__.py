"""The kinds of special points of equilibria, a file each; `catalogue` lists them."""
