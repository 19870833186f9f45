# make demo   a first study: bifurcation diagram of the autobalancer, left in demo/
# make test   all tests
# make check  tests, lint, format, types and import directions
#
# Everything goes into .venv, which is made when it is first needed. `make test PYTHON=python3.12` chooses the Python.

VENV := .venv
BIN := $(VENV)/bin
PIP := $(BIN)/python -m pip --disable-pip-version-check --quiet
DEMO := demo
TEST_OPTIONS ?=

.PHONY: help demo test check static format docs-image clean find-python
.DEFAULT_GOAL := help
.DELETE_ON_ERROR:

help:
	@sed -n 's/^# make/make/p' Makefile

# -- the virtual environment: stamps remember what is installed, so that nothing is done twice -------------------

# Made anew only when a Python is asked for that it was not made with.
$(BIN)/python: | find-python

find-python:
	@sh tools/make_venv.sh $(VENV) $(PYTHON)

$(VENV)/installed: pyproject.toml | $(BIN)/python
	@echo "Installing contwalk into $(VENV) ..."
	@$(PIP) install --editable .
	@touch $@

$(VENV)/installed-test: pyproject.toml | $(BIN)/python
	@echo "Installing contwalk and what its tests need into $(VENV) ..."
	@$(PIP) install --editable '.[test]'
	@touch $@ $(VENV)/installed

$(VENV)/installed-dev: pyproject.toml | $(BIN)/python
	@echo "Installing contwalk and its checks into $(VENV) ..."
	@$(PIP) install --editable '.[dev]'
	@touch $@ $(VENV)/installed $(VENV)/installed-test

# -- what a newcomer types -----------------------------------------------------------------------------------

demo: $(VENV)/installed
	@mkdir -p $(DEMO)
	@cd $(DEMO) && ../$(BIN)/contwalk continue ../runs/autobalancer_load.yaml --force

test: $(VENV)/installed-test
	$(BIN)/python -m pytest --numprocesses auto $(TEST_OPTIONS)

# -- what a contributor types --------------------------------------------------------------------------------

check: static test

static: $(VENV)/installed-dev
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

format: $(VENV)/installed-dev
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

# The picture of the README.
docs-image: demo
	cp $(DEMO)/autobalancer_load_bifurcation_diagram.png docs/images/autobalancer_load.png

clean:
	rm -rf $(VENV) $(DEMO) build dist *.egg-info .pytest_cache .mypy_cache .ruff_cache .hypothesis .import_linter_cache
