#!/bin/sh
# Install this project into the virtual environment $1 in editable form, with the extra $2 (test or dev) if one is named.
# A stamp in the environment remembers it, until pyproject.toml changes.
set -eu

venv=$1
extra=${2:-}
stamp=$venv/installed${extra:+-$extra}

if [ -e "$stamp" ] && [ ! pyproject.toml -nt "$stamp" ]; then
    exit 0
fi
echo "Installing contwalk${extra:+ with its extra '$extra'} into $venv ..."
"$venv/bin/python" -m pip --disable-pip-version-check --quiet install --editable ".${extra:+[$extra]}"
: >"$stamp"
# What dev holds contains what test holds.
if [ "$extra" = dev ]; then
    : >"$venv/installed-test"
fi
: >"$venv/installed"
