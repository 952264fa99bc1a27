"""Two decks that use all that a restart must bring back, and their uninterrupted runs."""

from pathlib import Path

import pytest
from command import crashsolve

HERE = Path(__file__).parent
# joints, a spring, contacts with friction; and a heap whose pairs come and go
DECKS = {"mechanism": HERE / "mechanism.yaml", "heap": HERE / "heap.yaml"}


@pytest.fixture(params=DECKS)
def deck(request: pytest.FixtureRequest) -> Path:
    return DECKS[request.param]


@pytest.fixture
def mechanism() -> Path:
    return DECKS["mechanism"]


@pytest.fixture(scope="session")
def uninterrupted(tmp_path_factory: pytest.TempPathFactory) -> dict[Path, Path]:
    """Results of each deck run in one go."""
    folders = {}
    for name, deck in DECKS.items():
        folders[deck] = tmp_path_factory.mktemp("uninterrupted") / name
        done = crashsolve(deck, "-o", folders[deck])
        assert done.returncode == 0, done.stderr
    return folders
