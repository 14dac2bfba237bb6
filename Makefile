# make demo: install, then lint → record → compare → repair on examples/shuttle
# make test: install, then lint, types, import contracts, tests and the demo
# make docs: the documentation site in build/site; docs-assets fetches the fonts and scripts that it ships, once
# make test-docs: the whole site and a report page in a browser, with axe
# make test-ros1, make test-ros2: the examples and the probes on a real ROS, in an environment of its own

PYTHON ?= python3
VENV ?= .venv
BIN := $(VENV)/bin
PROCESSES ?= 2

# Tests start hundreds of Python processes: without cached bytecode each one compiles pytest and tarl again
unexport PYTHONDONTWRITEBYTECODE
INSTALLED := $(VENV)/.installed

.PHONY: demo test check unit suite test-editor setup docs docs-assets test-docs clean bench-paper bench-drift

demo: setup
	@BIN="$(abspath $(BIN))" sh examples/demo.sh

test: check demo unit

check: setup
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/lint-imports

unit: test-editor suite

suite: setup
	$(BIN)/python -m pytest -q --timeout 240 --numprocesses $(PROCESSES)

# The language server is tested by itself: its tests need asyncio, which the others run without
test-editor: setup
	$(BIN)/python -m pytest -q -c tests/editor/pytest.ini --rootdir . --timeout 120 tests/editor

docs: setup
	$(BIN)/python -m website.build

docs-assets: setup
	$(BIN)/python -m website.build --fetch

test-docs: docs docs-assets
	TARL_SITE=build/site $(BIN)/python -m pytest -q tests/site tests/plugin/report/test_browser.py

setup: $(INSTALLED)

$(INSTALLED): pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 10))' || \
		{ echo "tarl needs Python 3.10 or newer; name one: make $(MAKECMDGOALS) PYTHON=python3.12"; exit 1; }
	@$(PYTHON) -m venv $(VENV) || \
		{ echo "$(PYTHON) cannot make a virtual environment; on Debian and Ubuntu: apt-get install python3-venv"; exit 1; }
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --upgrade pip uv
	@$(BIN)/uv pip install --quiet --python $(BIN)/python --editable ".[dev]" || \
		{ echo "uv could not install the packages; pip tries, which takes a minute longer"; \
		$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable ".[dev]"; }
	@touch $@

# The same test bodies on a real ROS, each in an environment of its own; see docs/real-ros.md
ROS1_PYTHON ?= /usr/bin/python3
ROS1_VENV ?= .venv-ros1
ROS1_PACKAGES := python3-rospy python3-rosmaster python3-std-msgs python3-geometry-msgs python3-nav-msgs python3-sensor-msgs python3-rosgraph-msgs python3-diagnostic-msgs
ROS2_VENV ?= .venv-ros2
ROS2_WHEELS := 'ros-rclpy[fastrtps]==9.1.2' ros-geometry-msgs==5.5.1 ros-nav-msgs==5.5.1 ros-sensor-msgs==5.5.1 ros-diagnostic-msgs==5.5.1 ros-std-srvs==5.5.1
ROS_TOOLS := pymunk hypothesis pytest-xdist
# Sockets that rospy leaves to the garbage collector are no failure of a test
ROS_LEAVES := -W "ignore:Exception ignored in:pytest.PytestUnraisableExceptionWarning" \
	-W "ignore:unclosed <socket:ResourceWarning"
PIP_INSTALL := -m pip install --quiet --disable-pip-version-check

.PHONY: test-ros1 test-ros2 setup-ros1 setup-ros2

setup-ros1: $(ROS1_VENV)/.installed

setup-ros2: $(ROS2_VENV)/.installed

test-ros1: setup-ros1
	$(ROS1_VENV)/bin/python -m pytest -q $(ROS_LEAVES) tests/realros

test-ros2: setup-ros2
	$(ROS2_VENV)/bin/python -m pytest -q $(ROS_LEAVES) tests/realros

$(ROS1_VENV)/.installed: pyproject.toml
	@$(ROS1_PYTHON) -c 'import rospy, rosmaster, nav_msgs, diagnostic_msgs' || \
		{ echo "$(ROS1_PYTHON) has no rospy; on Debian: apt-get install $(ROS1_PACKAGES)"; exit 1; }
	@$(ROS1_PYTHON) -m venv --system-site-packages $(ROS1_VENV)
	$(ROS1_VENV)/bin/python $(PIP_INSTALL) --editable ".[ros,report]" $(ROS_TOOLS)
	@touch $@

$(ROS2_VENV)/.installed: pyproject.toml
	@$(PYTHON) -m venv $(ROS2_VENV)
	$(ROS2_VENV)/bin/python $(PIP_INSTALL) $(ROS2_WHEELS)
	$(ROS2_VENV)/bin/python $(PIP_INSTALL) --editable ".[mujoco,ros,report]" $(ROS_TOOLS)
	@touch $@

# Small faults sown into a package, ten in each of its packages: how many do the tests catch? Nightly
.PHONY: mutants
mutants: setup
	$(BIN)/python benchmarks/mutants.py --forks --slowest 6 --budget 30 --of $${OF:-pytest_tarl} --seed $${SEED:-0}

bench-paper: setup
	$(BIN)/python benchmarks/paper.py

# FauxPy pins other plugins of pytest, so it lives in an environment of its own
FAUXPY_VENV ?= .venv-fauxpy

$(FAUXPY_VENV)/.installed: pyproject.toml
	@$(PYTHON) -m venv $(FAUXPY_VENV)
	$(FAUXPY_VENV)/bin/python $(PIP_INSTALL) --editable ".[ros]" fauxpy
	@touch $@

bench-drift: setup $(FAUXPY_VENV)/.installed
	$(BIN)/python $(PIP_INSTALL) cma optuna
	$(BIN)/python benchmarks/drift/run.py --fauxpy $(abspath $(FAUXPY_VENV))/bin/python

clean:
	rm -rf $(VENV) $(ROS1_VENV) $(ROS2_VENV) $(FAUXPY_VENV) .mypy_cache .pytest_cache .ruff_cache .import_linter_cache
	find . -name __pycache__ -not -path './.venv/*' -prune -exec rm -rf {} +
	rm -rf examples/*/.tarl
