# `make` lists the targets. A machine needs python3 (3.11 or later), pip and make; everything else is installed here.

PYTHON ?= python3
VENV   := .venv
BIN    := $(VENV)/bin
PIP    := $(BIN)/python -m pip --disable-pip-version-check install --quiet --constraint constraints.txt

.DEFAULT_GOAL := help
.PHONY: help demo test check figures bench docs conformance laws mutants fuzz crashes races damage soak swaps nets chaos defects schedules clean denseness

help:  ## list the targets
	@grep -hE '^[a-z]+:.*##' $(MAKEFILE_LIST) | sed -E 's/^([a-z]+):.*## */  make \1\t/' | expand -t 22

demo: $(VENV)/demo.done  ## a robot kits while its program is being rewritten; figures and a table in out/demo
	$(BIN)/python -m planner_reactor.experiments.demo --out out/demo

test: $(VENV)/dev.done  ## every test (a few minutes)
	$(BIN)/python -m pytest -n 2

check: $(VENV)/dev.done  ## lint, types, direction of imports
	$(BIN)/ruff check src tests examples benchmarks
	$(BIN)/python -m mypy
	$(BIN)/lint-imports --no-logo

figures: $(VENV)/demo.done  ## the papers' figures, as PNG and SVG, in out/figures
	$(BIN)/planner-reactor experiment papers --out out/figures

bench: $(VENV)/bench.done  ## our figures beside those of our peers, in one run
	$(BIN)/planner-reactor bench --peers

docs: $(VENV)/dev.done  ## the pages of docs/ that are made from code
	$(BIN)/python -m pytest -q tests/test_docs.py tests/test_examples.py

conformance: $(VENV)/dev.done  ## a million random programs, executer against semantics; resumes where it stopped
	$(BIN)/python -m tests.conformance

laws: $(VENV)/dev.done  ## each law on 10,000 random terms, under every equivalence
	LAW_TERMS=10000 $(BIN)/python -m pytest -n 2 tests/rs/test_laws.py

mutants: $(VENV)/dev.done  ## every small change to the rules meets the tests; the table of docs/analysis.md
	nice -n 10 $(BIN)/python -m tests.mutants

fuzz: $(VENV)/dev.done  ## a million hostile texts, journals, frames and adaptations; resumes where it stopped
	nice -n 10 $(BIN)/python -m tests.fuzz

crashes: $(VENV)/dev.done  ## crash, power loss and cut link at every step of adaptations of every shape; resumes
	nice -n 10 $(BIN)/python -m tests.crashes

damage: $(VENV)/dev.done  ## a journal of a thousand adaptations, cut at every byte and with every bit flipped
	nice -n 10 $(BIN)/python -m tests.reactor.damage

races: $(VENV)/dev.done  ## an adaptation, a failure and HALT at one instant of a reactor, in every order; resumes
	nice -n 10 $(BIN)/python -m tests.reactor.races

soak: $(VENV)/dev.done  ## a million situations: no byte, thread or file of one stays behind
	nice -n 10 $(BIN)/python -m tests.soak

swaps: $(VENV)/dev.done  ## a million swaps of segments in a running reactor of 10,000 processes; goes on where it stopped
	nice -n 10 $(BIN)/python benchmarks/bench_swap.py

nets: $(VENV)/dev.done  ## a thousand random nets, each also searched by SPIN (half an hour; needs spin and gcc)
	SPIN_NETS=1000 $(BIN)/python -m pytest -q -s tests/analysis/test_networks.py -k each_random_net

denseness: $(VENV)/dev.done  ## 100,000 random timed runs against the bounds of denseness; goes on where it stopped
	nice -n 10 $(BIN)/python -m tests.analysis.timed_runs

chaos: $(VENV)/dev.done  ## ten minutes of faults on two processes, inside adaptations too; goes on where it stopped
	nice -n 10 $(BIN)/python -m planner_reactor.simulation

schedules: $(VENV)/dev.done  ## a million random schedules of failures and returns on the planner; goes on where it stopped
	nice -n 10 $(BIN)/python -m tests.schedules

defects: $(VENV)/dev.done  ## every defect meets chaos until a law catches it; the table of docs/defects.md; resumes
	nice -n 10 $(BIN)/python -m tests.defects --workers 2

clean:  ## forget what was made
	rm -rf out $(VENV) .pytest_cache .mypy_cache .ruff_cache .hypothesis .import_linter_cache

$(VENV)/made:
	$(PYTHON) -m venv $(VENV)
	@touch $@

$(VENV)/demo.done: $(VENV)/made pyproject.toml constraints.txt
	$(PIP) -e '.[figures]'
	@touch $@

$(VENV)/dev.done: $(VENV)/made pyproject.toml constraints.txt
	$(PIP) -e '.[dev]'
	@touch $@

$(VENV)/bench.done: $(VENV)/made pyproject.toml constraints.txt
	$(PIP) -e '.[bench]'
	@touch $@
