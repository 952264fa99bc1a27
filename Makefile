# Every target makes its environment first: Debian with Python 3.11, pip, venv and make is enough.

VENV   ?= .venv
PYTHON ?= python3
# twice the cores: tests wait for the processes that they start
JOBS   ?= 4
DECK   ?= decks/scenes/train_test.yaml

BIN     := $(VENV)/bin
RESULTS := $(basename $(notdir $(DECK))).results
# where tests write: in memory where there is plenty, as every result file waits for its disk several times
MEMORY  := $(shell awk '/MemAvailable/ {print ($$2 > 8e6)}' /proc/meminfo)
SCRATCH ?= $(if $(and $(filter 1,$(MEMORY)),$(wildcard /dev/shm/.)),/dev/shm,$(or $(TMPDIR),/tmp))
INSTALL := $(BIN)/python -m pip install --quiet --disable-pip-version-check --only-binary :all:

.PHONY: demo test long queue bench stability beam trains structures crush certification sled car rollover gallery docs clean

demo: $(VENV)/render.installed
	$(BIN)/crashsolve $(DECK) -o $(RESULTS)
	@echo "The report, to be opened in a browser:"
	@$(BIN)/crashpost report $(RESULTS)

test: $(VENV)/test.installed
	scratch=$$(mktemp -d -p $(SCRATCH)) && trap 'rm -rf "$$scratch"' EXIT && \
	TMPDIR=$$scratch $(BIN)/python -m pytest -n $(JOBS) --dist loadgroup

long: $(VENV)/test.installed
	$(BIN)/python -m pytest -n $(JOBS) --dist loadgroup -m long

# as root: sets up a Slurm of one node from Debian's packages, and runs jobs in it
queue: $(VENV)/test.installed
	$(BIN)/python -m pytest -m queue -s tests/queues

bench: $(VENV)/test.installed
	for script in benchmarks/*.py; do $(BIN)/python $$script || exit 1; done

stability: $(VENV)/test.installed
	$(BIN)/python tests/stability/page.py > stability.partial
	mv stability.partial solver/STABILITY.md

beam: $(VENV)/plot.installed
	$(BIN)/python decks/scenes/beam_impact.py

trains: $(VENV)/render.installed $(VENV)/sweep.installed
	$(BIN)/python decks/scenes/train_sets.py
	$(BIN)/python decks/scenes/train_test.py

structures: $(VENV)/plot.installed
	$(BIN)/python decks/scenes/structures.py

crush: $(VENV)/plot.installed
	$(BIN)/python decks/benchmark/tube_crush.py

certification: $(VENV)/plot.installed
	$(BIN)/python decks/occupants/certification.py

sled: $(VENV)/plot.installed $(VENV)/sweep.installed
	$(BIN)/python decks/occupants/sled.py

car: $(VENV)/render.installed $(VENV)/sweep.installed
	$(BIN)/python decks/scenes/sports_car.py

rollover: $(VENV)/render.installed
	$(BIN)/python decks/scenes/rollover.py

gallery: $(VENV)/render.installed
	$(BIN)/python decks/gallery.py

docs: $(VENV)/plot.installed
	$(BIN)/crashsolve keywords > solver/KEYWORDS.md
	$(BIN)/crashsolve equations > solver/EQUATIONS.md
	$(BIN)/python -m crashsolve.stubs

clean:
	rm -rf $(VENV) *.egg-info *.results build .pytest_cache .ruff_cache .hypothesis

# the project itself stays where it is (editable); what it needs comes as wheels
$(VENV)/%.installed: pyproject.toml | $(BIN)/python
	$(INSTALL) --editable '.[$*]'
	@touch $@

$(BIN)/python:
	$(PYTHON) -m venv $(VENV)
