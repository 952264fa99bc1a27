"""Claims of the occupants: totals of the tables, options that keep them, stable extremes."""

from pathlib import Path

import numpy as np
import pytest
from command import crashsolve
from quick import first_quick

from crashpost.results.result import Result

SHARED = Path(__file__).parents[2] / "decks" / "occupants" / "shared"
JOINTS = ["lumbar", "neck_base", "condyles"] + [
    f"{joint}_{side}"
    for joint in ("shoulder", "elbow", "hip", "knee")
    for side in ("left", "right")
]
# of de Leva (1996), Table 4: length, share of the mass, centre from the upper end, radius of
# gyration about the transverse axis in shares of the length; stature and length from C7 to the hips
MALE = {
    "stature": 1.741,
    "trunk": 0.6033,
    "head": (0.2429, 0.0694, 0.5002, 0.315),
    "upper": (0.1707, 0.1596, 0.2999, 0.454),
    "middle": (0.2155, 0.1633, 0.4502, 0.383),
    "lower": (0.1457, 0.1117, 0.6115, 0.551),
    "arm": (0.2817, 0.0271, 0.5772, 0.269),
    "forearm": (0.2689, 0.0162, 0.4574, 0.265),
    "hand": (0.0862, 0.0061, 0.79, 0.513),
    "thigh": (0.4222, 0.1416, 0.4095, 0.329),
    "shank": (0.4340, 0.0433, 0.4459, 0.249),
    "foot": (0.2581, 0.0137, 0.4415, 0.245),
}
FEMALE = {
    "stature": 1.735,
    "trunk": 0.6148,
    "head": (0.2437, 0.0668, 0.4841, 0.295),
    "upper": (0.1425, 0.1545, 0.2077, 0.502),
    "middle": (0.2053, 0.1465, 0.4512, 0.354),
    "lower": (0.1815, 0.1247, 0.4920, 0.402),
    "arm": (0.2751, 0.0255, 0.5754, 0.260),
    "forearm": (0.2643, 0.0138, 0.4559, 0.257),
    "hand": (0.0780, 0.0056, 0.7474, 0.454),
    "thigh": (0.3685, 0.1478, 0.3612, 0.364),
    "shank": (0.4323, 0.0481, 0.4416, 0.267),
    "foot": (0.2283, 0.0129, 0.4014, 0.279),
}
TABLE = {"male": MALE, "female": FEMALE}


def totals(sex: str, stature: float, mass: float) -> np.ndarray:
    """Mass, x and z of the centre from the hips, and inertia about y there, segment by segment.

    The head with the neck is one, the trunk three: as in the table, and not as in the deck.
    """
    d = TABLE[sex]
    s = stature / d["stature"]
    trunk = s * d["trunk"]
    l_head, l_up, l_mid, l_low = (s * d[name][0] for name in ("head", "upper", "middle", "lower"))
    notch = l_low + l_mid + l_up
    l_arm, l_fore, l_thigh, l_shank = (s * d[n][0] for n in ("arm", "forearm", "thigh", "shank"))
    # where each begins above, and how often there is one; the shoulders are assumed, as in the deck
    shoulder = notch - 0.02 * s
    tops = {
        "head": (trunk + l_head, 1),
        "upper": (notch, 1),
        "middle": (l_low + l_mid, 1),
        "lower": (l_low, 1),
        "arm": (shoulder, 2),
        "forearm": (shoulder - l_arm, 2),
        "hand": (shoulder - l_arm - l_fore, 2),
        "thigh": (0.0, 2),
        "shank": (-l_thigh, 2),
    }
    rows = []
    for name, (top, count) in tops.items():
        length, share, centre, radius = d[name]
        rows.append((count * share, 0.0, top - centre * s * length, radius * s * length))
    sole = stature - l_head - trunk - l_thigh - l_shank
    length, share, centre, radius = d["foot"]
    ankle = -l_thigh - l_shank
    rows.append((2 * share, (centre - 0.2) * s * length, ankle - sole / 2, radius * s * length))
    m, x, z, r = np.array(rows).T
    m = mass * m / m.sum()
    return np.array([mass, m @ x / mass, m @ z / mass, m @ (r**2 + x**2 + z**2)])


def deck(words: str, control: str, more: str = "", extra: tuple[str, ...] = (), **at: str) -> str:
    """A deck with one occupant, `man`, in his zero posture."""
    placed = "\n".join(f"    {word}: {value}" for word, value in at.items())
    joints = "\n".join(f"      - {{joint: man_{joint}}}" for joint in (*JOINTS, *extra))
    return f"""
title: An occupant
include:
  - {SHARED}/numbers.yaml
  - {words}
control: {control}
postures:
  one:
    root: man_lower_torso
{placed}
    joints:
{joints}
{more}
"""


def de_leva(sex: str, stature: float, mass: float, thorax: str, ends: str) -> str:
    return (
        f"{{file: {SHARED}/de_leva.yaml, with: {{who: man, sex: {sex}, stature: {stature}, "
        f"mass: {mass}, thorax: {thorax}, neck: two_joints, hands_and_feet: {ends}}}}}"
    )


ENDS = ("wrist_left", "wrist_right", "ankle_left", "ankle_right")


@pytest.mark.parametrize(
    ("sex", "stature", "mass", "thorax", "ends"),
    first_quick(
        [
            ("male", 1.75, 75.0, "sternum", "merged"),
            ("female", 1.58, 54.0, "rigid", "separate"),
            ("male", 1.92, 110.0, "sternum", "separate"),
        ]
    ),
)
def test_totals_are_those_of_the_table_whatever_the_options(
    sex: str, stature: float, mass: float, thorax: str, ends: str, tmp_path: Path
) -> None:
    extra = (*(ENDS if ends == "separate" else ()), *(["sternum_guide"] * (thorax == "sternum")))
    # he turns about y through his hips at 1 rad/s and goes along y at 1 m/s
    text = deck(
        de_leva(sex, stature, mass, thorax, ends),
        "{end_time: 1.0e-5}",
        extra=extra,
        velocity="[0, 1, 0]",
        angular_velocity="[0, 1, 0]",
    )
    path = tmp_path / "deck.yaml"
    path.write_text(text, "utf-8")
    done = crashsolve(path, "-o", tmp_path / "out")
    assert done.returncode == 0, done.stdout + done.stderr
    result = Result(tmp_path / "out")
    p = {axis: result.series(f"glstat.model.momentum.{axis}").values[0] for axis in "xyz"}
    spin = result.series("glstat.model.angular_momentum.y").values[0]
    computed = np.array([p["y"], -p["z"] / p["y"], p["x"] / p["y"], spin])
    # the table's digits are the same on both sides, so round-off is left
    assert computed == pytest.approx(totals(sex, stature, mass), rel=1e-12)


@pytest.mark.parametrize("thorax", ["rigid", "sternum"])
def test_totals_of_the_measured_set_do_not_depend_on_its_words(thorax: str, tmp_path: Path) -> None:
    """Momenta of a motion with all six velocities: mass, mass centre and inertia."""
    sums = {}
    for ends in ("merged", "separate"):
        extra = (
            *(ENDS if ends == "separate" else ()),
            *(["sternum_guide"] * (thorax == "sternum")),
        )
        words = (
            f"{{file: {SHARED}/measured.yaml, with: {{who: man, thorax: {thorax}, "
            f"neck: two_joints, hands_and_feet: {ends}}}}}"
        )
        text = deck(
            words,
            "{end_time: 1.0e-5}",
            extra=extra,
            velocity="[1, 2, 3]",
            angular_velocity="[0.3, 0.2, 0.1]",
        )
        path = tmp_path / f"{ends}.yaml"
        path.write_text(text, "utf-8")
        done = crashsolve(path, "-o", tmp_path / ends)
        assert done.returncode == 0, done.stdout + done.stderr
        result = Result(tmp_path / ends)
        sums[ends] = [
            result.series(f"glstat.model.{name}.{axis}").values[0]
            for name in ("momentum", "angular_momentum")
            for axis in "xyz"
        ]
    # derived by subtraction, so that round-off is left
    assert sums["separate"] == pytest.approx(sums["merged"], rel=1e-12)


FALLS = {
    "1 kg": 1.0,
    "1,000 kg": 1000.0,
}


@pytest.mark.long
@pytest.mark.parametrize("mass", FALLS.values(), ids=FALLS)
def test_occupants_of_extreme_mass_fall_and_keep_their_energy(mass: float, tmp_path: Path) -> None:
    surfaces = ["man_skull", "man_chest", "man_pelvis", "man_abdomen"] + [
        f"man_{name}_{side}"
        for name in ("foot", "kneecap", "hand", "elbow_ball", "buttock", "shoulder_ball")
        for side in ("left", "right")
    ]
    more = f"""
surfaces: {{ground: {{type: plane}}}}
contacts:
  fall:
    a: [{", ".join(surfaces)}]
    b: [ground]
    normal: {{type: exact_restitution, stiffness: 5.0e+5, restitution: 0.2}}
    friction: {{type: coulomb, friction_coefficient: 0.4, none_below: 0.01, full_above: 0.1}}
loads: {{weight: {{type: gravity}}}}
"""
    words = de_leva("male", 1.75, mass, "rigid", "merged")
    text = deck(
        words,
        "{end_time: 1}",
        more,
        position="[0, 0, 1.1]",
        rotation="{axis: [1, 1, 0], angle: 10 deg}",
    )
    path = tmp_path / "deck.yaml"
    path.write_text(text, "utf-8")
    done = crashsolve(path, "-o", tmp_path / "out", "--set", "control.estimate=off")
    assert done.returncode == 0, done.stdout + done.stderr
    result = Result(tmp_path / "out")
    # 0.5 % is asked for
    assert np.abs(result.series("glstat.model.balance").values).max() < 0.5
    assert np.isfinite(result.series("rbdout.man_head.position.z").values).all()


@pytest.mark.parametrize(
    ("x", "code", "words"),
    [
        (0.0, 2, "' on 'rear_"),
        (0.0, 2, "more than half of the"),
        # the chests, 0.24 m deep, meet by 5 mm
        (0.235, 0, "touches at the start"),
        (0.235, 0, "; deepest is 'man_"),
    ],
)
def test_occupants_that_overlap_are_refused_or_reported(
    x: float, code: int, words: str, tmp_path: Path
) -> None:
    """One behind the other, by their trunks and heads."""
    parts = ("pelvis", "chest", "skull")
    joints = "\n".join(f"      - {{joint: rear_{joint}}}" for joint in JOINTS)
    more = f"""
  other:
    root: rear_lower_torso
    position: [{x}, 0, 0]
    joints:
{joints}
contacts:
  overlap:
    a: [{", ".join(f"man_{part}" for part in parts)}]
    b: [{", ".join(f"rear_{part}" for part in parts)}]
    normal: {{type: exact_restitution, stiffness: 5.0e+5, restitution: 0.2}}
"""
    words_of = de_leva("male", 1.75, 75.0, "rigid", "merged")
    both = f"{words_of}\n  - {words_of.replace('who: man', 'who: rear')}"
    path = tmp_path / "deck.yaml"
    path.write_text(deck(both, "{end_time: 1.0e-4}", more), "utf-8")
    done = crashsolve(path, "-o", tmp_path / "out", "--set", "control.estimate=off")
    assert done.returncode == code, done.stdout + done.stderr
    assert words in done.stdout + done.stderr


def test_a_sex_that_no_table_has_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "deck.yaml"
    path.write_text(deck(de_leva("child", 1.2, 30.0, "rigid", "merged"), "{end_time: 1}"), "utf-8")
    done = crashsolve(path, "-o", tmp_path / "out")
    assert done.returncode == 2
    assert "there is no file" in done.stderr and "de_leva_child.yaml" in done.stderr


@pytest.mark.parametrize(("stature", "mass"), [(-1.7, 70.0), (1.7, -70.0), (1.7, 0.0), (175, 70.0)])
def test_a_size_that_cannot_be_is_refused(stature: float, mass: float, tmp_path: Path) -> None:
    path = tmp_path / "deck.yaml"
    text = deck(de_leva("male", stature, mass, "rigid", "merged"), "{end_time: 1}")
    path.write_text(text, "utf-8")
    done = crashsolve(path, "-o", tmp_path / "out")
    assert done.returncode == 2
    assert f"{stature if stature != 1.7 else mass:g} is not within" in done.stderr


@pytest.mark.long
def test_seats_and_dash_of_the_roll_over_are_padded_by_a_word(tmp_path: Path) -> None:
    scenes = SHARED.parents[1] / "scenes"
    text = (scenes / "rollover.yaml").read_text("utf-8")
    for folder in ("shared/", "../occupants/"):
        text = text.replace(f" {folder}", f" {(scenes / folder).resolve()}/")
        text = text.replace(f"file: {folder}", f"file: {(scenes / folder).resolve()}/")
    path = tmp_path / "padded.yaml"
    path.write_text(text.replace("interior: rigid", "interior: padded"), "utf-8")
    words = ["--set", "control.end_time=0.3", "--set", "control.estimate=off"]
    done = crashsolve(path, "-o", tmp_path / "out", *words)
    assert done.returncode == 0, done.stdout + done.stderr
    result = Result(tmp_path / "out")
    assert result.series("rcforc.driver_seat.normal").values.max() > 0.0
    # 0.5 % is asked for
    assert np.abs(result.series("glstat.model.balance").values).max() < 0.5
