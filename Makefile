# The two commands of the README are `make run` and `make test`; `make setup` installs what either needs.
PYTHON ?= $(shell for p in python3 python3.14 python3.13 python3.12 python3.11; do \
	$$p -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null && echo $$p && break; done)
BIN := .venv/bin
SERVICE := .venv/.service
TESTS := .venv/.tests
DOCS := .venv/.docs
BENCH := .venv/.bench
# Sessions are small matrices: several threads of BLAS only get in each other's way.
export OPENBLAS_NUM_THREADS ?= 1
# Without its bytecode every process that is started compiles all of imu-health anew, and pytest all tests.
unexport PYTHONDONTWRITEBYTECODE

# Tests wait now and then, for a browser or a process: one worker more than cores keeps these at work.
WORKERS ?= $(shell n=$$(nproc 2>/dev/null || echo 2); echo $$((n < 7 ? n + 1 : 8)))

.PHONY: setup run test test-all lint format words bench papers study backtest dates stands tails lives fuzz-numbers pictures docs browser lock clean

setup: $(TESTS)

# uv takes seconds where pip takes minutes; where only pip knows the way to the packages, pip installs them.
# Compiled now, or the first start would compile everything.
define install
$(BIN)/uv pip install --quiet --compile-bytecode --python $(BIN)/python $(1) \
	|| $(BIN)/pip install --quiet --disable-pip-version-check $(1)
endef

$(SERVICE): requirements.lock pyproject.toml
	@test -n "$(PYTHON)" || { echo "imu-health needs Python 3.11 or newer" >&2; exit 1; }
	@echo "Setting up .venv, once: installing what the service needs, about half a minute."
	@$(PYTHON) -m venv .venv
	@$(BIN)/pip install --quiet --disable-pip-version-check --constraint requirements.lock uv
	@$(call install,-r requirements.lock)
	@$(call install,--no-deps --no-build-isolation -e .)
	@touch $@

$(TESTS): $(SERVICE) requirements-test.lock
	@echo "Installing what the tests need besides, once: another half a minute."
	@$(call install,-r requirements-test.lock)
	@touch $@

run: $(SERVICE)
	@$(BIN)/imu-health serve --demo

browser:
	@sh tests/install_chromium.sh

# Every service that a test starts has threads of its own, and each thread would keep memory for itself; so would polars.
test test-all: export MALLOC_ARENA_MAX ?= 2
test test-all: export _RJEM_MALLOC_CONF ?= dirty_decay_ms:0,muzzy_decay_ms:0
test test-all: setup browser
	$(BIN)/python -m compileall -q -j 0 estimator service benchmarks
	$(PYTEST)

# What a change is judged by, and everything there is, on both databases.
test: PYTEST := $(BIN)/pytest -n $(WORKERS) --dist worksteal
test-all: PYTEST := ENGINES=both $(BIN)/pytest -n $(WORKERS) --dist worksteal -m ""

lint: setup
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy

format: setup
	$(BIN)/ruff format .
	$(BIN)/ruff check --fix .

words: setup
	$(BIN)/python -m service.languages

bench: $(BENCH)
	$(BIN)/python -m benchmarks $(if $(ONLY),--only $(ONLY))

# A rival is installed for comparison only.
$(BENCH): $(TESTS) requirements-bench.lock
	$(call install,-r requirements-bench.lock)
	touch $@

papers: setup
	$(BIN)/python -m benchmarks.papers

study: $(BENCH)
	$(BIN)/python -m benchmarks.study --sessions 4650 --seed 2611
	$(BIN)/python -m benchmarks.study.neural --minutes 60
	$(BIN)/python -m benchmarks.study.detection --sessions 84 --sound 400 --seed 2 --network build/neural.npz
	$(BIN)/python -m benchmarks.study.amplitudes --sessions 660 --seed 3
	$(BIN)/python -m benchmarks.study.open_world --sessions 12 --seed 1
	$(BIN)/python -m benchmarks.study.seen --seed 1
	$(BIN)/python -m benchmarks.study.groups --groups 300 --seed 8
	$(BIN)/python -m benchmarks.study.between_sessions --units 40 --seed 1
	$(BIN)/python -m benchmarks.study.with_history --groups 53 --seed 1

backtest: setup
	$(BIN)/python -m benchmarks.backtest --seed 9

dates: setup
	$(BIN)/python -m benchmarks.backtest.dates --seed 9

stands: setup
	$(BIN)/python -m benchmarks.stands

tails: setup
	$(BIN)/python -m benchmarks.tails

fuzz-numbers: setup
	$(BIN)/python -m benchmarks.fuzz.numbers

# Whole lives of a running service by chance, on both databases side by side.
MINUTES ?= 60
lives: setup
	$(BIN)/python -m tests.lives --minutes $(MINUTES)

pictures: setup browser
	IMU_HEALTH_PICTURES=1 $(BIN)/pytest tests/end_to_end/browser/test_pictures.py tests/docs

docs: $(DOCS)
	$(BIN)/python -m docs.site

$(DOCS): $(TESTS) requirements-docs.lock
	$(call install,-r requirements-docs.lock)
	touch $@

# Each lock adds to the ones before it.
COMPILE := $(BIN)/uv pip compile --quiet --upgrade --no-emit-index-url --no-header --no-annotate pyproject.toml
lock: setup
	$(COMPILE) --extra setup --extra logs --extra oidc --extra sign -o requirements.lock
	$(COMPILE) --constraint requirements.lock --extra test | grep -vxFf requirements.lock > requirements-test.lock
	mkdir -p build && cat requirements.lock requirements-test.lock > build/both.lock
	$(COMPILE) --constraint build/both.lock --extra docs | grep -vxFf build/both.lock > requirements-docs.lock
	$(COMPILE) --constraint build/both.lock --extra bench | grep -vxFf build/both.lock > requirements-bench.lock

clean:
	rm -rf .venv build dist *.egg-info
