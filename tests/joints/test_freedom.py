"""Claim: `check` counts the degrees of freedom, and names joints that hold the same twice."""

from pathlib import Path

from command import crashsolve

DECKS = Path(__file__).parents[2] / "decks" / "verification"
DOOR = """
control: {end_time: 1}
bodies: {door: {mass: 20, inertia: [1, 1, 1], position: [0.5, 0, 1]}}
joints:
  low: {type: revolute, b: door, at: [0, 0, 0.3], axis: [0, 0, 1]}
  high: {type: HIGH, b: door, at: [0, 0, 1.7], axis: [0, 0, 1]}
"""


def checked(deck: Path) -> str:
    done = crashsolve("check", deck)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_a_door_on_two_revolute_joints_turns_and_has_five_rows_too_many(tmp_path: Path) -> None:
    deck = tmp_path / "door.yaml"
    deck.write_text(DOOR.replace("HIGH", "revolute"), "utf-8")
    text = checked(deck)
    assert "degrees of freedom: 1 = 6 x 1 - 5" in text
    assert "redundant constraint rows: 5, among those of joints 'low', 'high'" in text


def test_a_joint_that_takes_a_freedom_away_lowers_the_count(tmp_path: Path) -> None:
    deck = tmp_path / "door.yaml"
    deck.write_text(
        DOOR.replace("low: {type: revolute", "low: {type: cylindrical").replace(
            "  high: {type: HIGH", "  high: {type: point_on_plane"
        ),
        "utf-8",
    )
    text = checked(deck)
    # a cylindrical joint leaves two, a support in the direction of its axis one
    assert "degrees of freedom: 1 = 6 x 1 - 5" in text and "redundant" not in text


def test_a_mechanism_with_drivers_has_none_left() -> None:
    # two shafts, two revolute joints, a universal joint and a driver: 15 rows, 3 too many
    text = checked(DECKS / "joints" / "universal.yaml")
    assert "degrees of freedom: 0 = 6 x 2 - 12" in text
    assert "redundant constraint rows: 3" in text


def test_the_sports_car_has_fifteen() -> None:
    # 6 of the chassis, 4 travels and 4 spins of wheels, and the rack: Ambrosio (2003), 5.3.1
    car = DECKS.parent / "scenes" / "sports_car" / "rolling.yaml"
    assert "degrees of freedom: 15 = 6 x 16 - 81" in checked(car)
