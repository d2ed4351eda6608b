# Each target does all of its own set-up. Python 3.11 or newer is needed, and nothing else.

PYTHON ?= python3
CORES ?= all
PORT ?= 5000
RESULTS ?= results
TARGETS ?=
ADVISORIES ?= advisories.zip
SNAKEMAKE_OPTIONS ?=

VENV := .venv
INSTALLED := $(VENV)/.installed
export PATH := $(CURDIR)/$(VENV)/bin:$(PATH)
export MLFLOW_DISABLE_TELEMETRY := true
export MLFLOW_SERVER_ENABLE_JOB_EXECUTION := false
# Hundreds of processes import the same sources, which are compiled once, whatever the surroundings say.
export PYTHONDONTWRITEBYTECODE :=

.PHONY: help install reproduce reproduce-full crossover report smoke lint check test coverage audit reference tables docs pictures ui benchmark browser postgresql slurm compiler clean

help:
	@echo "make install      the environment alone, in .venv"
	@echo "make reproduce    the whole default study, results/report.html   (CORES=2)"
	@echo "make reproduce-full  every baseline timed on every simulation: hours, results-full/report.html"
	@echo "make crossover    where a network pays: results/tables/crossover.csv and its figure, ten minutes"
	@echo "make report       results/report.html anew; of one study alone:   (TARGETS=airliner)"
	@echo "make ui           the page on which runs are compared, on this machine only   (PORT=5000 RESULTS=results)"
	@echo "make benchmark    speed, as ratios, in results/tables/benchmarks.csv"
	@echo
	@echo "while editing"
	@echo "make check        format, findings of linters, types, floors"
	@echo "make lint         what snakemake --lint finds"
	@echo "make smoke        one study, quickly, to a table and a figure, in results-smoke"
	@echo "make test         every check and test"
	@echo "make coverage     the quick tests, with the lines of Python that they reach"
	@echo "make reference    docs/reference.md anew"
	@echo "make tables       the tables of README.md and docs anew, of what is in results"
	@echo "make docs         the documentation as pages, build/site/index.html"
	@echo "make pictures     docs/images anew: figures, and screenshots of the report and of MLflow's page"
	@echo "make audit        what is installed against known advisories   (ADVISORIES=advisories.zip)"
	@echo
	@echo "make clean        remove all results; the environment stays"

$(INSTALLED): environment.txt pyproject.toml
	$(PYTHON) -c 'import sys; sys.exit(0 if sys.version_info >= (3, 11) else "Python 3.11 or newer is needed")'
	test -x $(VENV)/bin/python || $(PYTHON) -m venv $(VENV)
	$(VENV)/bin/python -m pip install --quiet --disable-pip-version-check -r environment.txt
	$(VENV)/bin/python -m pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation -e .
	touch $@

install: $(INSTALLED)

reproduce: $(INSTALLED)
	snakemake --cores $(CORES) $(SNAKEMAKE_OPTIONS)
	snakemake --cores $(CORES) $(SNAKEMAKE_OPTIONS) --report results/report.html

reproduce-full: $(INSTALLED)
	snakemake --cores $(CORES) $(SNAKEMAKE_OPTIONS) --configfile config/presets/full.yaml
	snakemake --cores $(CORES) $(SNAKEMAKE_OPTIONS) --configfile config/presets/full.yaml \
		--report results-full/report.html

crossover: $(INSTALLED)
	snakemake --cores $(CORES) $(SNAKEMAKE_OPTIONS) --configfile config/presets/crossover.yaml

report: $(INSTALLED)
	snakemake --cores $(CORES) $(SNAKEMAKE_OPTIONS) --report results/report.html -- $(TARGETS)

# Every rule runs in the one environment that environment.txt pins, so this wish of Snakemake's linter does
# not apply; whatever else it finds ends the check, and so does an error of its own.
NO_FINDING := Specify a conda environment or container for each rule.

lint: $(INSTALLED)
	@found=$$(snakemake --lint 2>&1 | grep -E '^    \* |Error' | grep -vF '$(NO_FINDING)'); \
	if test -n "$$found"; then echo "snakemake --lint:"; echo "$$found"; exit 1; fi

check: $(INSTALLED) lint
	ruff check .
	ruff format --check .
	snakefmt --check Snakefile workflow
	mypy
	lint-imports

# From the first simulation to a table and a figure, all of it anew: nothing would be done a second time.
smoke: $(INSTALLED)
	rm -rf results-smoke
	snakemake --cores $(CORES) --configfile config/presets/quick.yaml config/presets/smoke.yaml \
		--config results=results-smoke -- \
		results-smoke/tables/cost.csv results-smoke/figures/cantilever/figure_11.svg

# A file of tests stays in one process; those that take long come first (tests/conftest.py). There are two processes
# more than cores, for some of them wait: for Slurm, for servers, for a browser. The checks run beside them; what
# they found comes last.
test: $(INSTALLED) browser postgresql slurm compiler
	@mkdir -p build; make check > build/check.out 2>&1 & checks=$$!; \
	OMP_NUM_THREADS=1 python -m pytest -n $$(($$(nproc) + 2)) --dist loadfile --no-loadscope-reorder tests; \
	tests=$$?; wait $$checks || { cat build/check.out; exit 1; }; exit $$tests

# numba's machine code is not seen: the equations of kernels count as missed, and other tests hold them.
coverage: $(INSTALLED)
	OMP_NUM_THREADS=1 python -m pytest -n logical --dist loadfile --ignore=tests/workflow --cov=flexsurr tests

reference: $(INSTALLED)
	flexsurr reference --output docs/reference.md

tables: $(INSTALLED)
	python docs/tables.py

pictures: $(INSTALLED) browser
	python docs/pictures.py results

docs: $(INSTALLED)
	python -m sphinx --quiet --fail-on-warning --keep-going --builder html docs build/site

audit: $(INSTALLED)
	python .ci/audit.py --advisories $(ADVISORIES) environment.txt

# MLflow's page opens on its view of language models, but for an address that says otherwise: the first study's runs.
MODEL_TRAINING := \#/experiments/1/runs?workflowType=machine_learning

ui: $(INSTALLED)
	@test -f "$(RESULTS)/mlflow/mlflow.db" || \
		{ echo "no runs in $(RESULTS)/mlflow: make reproduce first, or name another folder, RESULTS=results-full"; exit 1; }
	flexsurr track --results "$(RESULTS)"
	@echo "the page: http://127.0.0.1:$(PORT)/$(MODEL_TRAINING)"
	mlflow ui --backend-store-uri "sqlite:///$$(realpath "$(RESULTS)")/mlflow/mlflow.db" --host 127.0.0.1 --port $(PORT)

benchmark: $(INSTALLED)
	python benchmarks/run.py

# Tests look at the pages in a real browser. Debian's is fetched where there is none and we may.
browser:
	@browser=$$(command -v chromium || command -v chromium-browser || command -v google-chrome); \
	driver=$$(command -v chromedriver); \
	if test -n "$$browser" -a -n "$$driver"; then exit 0; fi; \
	if test "$$(id -u)" = 0 && command -v apt-get > /dev/null; then \
		apt-get update -q && apt-get install -q -y --no-install-recommends chromium chromium-driver; \
	else \
		echo "tests need chromium and chromedriver on the PATH; install them, or run make browser as root"; \
		exit 1; \
	fi

# Tests run the workflow on a Slurm of this machine alone, which they start and stop themselves.
slurm:
	@PATH="$$PATH:/usr/sbin"; \
	missing=; for tool in munged slurmctld slurmd sbatch; do command -v $$tool > /dev/null || missing=yes; done; \
	if test -z "$$missing"; then exit 0; fi; \
	if test "$$(id -u)" = 0 && command -v apt-get > /dev/null; then \
		apt-get update -q && apt-get install -q -y --no-install-recommends slurm-wlm munge; \
	else \
		echo "tests need Slurm and munge (Debian: slurm-wlm, munge); install them, or run make slurm as root"; \
		exit 1; \
	fi

# They write to a tracking server before Debian's PostgreSQL, which they start themselves.
postgresql:
	@if command -v initdb > /dev/null || ls /usr/lib/postgresql/*/bin/initdb > /dev/null 2>&1; then exit 0; fi; \
	if test "$$(id -u)" = 0 && command -v apt-get > /dev/null; then \
		apt-get update -q && apt-get install -q -y --no-install-recommends postgresql; \
	else \
		echo "tests need PostgreSQL's initdb; install it, or run make postgresql as root"; \
		exit 1; \
	fi

# They compile what is exported as C.
compiler:
	@if command -v cc > /dev/null; then exit 0; fi; \
	if test "$$(id -u)" = 0 && command -v apt-get > /dev/null; then \
		apt-get update -q && apt-get install -q -y --no-install-recommends gcc libc6-dev; \
	else \
		echo "tests need a C compiler, cc; install one, or run make compiler as root"; \
		exit 1; \
	fi

clean:
	find results -mindepth 1 -maxdepth 1 ! -name README.md -exec rm -rf {} +
	rm -rf results-smoke build .snakemake
