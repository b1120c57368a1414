# `make` sets up and regenerates the committed models; `make test` sets up and runs every test.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
READY := $(VENV)/.derive-ready
SMOKE := .smoke
BENCH := .bench
# Where bytecode may not be written, each of the hundreds of processes that tests start compiles derive again.
export PYTHONDONTWRITEBYTECODE :=

.PHONY: all setup models test test-sweep test-release test-pages test-robots test-toolbox test-fast check errata generated-check verify-generated messages bench golden wheel wheel-smoke docs system-packages clean

all: models

setup: $(READY)

# The stamp, not the folder: an interrupted set-up starts again.
$(READY): pyproject.toml constraints.txt
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "derive needs Python 3.11 or newer: make PYTHON=/path/to/python3.11")'
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --constraint constraints.txt --editable '.[handout,motion,exchange,data,test,dev]'
	@touch $(READY)

models: $(READY)
	$(BIN)/derive build --jobs 2 --force

# Some five minutes on two cores.
test: $(READY)
	$(BIN)/python -m pytest -n 2 --dist worksteal -m 'not sweep and not release and not pages and not robots and not toolbox'

# More robots of the same kinds; with BASE=REVISION those that what has changed since can reach. CI takes a share.
test-sweep: $(READY)
	files=$$($(BIN)/python -m tests.reach $(BASE)) && DERIVE_REACHED=$$files $(BIN)/python -m pytest -n 2 --dist worksteal -m sweep $$files

# All cases with seeds that nobody has seen, all robots in all documents, interrupts at many moments: more than an hour, before a release.
test-release: $(READY)
	DERIVE_NEW_EXAMPLES=$$(date +%s) $(BIN)/python -m pytest -n 2 --dist worksteal -m 'sweep or release'

# Every command that docs/ shows, a minute: CI runs them.
test-pages: $(READY)
	$(BIN)/python -m pytest -n 2 -m pages tests/docs

# All chains of two packages of URDFs, 180 MB: CI runs them.
test-robots: $(READY)
	$(BIN)/python -m pip install --quiet --no-deps --constraint constraints.txt example-robot-data rtb-data
	$(BIN)/python -m pytest -n 2 --dist worksteal -m robots tests/exchange

# Scripts and profiles of motions in roboticstoolbox itself, half a minute: CI runs them.
test-toolbox: $(READY)
	$(BIN)/python -m pip install --quiet --constraint constraints.txt roboticstoolbox-python
	DERIVE_REQUIRE_TOOLBOX=1 $(BIN)/python -m pytest -m toolbox tests/exchange/test_scripts.py tests/bench/test_trajectories.py

test-fast: $(READY)
	$(BIN)/python -m pytest -n 2 --dist worksteal -m 'not slow and not sweep and not release and not pages and not robots and not toolbox'

check: $(READY)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

errata: $(READY)
	$(BIN)/python -m tests.docs.errata

# The texts of the handout, for translators.
messages: $(READY)
	$(BIN)/python -m tests.docs.messages

generated-check: $(READY)
	$(BIN)/derive build --check --jobs 2

# The committed models, as they are, against the independent recursion.
verify-generated: $(READY)
	$(BIN)/python -m tests.generated.verify

# Operation counts and times side by side with other tools, in an environment of their own: about ten minutes.
# `make bench QUICK=--quick` leaves out the slow ones. Solvers of inverse kinematics that have no wheel here are named as not installed.
bench: $(BENCH)/.ready
	$(BENCH)/bin/python -m bench.trajectories
	$(BENCH)/bin/python -m bench $(QUICK)

$(BENCH)/.ready: pyproject.toml constraints.txt
	$(PYTHON) -m venv $(BENCH)
	$(BENCH)/bin/python -m pip install --quiet --constraint constraints.txt --editable '.[bench]'
	-$(BENCH)/bin/python -m pip install --quiet --constraint constraints.txt '.[bench-inverse]'
	@touch $@

# Digests of all that derive writes, some three minutes; with BASE=REVISION what differs from that revision's.
golden: $(READY)
	$(BIN)/python bench/golden.py $(if $(BASE),--base $(BASE))

# The documentation as a site, in docs/_build/html; the gallery of the built-in robots is drawn by derive itself.
docs: $(READY)
	$(BIN)/python -m pip install --quiet --constraint constraints.txt --editable '.[handout,docs]'
	$(BIN)/python docs/gallery.py
	$(BIN)/python -m sphinx -W --keep-going -q -j 2 docs docs/_build/html

# What tests of PDFs, pages and C models need beyond Python: Debian's packages.
system-packages:
	@.ci/packages

wheel: $(READY)
	rm -rf dist
	PIP_CONSTRAINT=constraints.txt $(BIN)/python -m build --outdir dist

# From an empty environment and an empty folder, as a user meets it: only what the wheel brings.
wheel-smoke: wheel
	rm -rf $(SMOKE)
	$(PYTHON) -m venv $(SMOKE)/venv
	$(SMOKE)/venv/bin/python -m pip install --quiet --constraint constraints.txt dist/*.whl
	cd $(SMOKE) && venv/bin/derive build scara-perugia --out out --quiet
	cd $(SMOKE)/out && ../venv/bin/python -c 'import scara_perugia.model_numpy as m; print(m.forward_kinematics.__name__, m.DOF)'
	cd $(SMOKE) && venv/bin/derive move scara-pick-and-place --csv move.csv --html move.html --out code && test -s move.html
	$(SMOKE)/venv/bin/python -m pip install --quiet --constraint constraints.txt "$$(echo dist/*.whl)[handout,motion,exchange]"
	cd $(SMOKE) && venv/bin/derive export scara-matlab --format urdf -o arm.urdf && venv/bin/derive import arm.urdf -o arm.yaml
	cd $(SMOKE) && venv/bin/derive verify arm.yaml && venv/bin/derive export puma560-corke --format mjcf --inertia possible -o puma.xml
	cd $(SMOKE) && venv/bin/derive move scara-pick-and-place --simulate --plot move.svg && test -s move.svg
	cd $(SMOKE) && venv/bin/derive handout scara-perugia --html --lang it --out handout && test -s handout/scara-perugia.html
	rm -rf $(SMOKE)

clean:
	rm -rf dist $(SMOKE) bench/.build docs/_build docs/bench docs/contributing.md docs/gallery .pytest_cache .mypy_cache .ruff_cache .import_linter_cache .hypothesis
