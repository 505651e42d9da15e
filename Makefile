# Everything a developer types. Needs Rust 1.95, Python 3.11 or newer with pip, and make.

PYTHON ?= python3

VENV := .venv
BIN := $(VENV)/bin
# The pip outside serves the environment inside: no ensurepip needed.
PIP := $(PYTHON) -m pip --python $(BIN)/python --disable-pip-version-check
CARGO := cargo
# Runs on stable Rust without a sanitizer: there is no unsafe code for one to watch.
CARGO_FUZZ := 0.13.2
FUZZ ?= -max_total_time=60
PYTEST_WORKERS ?= 2
# cargo-fuzz has flags of its own, which replace those of .cargo/config.toml.
WITH_AVX2 := $(if $(filter x86_64,$(shell uname -m)),export RUSTFLAGS=-Ctarget-cpu=x86-64-v3;)
FUZZ_TARGETS ?= study tables record manifest simulate
SOURCES := $(shell find crates python -type f \( -name '*.rs' -o -name '*.py' -o -name '*.pyi' \
	-o -name 'py.typed' -o -name Cargo.toml -o -path '*/web/*' \)) Cargo.toml Cargo.lock pyproject.toml README.md \
	LICENSE-APACHE LICENSE-MIT THIRD-PARTY-NOTICES.txt

# Every cargo call is told of Python what maturin tells its own, so that switching between targets rebuilds nothing.
export PYO3_PYTHON := $(abspath $(BIN)/python)
ifeq ($(shell uname -s),Linux)
export PYO3_CONFIG_FILE := $(abspath .ci/pyo3-config.txt)
export PYO3_BUILD_EXTENSION_MODULE := 1
endif

.DEFAULT_GOAL := help
.PHONY: help demo docs test test-rust test-python lint lint-rust lint-python truth count bench bench-peers bench-sweeps bench-dynamics bench-modes bench-lists bench-terms bench-start weight check-design check-identify check-errors explorer test-explorer bench-explorer stress fuzz corpus wheel sdist reproducible advisories clean

help: ## list the targets
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "  make %-14s %s\n", $$1, $$2 }' $(MAKEFILE_LIST)

demo: wheel ## build, then sweep clearance and mass ratio of the paper's absorber
	$(BIN)/iva sweep studies/siva_clearance.toml --overwrite

test: test-rust test-python ## prove that the code is right

test-rust: $(VENV)/.tools ## the Rust half of `make test`
	$(CARGO) test --locked --release
	$(CARGO) test --locked --lib --package iva-core --package iva-sweep

test-python: wheel ## the Python half of `make test`
	$(BIN)/python -m pytest --numprocesses $(PYTEST_WORKERS) --dist loadfile

lint: lint-rust lint-python ## formats, clippy, ruff, types, stubs, layers, licences

lint-rust: $(VENV)/.tools
	$(CARGO) fmt --all --check
	$(CARGO) fmt --manifest-path tests/fuzz/Cargo.toml --check
	$(CARGO) fmt --manifest-path crates/iva-wasm/Cargo.toml --check
	$(CARGO) clippy --locked --release --workspace --all-targets -- -D warnings
	$(PYTHON) .ci/layers.py
	$(PYTHON) .ci/notices.py
	$(PYTHON) .ci/explorer.py --check

lint-python: wheel
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/mypy
	$(BIN)/python -m mypy.stubtest iva._iva

check-design: wheel ## what iva.optimise promises, beside what it does: values, runs, coverage
	$(BIN)/python tests/truth/designs.py

check-identify: wheel ## what iva.identify promises, beside what it does: three records, coverage
	$(BIN)/python tests/truth/identified.py

check-errors: wheel ## estimates of errors and gradients of 2,000 random scenes of many terms, beside twice the precision
	$(BIN)/python tests/truth/composed.py

explorer: ## build the simulator of the explorer as WebAssembly (without a toolchain for it: on Debian)
	$(PYTHON) .ci/explorer.py

test-explorer: wheel ## drag, type and paste in real browsers (on Debian it installs them)
	$(PYTHON) .ci/browsers.py
	$(BIN)/python -m pytest tests/explorer

bench-explorer: wheel ## how long frames and maps of the explorer take in Chromium
	$(BIN)/python tests/explorer/speed.py

count: $(VENV)/.tools ## count the instructions of fixed scenes, +5 % fails (Linux; installs valgrind)
	$(PYTHON) .ci/instructions.py

bench: $(VENV)/.tools ## measure nanoseconds per impact
	$(CARGO) bench --locked -p iva-benches

truth: wheel ## print all that iva.dynamics computes beside references; TRUTH="--only basins"
	$(BIN)/python tests/truth $(TRUTH)

stress: $(VENV)/.tools ## the long tests: a million extreme scenes, grazings, 10⁸ impacts, kills at random
	$(CARGO) test --locked --release --test all stress -- --ignored --nocapture
	EVERY_CASE=1 $(CARGO) test --locked --release --test all
	EVERY_FAULT=1 $(CARGO) test --locked --release --test all aborted_at_any_step -- --nocapture
	$(MAKE) count
	$(MAKE) fuzz

fuzz: ## any text, bytes and bits as input, a minute a target (needs a C++ compiler)
	test "$$(cargo fuzz --version 2>&1)" = "cargo-fuzz $(CARGO_FUZZ)" \
		|| $(CARGO) install --locked --force cargo-fuzz@$(CARGO_FUZZ)
	$(CARGO) clippy --locked --release --manifest-path tests/fuzz/Cargo.toml --target-dir target/fuzz \
		-- -D warnings
	rm -rf target/fuzz/kept && mkdir -p target/fuzz/kept && tar -xJf tests/fuzz/corpus.tar.xz -C target/fuzz/kept
	$(WITH_AVX2) for target in $(FUZZ_TARGETS); do \
		mkdir -p target/fuzz/corpus/$$target target/fuzz/kept/$$target; \
		$(CARGO) fuzz run --sanitizer none --fuzz-dir tests/fuzz --target-dir target/fuzz $$target \
			target/fuzz/corpus/$$target target/fuzz/kept/$$target $$(ls -d tests/fuzz/seeds/$$target 2> /dev/null) \
			studies -- -timeout=20 $(FUZZ) || exit 1; \
	done

corpus: ## keep what `make fuzz` has found, as few inputs as reach as much
	$(WITH_AVX2) for target in $(FUZZ_TARGETS); do \
		cp -n target/fuzz/kept/$$target/* target/fuzz/corpus/$$target 2> /dev/null; \
		$(CARGO) fuzz cmin --sanitizer none --fuzz-dir tests/fuzz --target-dir target/fuzz $$target \
			target/fuzz/corpus/$$target -- -use_counters=0 || exit 1; \
	done
	tar --sort=name --mtime=@0 --owner=0 --group=0 --numeric-owner -C target/fuzz/corpus -c . \
		| xz -9e > tests/fuzz/corpus.tar.xz

bench-peers: target/bench/.installed ## compare accuracy and run time with other integrators
	target/bench/bin/python benches/work_precision.py

bench-sweeps: target/bench/.installed ## compare sweeps with those of other integrators; threads, overhead
	target/bench/bin/python benches/compare_peers.py
	$(CARGO) bench --locked -p iva-benches --bench overhead -- 1e6

bench-dynamics: target/bench/.installed ## compare orbits, branches, diagrams and basins with programs by hand
	target/bench/bin/python benches/compare_dynamics.py

bench-modes: target/bench/.installed ## compare five masses on 20 modes with MuJoCo and Siconos, where they are installed
	target/bench/bin/python benches/compare_modes.py --python=python3

bench-lists: target/bench/.installed ## compare lists of absorbers, and a dashpot in the gap, with SciPy
	target/bench/bin/python benches/compare_lists.py

bench-terms: target/bench/.installed ## compare springs, dashpots, friction, lists, modes, pendulums and stops with heyoka
	target/bench/bin/python benches/compare_terms.py
	target/bench/bin/python benches/compare_members.py

# The other integrators have an environment of their own.
target/bench/.installed: $(VENV)/.installed
	test -x target/bench/bin/python || $(PYTHON) -m venv --without-pip target/bench
	$(PYTHON) -m pip --python target/bench/bin/python install --quiet "$$(ls $(CURDIR)/target/wheels/iva_dynamics-*.whl)[bench]"
	$(PYTHON) -m pip --python target/bench/bin/python install --quiet --no-deps --force-reinstall \
		"$$(ls $(CURDIR)/target/wheels/iva_dynamics-*.whl)"
	touch $@

bench-start: wheel ## measure how long the command takes to start
	$(CARGO) build --locked --release -p iva-cli
	$(BIN)/python benches/start_up.py target/release/iva $(BIN)/iva $(BIN)/python

weight: ## measure what a build takes: WEIGHT="--demo --change --ci", in a fresh clone; without, sizes
	$(PYTHON) benches/weight.py $(WEIGHT)

docs: wheel ## build the site of documentation into target/docs/html
	$(BIN)/python -m sphinx --fail-on-warning --keep-going --nitpicky --quiet --fresh-env \
		--doctree-dir target/docs/doctrees docs target/docs/html
	RUSTDOCFLAGS="-D warnings" $(CARGO) doc --locked --release --no-deps --package iva-core --package iva-sweep --package iva-verify
	rm -rf target/docs/html/rust
	cp -r target/doc target/docs/html/rust
	@echo "open file://$(CURDIR)/target/docs/html/index.html"

wheel: $(VENV)/.installed ## build the release wheel and install it into .venv

sdist: $(VENV)/.tools ## build the source distribution, install from it, try what was installed
	$(PYTHON) .ci/sdist.py $(BIN)/maturin

reproducible: $(VENV)/.tools ## build the wheel twice in two folders and compare; QUICK=--quick without the optimiser
	$(PYTHON) .ci/reproducible.py $(QUICK) $(BIN)/maturin

advisories: ## look for known weaknesses of the packages in the lock files (needs cargo-deny and a network)
	for manifest in Cargo.toml crates/iva-wasm/Cargo.toml tests/fuzz/Cargo.toml; do \
		$(CARGO) deny --manifest-path $$manifest check --config $(CURDIR)/deny.toml advisories sources || exit 1; \
	done

clean: ## remove the environment, builds and caches
	rm -rf $(VENV) target docs/_made .hypothesis .mypy_cache .pytest_cache .ruff_cache

$(VENV)/.tools: pyproject.toml .ci/requirements.py
	test -x $(BIN)/python || $(PYTHON) -m venv --without-pip $(VENV)
	$(PYTHON) .ci/requirements.py > $(VENV)/requirements.txt
	$(PIP) install --quiet --requirement $(VENV)/requirements.txt
	touch $@

$(VENV)/.installed: $(VENV)/.tools $(SOURCES)
	@echo "compiling the wheel: some 9 to 15 CPU minutes from nothing, less after a change"
	rm -f target/wheels/iva_dynamics-*.whl
	$(BIN)/maturin build --locked --compression-level 9 --out target/wheels
	$(PIP) install --quiet --no-deps --force-reinstall target/wheels/iva_dynamics-*.whl
	touch $@
