# make demo     install into .venv and write the brake's stability report into out/
# make reports  stability reports on all models of the library, with an index, into out/reports/
# make test     install with test extras; lint, types, import contracts, tests
# make bench    the races of tests/benchmarks; bench-discovery: discover on sealed cases

PYTHON ?= $(shell for p in python3.11 python3 python3.12 python3.13 python3.14; do \
	$$p -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null && echo $$p && break; done)
VENV := .venv
BIN := $(VENV)/bin
PIP := $(BIN)/python -m pip --disable-pip-version-check --quiet
JOBS ?= 2
ARGS ?=

# Without bytecode sympy alone costs seconds at every start.
unexport PYTHONDONTWRITEBYTECODE

.DEFAULT_GOAL := help
.PHONY: help demo reports test lint types imports pytest format bench bench-discovery clean distclean

help:
	@sed -n 's/^# //p' Makefile | head -4

demo: $(VENV)/.installed
	$(BIN)/bondgraph stability bicycle_brake --report out/
	@for page in out/*.html; do test -s "$$page" && echo "report: $(CURDIR)/$$page" || exit 1; done

reports: $(VENV)/.installed
	$(BIN)/bondgraph reports out/reports

test: lint types imports pytest

lint: $(VENV)/.test
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

types: $(VENV)/.test build/types
	cd build/types && ../../$(BIN)/mypy --config-file ../../pyproject.toml \
		--cache-dir ../../.mypy_cache -p bondgraph

imports: $(VENV)/.test build/types
	cd build/types && ../../$(BIN)/lint-imports --config ../../pyproject.toml --no-cache --no-logo

pytest: $(VENV)/.test
	$(BIN)/python -m pytest -n $(JOBS) $(ARGS)

format: $(VENV)/.test
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

bench: $(VENV)/.test
	$(BIN)/python -m tests.benchmarks $(ARGS)

bench-discovery: $(VENV)/.test
	$(BIN)/python -m tests.benchmarks discovery --jobs $(JOBS) $(ARGS)

# The tree as it is once installed, for tools that cannot follow setuptools' package-dir mapping.
.PHONY: build/types
build/types:
	@rm -rf $@ && mkdir -p $@/bondgraph
	@cd $@/bondgraph && ln -s ../../../bondgraph/* ../../../models ../../../codegen .

# The install is editable: sources count at once, only pyproject.toml asks for another install.
$(VENV)/.installed: pyproject.toml | $(VENV)/.python
	$(PIP) install --editable .
	@touch $@

$(VENV)/.test: pyproject.toml | $(VENV)/.python
	$(PIP) install --editable '.[test]'
	@touch $@ $(VENV)/.installed

$(VENV)/.python:
	@test -n "$(PYTHON)" || { echo "halfarrow needs Python 3.11 or newer and found none:" \
		"name one with 'make PYTHON=/path/to/python3.11 ...'" >&2; exit 1; }
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { echo "halfarrow needs" \
		"Python 3.11 or newer: '$(PYTHON)' is older or does not run" >&2; exit 1; }
	@$(PYTHON) -c 'import ensurepip, venv' || { echo "halfarrow needs Python's venv module" \
		"(Debian, Ubuntu: apt-get install python3-venv)" >&2; exit 1; }
	$(PYTHON) -m venv --clear $(VENV)
	@touch $@

clean:
	rm -rf build dist out *.egg-info .mypy_cache .ruff_cache .pytest_cache .hypothesis
	find bondgraph models codegen tests docs -name __pycache__ -prune -exec rm -rf {} + 2>/dev/null; true

distclean: clean
	rm -rf $(VENV)
