# Two commands matter: `make demo` and `make test`. Each sets itself up: all they need is make and Python 3.11 or newer.

# The first that runs and is new enough: version managers leave names on the path that do not run.
PYTHON ?= $(shell for name in python3.13 python3.12 python3.11 python3.14 python3 python; do \
	"$$name" -c 'import sys, venv; sys.exit(sys.version_info < (3, 11))' >/dev/null 2>&1 && { command -v "$$name"; break; }; done)
VENV ?= .venv
ROOM ?= examples/room
BIN := $(VENV)/bin

.DEFAULT_GOAL := help
.PHONY: help demo test lint format bench docs soak contract clean

help: ## what can be made
	@grep -hE '^[a-z]+:.*## ' $(MAKEFILE_LIST) | sed -E 's/^([a-z]+):.*## /\1|/' | column -t -s '|'

demo: $(VENV)/.ready ## survey and locate in the real service: make demo [ROOM=path]
	@$(BIN)/scattermark demo "$(ROOM)"

# Two processes on two cores: algebra in threads would be waited for in loops, at three times the processor time.
test: lint ## lint, types and the test suite
	@OPENBLAS_NUM_THREADS=1 $(BIN)/python -m pytest -n 2 --dist loadfile --no-loadscope-reorder

lint: $(VENV)/.ready-test ## ruff and mypy
	@$(BIN)/ruff check .
	@$(BIN)/ruff format --check .
	@$(BIN)/mypy

format: $(VENV)/.ready-test ## let ruff format and mend
	@$(BIN)/ruff check --fix .
	@$(BIN)/ruff format .

bench: $(VENV)/.ready-bench ## accuracy and speed of a room with truth, and of others on it: make bench [ROOM=path]
	@$(BIN)/python -m benchmarks.accuracy "$(ROOM)"
	@$(BIN)/python -m benchmarks.speed --peers "$(ROOM)"

docs: $(VENV)/.ready-test ## the documents as a site, in site/
	@$(BIN)/mkdocs build --strict

soak: $(VENV)/.ready-test ## hours of malformed images, watched memory and twice the load: make soak [SOAK="--mutants 10000 --minutes 5"]
	@$(BIN)/python -m benchmarks.soak $(SOAK) "$(ROOM)"

contract: $(VENV)/.ready-test ## many requests by the OpenAPI document, other ones each time: make contract [EXAMPLES=300]
	@SCATTERMARK_CONTRACT_EXAMPLES=$(or $(EXAMPLES),300) $(BIN)/python -m pytest tests/contract

clean: ## remove the virtual environment and caches
	rm -rf $(VENV) .pytest_cache .mypy_cache .ruff_cache .hypothesis benchmarks/out

# The stamps make the set-up happen once, and again when the dependencies change.
$(VENV)/.ready: pyproject.toml
	@test -n "$(PYTHON)" || { echo "No Python 3.11 or newer found that runs: install one, or say make PYTHON=/path/to/python." >&2; exit 1; }
	@"$(PYTHON)" -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { echo "$(PYTHON) is older than Python 3.11: install a newer one, or say make PYTHON=/path/to/python." >&2; exit 1; }
	@echo "Setting up $(VENV) with $(PYTHON) (once), and compiling the measuring loops for this machine" >&2
	@"$(BIN)/python" -c 'import ssl, venv' 2>/dev/null || "$(PYTHON)" -m venv --clear "$(VENV)" || { echo "$(PYTHON) cannot make a virtual environment: install its venv module (Debian and Ubuntu: apt install python3-venv)." >&2; exit 1; }
	@"$(BIN)/python" -m pip install --quiet --disable-pip-version-check --editable .
	@"$(BIN)/scattermark" compile
	@touch $@

$(VENV)/.ready-test: $(VENV)/.ready
	@echo "Installing the test tools (once)" >&2
	@"$(BIN)/python" -m pip install --quiet --disable-pip-version-check --editable '.[test]'
	@"$(BIN)/python" -m tests.web.chromium >/dev/null
	@touch $@

$(VENV)/.ready-bench: $(VENV)/.ready
	@echo "Installing the readers to compare with (once)" >&2
	@"$(BIN)/python" -m pip install --quiet --disable-pip-version-check --editable '.[bench]'
	@touch $@
