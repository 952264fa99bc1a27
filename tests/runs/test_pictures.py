"""Claim: what is drawn is what was computed: bodies in place, every shape, every force."""

from pathlib import Path

import h5py
import numpy as np
import pytest
from command import crashsolve, datasets

from crashpost.result import Result

HERE = Path(__file__).parent
pytestmark = pytest.mark.xdist_group("runs")


def state_at(folder: Path, time: float) -> dict[str, np.ndarray]:
    """Fields of the state at a time, by block and name."""
    for path in sorted((folder / "states").glob("*.h5")):
        with h5py.File(path) as file:
            if abs(file.attrs["time"] - time) < 1e-9:
                return datasets(path)
    raise AssertionError(f"no state at {time} s")


def channel(folder: Path, name: str, time: float) -> float:
    times, values, _ = Result(folder).series(name)
    return float(values[np.argmin(np.abs(times - time))])


@pytest.mark.parametrize("time", [0.05, 0.25, 0.5])
def test_bodies_and_forces_are_drawn_as_the_histories_say(
    time: float, mechanism: Path, uninterrupted: dict[Path, Path]
) -> None:
    folder = uninterrupted[mechanism]
    mesh, state = datasets(folder / "mesh.h5"), state_at(folder, time)
    centres = mesh["mass_centres/points"] + state["mass_centres/displacement"]
    for k, body in enumerate(("hammer", "bob")):
        place = [channel(folder, f"rbdout.{body}.position.{axis}", time) for axis in "xyz"]
        np.testing.assert_allclose(centres[k], place, atol=1e-6)
    force = state["contacts/force"].sum(axis=0)
    asked = [channel(folder, f"rcforc.blow.force.{axis}", time) for axis in "xyz"]
    np.testing.assert_allclose(force, asked, rtol=1e-6, atol=1e-3)
    assert (np.linalg.norm(force) > 1.0) == (time == 0.25)
    tension = channel(folder, "deforc.stay.force", time)
    np.testing.assert_allclose(state["springs/tension"], [tension], rtol=1e-6, atol=1e-6)


def test_pairs_that_come_and_go_are_drawn_in_a_block_of_one_size(
    uninterrupted: dict[Path, Path],
) -> None:
    folder = uninterrupted[HERE / "heap.yaml"]
    forces = [datasets(path)["contacts/force"] for path in (folder / "states").glob("*.h5")]
    assert len({force.shape for force in forces}) == 1
    touching = (np.linalg.norm(state_at(folder, 0.4)["contacts/force"], axis=1) > 0).sum()
    assert touching == sum(
        channel(folder, f"rcforc.{card}.touching", 0.4) for card in ("balls", "ground")
    )
    assert touching > 5


@pytest.fixture(scope="module")
def shapes(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("shapes")
    done = crashsolve(HERE / "shapes.yaml", "-o", folder, NUMBA_DISABLE_JIT="1")
    assert done.returncode == 0, done.stderr
    return folder


def test_every_shape_is_drawn_above_the_floor(shapes: Path) -> None:
    mesh = datasets(shapes / "mesh.h5")
    blocks = {name.split("/")[0] for name in mesh}
    assert blocks == {"mass_centres", "bodies", "ground", "springs", "contacts"}
    state = state_at(shapes, 0.28)
    points = mesh["bodies/points"] + state["bodies/displacement"]
    assert set(mesh["bodies/body"]) == {1, 2, 3, 4, 5, 6}
    # the brick is deepest then, on a corner of its own
    deepest = channel(shapes, "rcforc.fall.depth", 0.28)
    assert points[:, 2].min() == pytest.approx(-deepest, abs=1e-6)
    np.testing.assert_array_equal(mesh["ground/points"][:, 2], 0.0)


def test_pyvista_reads_the_states(shapes: Path) -> None:
    pyvista = pytest.importorskip("pyvista")
    reader = pyvista.get_reader(shapes / "states.xdmf")
    assert len(reader.time_values) == 31
    reader.set_active_time_value(reader.time_values[28])
    scene = reader.read()
    moved = scene["bodies"].warp_by_vector("displacement")
    deepest = channel(shapes, "rcforc.fall.depth", 0.28)
    assert moved.bounds[4] == pytest.approx(-deepest, abs=1e-6)
    arrows = scene["contacts"].warp_by_vector("displacement").glyph(orient="force", scale="force")
    assert arrows.n_points > 0
