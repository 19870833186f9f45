#!/bin/sh
# Make the virtual environment $1, with the Python $2 if one is named, else with the first that is new enough.
# An environment that works is kept, unless another Python is named than it was made with.
set -eu

venv=$1
wanted=${2:-}
usable='
import sys
if sys.version_info < (3, 11):
    sys.exit(1)
import ensurepip, venv
'

# A name may exist and still not run (a version manager that has that version switched off): so it is tried.
runs() {
    "$1" -c "$usable" >/dev/null 2>&1
}

# Only an environment whose making was not broken off has the mark.
works() {
    [ -e "$venv/made" ] && runs "$venv/bin/python"
}

home_of() {
    "$1" -c 'import sys; print(sys.base_prefix, sys.version)'
}

if [ -n "$wanted" ]; then
    if ! runs "$wanted"; then
        echo "PYTHON=$wanted is not a Python 3.11 or newer with the modules venv and ensurepip." >&2
        echo "Name another one, or leave PYTHON out." >&2
        exit 1
    fi
    found=$wanted
    if works && [ "$(home_of "$venv/bin/python")" = "$(home_of "$wanted")" ]; then
        exit 0
    fi
else
    if works; then
        exit 0
    fi
    found=
    for candidate in python3 python3.14 python3.13 python3.12 python3.11 python; do
        if runs "$candidate"; then
            found=$candidate
            break
        fi
    done
    if [ -z "$found" ]; then
        echo "No Python 3.11 or newer with the modules venv and ensurepip was found. Looked for: python3," >&2
        echo "python3.14, python3.13, python3.12, python3.11, python. Install one (on Debian and Ubuntu the package" >&2
        echo "python3-venv belongs to it), or name it: make test PYTHON=/path/to/python3.12" >&2
        exit 1
    fi
fi

echo "Making the virtual environment $venv with $("$found" --version) ..."
"$found" -m venv --clear "$venv"
: >"$venv/made"
