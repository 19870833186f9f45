"""The kinds of special points of curves in two parameters, a file each; `catalogue` lists them."""
