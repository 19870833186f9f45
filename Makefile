# make demo   a first study: bifurcation diagram of the autobalancer, left in demo/
# make quick  one test of each kind, in a minute and a half on one core
# make near   the tests nearest to what has changed since main (BASE=HEAD~3: since another commit)
# make test   the tests, in some minutes
# make slow   the slow ones: whole studies, killed runs, peers
# make long   more of these, for which no change waits
# make runs   every file of runs/ as it is written, with the values that its table tells: an hour
# make browser pages of the explorer in headless Chromium, where there is one
# make check  all tests, lint, format, types and import directions
# make same   six studies beside what the last commit made of them (or REVISION=...): what differs, points, CPU
# make noise  the six studies with noise in the last bits, by two seeds: nothing may differ but digits within errors
# make trial  kills, full disks, damaged and hostile files, two writers: a quarter of them (SHARE=1: all), by a seed
# make bench  what continuing costs, beside peers: docs/benchmarks.md
# make dist   wheel and source distribution, left in dist/; make wheel tries the wheel in an empty environment
# make gallery  the pictures of docs/gallery.md, and pages of the explorer for the site
# make docs   what of docs/ is written from the code, and the site: build/site/html/index.html
#
# Everything goes into .venv, which is made when it is first needed. `make test PYTHON=python3.12` chooses the Python.

VENV := .venv
BIN := $(VENV)/bin
DEMO := demo
TEST_OPTIONS ?=
BASE ?= main

# Makes the environment and installs into it what is not there yet; silent and quick where all is.
PROVIDE = @sh tools/make_venv.sh $(VENV) $(PYTHON) && sh tools/install.sh $(VENV)

.PHONY: help demo quick near test slow long runs browser check same noise trial bench dist wheel gallery docs static format docs-image clean install install-test install-dev install-bench
.NOTPARALLEL:
.DEFAULT_GOAL := help

help:
	@sed -n 's/^# make/make/p' Makefile

install:
	$(PROVIDE)

install-test:
	$(PROVIDE) test

install-dev:
	$(PROVIDE) dev

install-bench:
	$(PROVIDE) bench

# -- what a newcomer types -----------------------------------------------------------------------------------

demo: install
	@mkdir -p $(DEMO)
	$(BIN)/contwalk continue runs/autobalancer_load.yaml --output $(DEMO)/autobalancer_load.h5 --force
	@echo "The command contwalk is at hand after: . $(BIN)/activate"

# The tests of a file share studies: in one process each study is computed once. Files come in the order of tests/order.py.
# Hundreds of processes are started, and each would compile all modules where the environment says to keep none compiled.
PYTEST = env -u PYTHONDONTWRITEBYTECODE $(BIN)/python -m pytest --numprocesses auto --dist loadfile --no-loadscope-reorder

# In one process, which is ready before several would be; names of tests may have blanks.
quick: install-test
	sed '/^#/d' tests/quick.txt | tr '\n' '\0' | xargs -0 env -u PYTHONDONTWRITEBYTECODE $(BIN)/python -m pytest -m "not slow and not browser" $(TEST_OPTIONS)

# All of them: none waits for its turn.
near: install-test
	@near=$$($(BIN)/python -m tools.near --base $(BASE)) && if [ -n "$$near" ]; then CONTWALK_TEST_DRAW=all $(PYTEST) -m "not slow and not browser" $(TEST_OPTIONS) $$near; fi

test: install-test
	$(PYTEST) -m "not slow and not browser" $(TEST_OPTIONS)

slow: install-test
	$(PYTEST) -m "slow and not long and not runs" $(TEST_OPTIONS)

long: install-test
	$(PYTEST) -m long $(TEST_OPTIONS)

# One after the other, in one folder: some begin where others end. TEST_OPTIONS='-k planar' runs a part.
runs: install-test
	$(BIN)/python -m pytest -m runs $(TEST_OPTIONS) tests/thesis/test_every_run_file.py

# Where there is no Chromium, that is said and nothing is run; the tests themselves fail without it.
browser: install-test
	@if command -v chromium || command -v chromium-browser || command -v google-chrome; then \
	    sh tools/install.sh $(VENV) browser && sh tools/install.sh $(VENV) docs && $(BIN)/python -m pytest -m browser $(TEST_OPTIONS) tests/explorer; \
	else echo "The tests in a browser were not run: there is no Chromium (apt-get install chromium)."; fi

# -- what a contributor types --------------------------------------------------------------------------------

check: static test slow long

# SAME=--environment=NAME=VALUE compares the same code with a variable and without.
same: install-dev
	$(BIN)/python -m tools.same --revision $(or $(REVISION),HEAD) $(SAME)

noise: install-dev
	$(BIN)/python -m tools.same --environment CONTWALK_NOISE=1 --counts 0.05
	$(BIN)/python -m tools.same --environment CONTWALK_NOISE=2 --counts 0.05

trial: install-test
	$(BIN)/python -m tools.trial --share $(or $(SHARE),0.25) --seed $(or $(SEED),1)

static: install-dev
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

format: install-dev
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

bench: install-bench
	$(BIN)/python benchmarks/equilibria.py
	$(BIN)/python benchmarks/orbit_and_monodromy.py
	$(BIN)/python benchmarks/cascade.py

dist: install-dev
	sh tools/install.sh $(VENV) dist
	rm -rf dist build/lib build/bdist*
	@mkdir dist && $(BIN)/python -m build --no-isolation --outdir dist . >dist/log 2>&1 || { cat dist/log; exit 1; }
	@rm dist/log && ls -l dist

# The libraries that it depends on are those of the development environment; WHEEL=--real gets them, and measures.
wheel: dist
	$(BIN)/python -m tools.wheel $(WHEEL)

# What of docs/ is written from the code (tests compare it), then the site with the index of its search.
docs: install
	$(BIN)/python -m tools.house
	sh tools/install.sh $(VENV) docs
	$(BIN)/python -m tools.site

gallery: install
	$(BIN)/python -m tools.gallery

# The pictures of the README and the overview.
docs-image: demo
	$(BIN)/contwalk continue runs/autobalancer_cascade.yaml --set mark=null --output $(DEMO)/autobalancer_cascade.h5 --force
	$(BIN)/contwalk continue runs/planar_slope.yaml --output $(DEMO)/planar_slope.h5 --force
	cp $(DEMO)/autobalancer_load_bifurcation_diagram.png docs/images/autobalancer_load.png
	cp $(DEMO)/autobalancer_cascade_bifurcation_diagram.png docs/images/autobalancer_cascade.png
	cp $(DEMO)/planar_slope_bifurcation_diagram.png docs/images/planar_slope.png
	cp $(DEMO)/planar_slope_stick_figure.png docs/images/planar_walker.png

clean:
	rm -rf $(VENV) $(DEMO) build dist *.egg-info .pytest_cache .mypy_cache .ruff_cache .hypothesis .import_linter_cache
