# On a machine with nothing but Python 3.11 or newer, every target sets up what it needs.
# Another interpreter: make test PYTHON=python3.12

PYTHON ?= python3
BIN := .venv/bin
INSTALL := $(BIN)/python -m pip install --quiet --disable-pip-version-check --constraint constraints.txt

# Where arrays live, shapes, dtypes and types are checked while the tests run: at the first 2000
# calls of each test, in test-random at every call. Not where the doors are: what comes in there may
# be anything, and is refused with better words.
SHAPES := trecsim.values,trecsim.geometry.distortion,trecsim.geometry.rigid,$\
  trecsim.geometry.triangulation,trecsim.sources,trecsim.estimators.pool,$\
  trecsim.calibrating,trecsim.fusion,trecsim.forecasting,trecsim.safety,trecsim.store,trecsim.lab.simulation,trecsim.lab.true_events,trecsim.lab.evaluation,trecsim.lab.plots,$\
  trecsim.lab.report,trecsim.lab.study.design,trecsim.lab.study.resampling,$\
  trecsim.lab.study.default_rank,trecsim.lab.study.inference

# Tests start many processes, each of which would compile all modules again.
unexport PYTHONDONTWRITEBYTECODE

PYTEST := $(BIN)/python -m pytest --quiet --numprocesses=auto --dist=worksteal $\
  --jaxtyping-packages=$(SHAPES),shape_checker.check

# Tests that hold kernels to their references; what is compiled is invisible to coverage, so these
# run a second time without the compiler. Whole scenes would take hours that way.
TWINS := $(addprefix tests/fusion/test_,$(addsuffix .py,anatomy dense fitting ground information $\
  matching mixture pairing prefilter presence stating twins visibility)) $\
  tests/lab/simulation/test_occlusion.py

.DEFAULT_GOAL := help
.PHONY: help demo test test-random coverage check bench bench-quick ablation figures tables $\
  page page-pictures pictures study docs film-picture report constraints clean

help:  ## Show this list.
	@grep -E '^[a-z-]+:.*##' Makefile | sed -E 's/:.*## /\t/' | expand -t 14

demo: .venv/installed-demo page  ## Run a simulated site with its live page (20 s, or in a terminal until Ctrl-C).
	$(BIN)/trecsim demo
	@command -v trecsim > /dev/null || echo "to use trecsim in this shell: . $(BIN)/activate"

test: .venv/installed-test page  ## Run all tests, the same each time (10 min on 2 cores).
	$(BIN)/python tests/compile_kernels.py
	$(PYTEST)

page: | $(BIN)/python  ## Build the operator page, if its sources are newer (needs Node.js, or the network).
	@$(BIN)/python hatch_build.py

page-pictures: .venv/installed-test page  ## Picture the operator page for the docs with Chromium (minutes).
	$(BIN)/python benchmarks/page_pictures.py --docs

test-random: .venv/installed-test  ## Run all tests as a nightly run does: examples drawn anew, more of everything.
	$(BIN)/python tests/compile_kernels.py
	$(PYTEST) --hypothesis-profile=random

coverage: .venv/installed-coverage  ## Run all tests and print the share of lines they reach, kernels included.
	$(BIN)/python tests/compile_kernels.py
	$(PYTEST) --cov=trecsim --cov-report=
	NUMBA_DISABLE_JIT=1 $(PYTEST) --cov=trecsim --cov-append --cov-report=term:skip-covered $(TWINS)

check: .venv/installed-check  ## Check format, lint, types, layers and spelling.
	$(BIN)/ruff format --check
	$(BIN)/ruff check
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(BIN)/codespell --skip docs/_build,src/trecsim/page/static src tests docs benchmarks *.md

bench: .venv/installed-test  ## Run all benchmarks, store the results, make the tables anew (about an hour).
	@$(BIN)/python benchmarks/run.py; status=$$?; $(BIN)/python benchmarks/tables.py && exit $$status

bench-quick: .venv/installed-test  ## Run a part of them (3 min); say what got worse, and fail if so.
	$(BIN)/python benchmarks/run.py --quick

ablation: .venv/installed-test  ## Switch the parts of the model off one by one; store what each is worth (15 min).
	$(BIN)/python benchmarks/ablation.py
	$(BIN)/python benchmarks/tables.py

figures: | $(BIN)/python  ## Print every figure to reach beside the one reached.
	@$(BIN)/python benchmarks/figures.py

tables: .venv/installed-plot  ## Make the tables of README and docs anew from the stored results.
	$(BIN)/python benchmarks/tables.py

pictures: .venv/installed-plot  ## Draw the pictures of the page about the model anew.
	$(BIN)/python benchmarks/pictures.py

study: .venv/installed-test  ## Run the study of three settings that the docs show (minutes).
	$(BIN)/trecsim study benchmarks/study_three.toml --out out/study_three
	$(BIN)/python benchmarks/study_pages.py out/study_three

docs: .venv/installed-docs  ## Build the documentation into docs/_build/html.
	$(BIN)/sphinx-build --fail-on-warning --quiet docs docs/_build/html
	@echo "see docs/_build/html/index.html"

film-picture: .venv/installed-render  ## Draw the picture of a film for README anew.
	$(BIN)/python benchmarks/film_pictures.py

report: .venv/installed-docs .venv/installed-test  ## Make the technical report, slides and a film.
	$(BIN)/python benchmarks/technical_report.py

constraints: .venv/installed-check .venv/installed-docs  ## Pin the versions that are installed now.
	@echo "# Versions that the tests passed with; make installs exactly these. Made by: make constraints" > constraints.txt
	$(BIN)/python -m pip freeze --exclude-editable | grep -v ' @ ' >> constraints.txt

clean:  ## Remove everything that was made here.
	rm -rf web/node_modules web/.node web/.tests src/trecsim/page/static
	rm -rf .venv build dist out recordings sample trecsim-demo docs/_build docs/reference/generated
	rm -rf .coverage .pytest_cache .mypy_cache .ruff_cache .hypothesis .import_linter_cache
	find src tests benchmarks examples -name __pycache__ -type d -exec rm -rf {} +

# An extra is installed again only when what it depends on has changed.
.venv/installed-%: pyproject.toml constraints.txt | $(BIN)/python
	$(INSTALL) --editable '.[$*]'
	@touch $@

$(BIN)/python:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null || \
	  { echo "make: $(PYTHON) is missing or older than 3.11; give another one: make PYTHON=python3.12" >&2; exit 1; }
	@$(PYTHON) -c 'import ensurepip, venv' 2>/dev/null || \
	  { echo "make: $(PYTHON) has no venv module; on Debian and Ubuntu: sudo apt install python3-venv" >&2; exit 1; }
	$(PYTHON) -m venv .venv
