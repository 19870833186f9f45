"""Do the tests notice? Single-line mutants of lines that compute, each tried with the tests nearest to it.

    python -m tools.mutants measure                     which test runs which line (once, minutes)
    python -m tools.mutants run --count 400 --jobs 2    try so many mutants; goes on where it was broken off
    python -m tools.mutants table                       what survived, by package

`measure` and `run` need `pytest-cov` (`pip install pytest-cov`), which nothing else here does.
"""
