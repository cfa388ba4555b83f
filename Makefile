# Everything is installed into .venv; no target touches the system but `referees`.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
INSTALLED := $(VENV)/.installed

.PHONY: install demo test lint referees test-referees chain clean

install: $(INSTALLED)

$(INSTALLED): pyproject.toml
	$(PYTHON) -m venv $(VENV)
	$(BIN)/pip install --quiet --upgrade "pip>=25.1"
	$(BIN)/pip install --quiet --editable . --group test --group lint
	touch $@

demo: install
	$(BIN)/uvshear demo uvshear-demo --overwrite

lint: install
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

test: lint
	$(BIN)/pytest -n 2 -m "not referee"

# The only target that installs Debian packages (wsclean), and it needs root for that.
referees: install
	command -v wsclean >/dev/null || { apt-get update -q && apt-get install -y -q wsclean; }
	$(BIN)/pip install --quiet --group referees

test-referees: referees
	$(BIN)/pytest -m referee

# simulate, wsclean, PyBDSF, measure, shear: what comes of a source finder's catalogue, against the true one.
chain: referees
	$(BIN)/python benchmarks/chain.py uvshear-chain --overwrite

clean:
	rm -rf $(VENV) uvshear-demo uvshear-chain
