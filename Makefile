# Everything is installed into .venv; no target touches the system but `referees`.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
PACKAGE := $(VENV)/.package
TOOLS := $(VENV)/.tools

.PHONY: install demo test test-fast lint types referees test-referees test-fuzz test-long chain clean

install: $(PACKAGE) $(TOOLS)

# What a user needs, about 800 MB; all that the demo takes.
$(PACKAGE): pyproject.toml
	$(PYTHON) -m venv $(VENV)
	$(BIN)/pip install --quiet --upgrade "pip>=25.1"
	$(BIN)/pip install --quiet --editable .
	touch $@

# What the tests and the developers need besides.
$(TOOLS): $(PACKAGE)
	$(BIN)/pip install --quiet --group test --group lint
	touch $@

demo: $(PACKAGE)
	$(BIN)/uvshear demo uvshear-demo --overwrite

lint: install
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/lint-imports

types: install
	$(BIN)/mypy

test: lint types
	$(BIN)/pytest -n auto -m "not referee and not long and not fuzz"

# Less than a minute: neither the slow tests nor those that need other programs.
test-fast: install
	$(BIN)/pytest -n auto -m "not slow and not referee and not long and not fuzz"

# Five thousand mutated inputs: an hour of one core.
test-fuzz: install
	$(BIN)/pytest -n auto -m fuzz

# The only target that installs Debian packages (wsclean), and it needs root for that.
referees: install
	command -v wsclean >/dev/null || { apt-get update -q && apt-get install -y -q wsclean; }
	$(BIN)/pip install --quiet --group referees

# The tests of a group use the same files, which are made once.
test-referees: referees
	$(BIN)/pytest -n auto --dist loadgroup -m "referee and not long and not fuzz"

# Several minutes each.
test-long: referees
	$(BIN)/pytest -n auto -m long

# simulate, wsclean, PyBDSF, measure, shear: the shapes from a source finder's catalogue beside those from the true one.
chain: referees
	$(BIN)/python benchmarks/chain.py uvshear-chain --overwrite

clean:
	rm -rf $(VENV) uvshear-demo uvshear-chain
