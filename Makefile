# One command for everything; each target installs what it needs first.
PYTHON ?= python3
VENV ?= .venv
BIN := $(VENV)/bin
OUT ?= runs/quick
READY := $(VENV)/.ready
PEERS := .venv-peers
STEP := $(PYTHON) .ci/step.py
PIP := $(BIN)/python -m pip install --no-compile -c constraints.txt

.PHONY: setup run test test-all soak wheels check lint types layers docs bench bench-check clean

setup: $(READY)  ## .venv with everything, at the versions of constraints.txt

$(READY): pyproject.toml setup.py constraints.txt
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "benchnav needs Python 3.11 or newer, this is " + sys.version)'
	@$(STEP) 'Making the environment $(VENV)' $(PYTHON) -m venv $(VENV)
	@$(STEP) 'Installing pip and setuptools' $(PIP) --upgrade 'pip>=25.1' setuptools
	@$(STEP) 'Installing benchnav (minutes)' $(PIP) -e '.[all]' --group dev
	@touch $@

run: $(READY)  ## the suite `quick`, and its leaderboard
	$(BIN)/benchnav run quick --out $(OUT)
	$(BIN)/benchnav leaderboard $(OUT)

check: lint types layers  ## everything but the tests

lint: $(READY)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	@test ! -x $(BIN)/biome || $(BIN)/biome ci  # JavaScript and CSS; it has wheels for few machines

types: $(READY)
	$(BIN)/mypy benchnav baselines scenarios

layers: $(READY)
	$(BIN)/lint-imports

test: check $(READY)  ## all checks, and all tests but the long ones
	$(BIN)/python -m pytest --numprocesses 2 --dist worksteal -m 'not long and not soak'

test-all: check $(READY)  ## all checks and tests, as CI runs them
	$(BIN)/python -m pytest --numprocesses 3 --dist worksteal -m 'not soak'

soak: $(READY)  ## the same attacks and faults as in CI, with many more cases
	$(BIN)/python -m pytest --numprocesses 2 --dist worksteal -m soak

wheels: $(READY)  ## the built wheel, on every Python that is found
	$(BIN)/python .ci/try_wheels.py

docs: $(VENV)/.docs-ready  ## the documentation site, in build/site; warnings are errors
	$(BIN)/python -m sphinx -j auto -W --keep-going -q -d build/doctrees docs build/site

$(VENV)/.docs-ready: $(READY)
	@$(STEP) 'Installing the site generator' $(PIP) --group docs
	@touch $@

bench: $(READY) $(PEERS)/.ready  ## speed against peers and limits; writes docs/benchmarks.md
	$(BIN)/python -m benchmarks --peers $(PEERS)/bin/python --out docs/benchmarks.md

bench-check: $(READY) $(PEERS)/.ready  ## speed against the kept ratios; fails if one fell by 10 %
	$(BIN)/python -m benchmarks --peers $(PEERS)/bin/python --check

$(PEERS)/.ready: benchmarks/constraints.txt
	@$(STEP) 'Making the environment $(PEERS)' $(PYTHON) -m venv $(PEERS)
	@$(STEP) 'Installing the peers' $(PEERS)/bin/python -m pip install -r benchmarks/constraints.txt
	@touch $@

clean:
	rm -rf $(VENV) $(PEERS) build dist *.egg-info
