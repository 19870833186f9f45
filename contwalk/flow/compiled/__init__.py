"""Vector fields as machine code, and the entry points of compiled kernels."""
