"""The run as an interactive page: 3-D, playable, in one file that needs no network.

k3d (three.js inside) draws it in any browser. States and triangles are thinned to a stated size.
"""

from __future__ import annotations

import json
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from crashpost.errors import PostError
from crashpost.renders.appearance import Appearance
from crashpost.renders.camera import Camera
from crashpost.renders.colour_scale import ColourScale
from crashpost.renders.drawing import Scene
from crashpost.renders.painting import Task, View, clock
from crashpost.renders.shapes import ARROW, Drawing, Surface
from crashpost.results.result import Result
from crashpost.results.states import States
from crashpost.results.whole_file import whole_file

if TYPE_CHECKING:
    from types import ModuleType

    import k3d

# states on the page, and numbers of all vertices at all states together
MAX_STATES, MAX_NUMBERS = 60, 3_000_000
# polygons of a surface above which a field is shown by its vertices, which take a sixth of the room
FINE = 20_000
SECONDS = 6.0
MAX_NAMES = 24
# the bar below the picture: play and pause, a slider for the time, the meaning of colours
PLAYER = """
const facts = @FACTS@;
const bar = document.createElement('div');
bar.style.cssText = 'position:fixed;z-index:1000;left:0;right:0;bottom:0;padding:8px 12px;' +
  'display:flex;gap:12px;align-items:center;flex-wrap:wrap;background:#ffffffd0;' +
  'font:14px system-ui,sans-serif;color:#1c2126';
const button = document.createElement('button');
button.style.cssText = 'font:inherit;width:5em;padding:4px';
const slider = document.createElement('input');
slider.type = 'range'; slider.min = 0; slider.max = 1; slider.step = 0.001;
slider.setAttribute('aria-label', 'time');
slider.style.cssText = 'flex:1;min-width:120px';
const label = document.createElement('span');
label.style.cssText = 'min-width:7em;font-variant-numeric:tabular-nums';
bar.append(button, slider, label);
for (const [colour, name] of facts.key) {
  const item = document.createElement('span');
  if (colour) {
    const mark = document.createElement('i');
    mark.style.cssText = 'display:inline-block;width:12px;height:12px;margin-right:5px';
    mark.style.background = colour;
    item.append(mark);
  }
  item.append(name);
  bar.append(item);
}
document.body.append(bar);
let playing = true, share = 0, before = null, busy = false;
function show() {
  let near = 0;
  facts.shares.forEach((s, k) => {
    if (Math.abs(s - share) < Math.abs(facts.shares[near] - share)) near = k;
  });
  label.textContent = facts.times[near];
  slider.value = share;
  button.textContent = playing ? 'Pause' : 'Play';
  if (busy) return;
  busy = true;
  K3DInstance.setTime(share * facts.seconds).then(() => { busy = false; });
}
button.onclick = () => { playing = !playing; before = null; show(); };
slider.oninput = () => { playing = false; share = Number(slider.value); show(); };
function step(now) {
  if (playing) {
    // as often as a film: every change of time takes work
    if (before !== null && now - before < 40) return requestAnimationFrame(step);
    if (before !== null) share += Math.min(now - before, 200) / 1000 / facts.seconds;
    before = now;
    if (share > 1.15) share = 0;
    const kept = share; share = Math.min(share, 1); show(); share = kept;
  }
  requestAnimationFrame(step);
}
K3DInstance.setCamera(facts.camera);
show();
requestAnimationFrame(step);
"""
# distance of the eye over half the diagonal of the model
NEAR = 1.7
# thickness of lines over the half height of the view; control points of a map of colours
WIDTH, COLOURS = 0.004, 16


def write_page(result: Result, path: Path, **appearance: object) -> str:
    """Write the page and report its content; raises PostError."""
    text, words = page(result, **appearance)
    with whole_file(path) as partial:
        partial.write_text(text, "utf-8")
    return f"{path}: {words}, {len(text) / 1e6:.1f} MB"


def page(result: Result, **appearance: Any) -> tuple[str, str]:
    """The page, and its content in words; raises PostError."""
    try:
        import k3d
    except ModuleNotFoundError as missing:
        raise PostError(
            f"an interactive page needs {missing.name}, which is missing: "
            "pip install 'crashsolve[render]'"
        ) from None
    states = States(result.folder)
    if appearance.get("view", "auto") == "auto":
        # a model that can be rotated is shown obliquely
        appearance["view"] = "iso"
    task = Task("", "", (), **appearance)
    scene = Scene(
        states, Appearance(task.show, task.color, task.arrows, ghost=False, magnify=task.magnify)
    )
    numbers = _thinned(scene, len(states.times))
    no_shift = [np.zeros(3)] * len(numbers)
    view = View(scene, task, [float(n) for n in numbers], no_shift)
    fitted_camera, arrow = view.camera((1.6, 1.6))
    colour_scale = _colour_scale(scene, numbers)
    first, last = float(states.times[numbers[0]]), float(states.times[numbers[-1]])
    # k3d plays seconds: a run of milliseconds is slowed, one of minutes quickened
    stretch = SECONDS / ((last - first) or 1.0)
    # k3d draws in single precision and no line thinner than 1e-7: lengths are those of the view
    middle, length = fitted_camera.middle, fitted_camera.half_height
    frames = {
        f"{(float(states.times[n]) - first) * stretch:.6f}": scene.at(n).scaled(middle, length)
        for n in numbers
    }
    shown = k3d.plot(
        camera_auto_fit=False,
        grid_visible=False,
        background_color=0xFFFFFF,
        menu_visibility=False,
        colorbar_object_id=0,
        fps=24,
        time_speed=1.0,
    )
    _put(k3d, shown, frames, colour_scale, arrow / length, fitted_camera)
    script = PLAYER.replace(
        "@FACTS@",
        json.dumps(
            {
                "seconds": SECONDS,
                "times": [clock(float(states.times[n]), last) for n in numbers],
                "shares": [float(key) / SECONDS for key in frames],
                "key": _key(colour_scale, scene),
                "camera": _camera(scene, view, numbers, fitted_camera),
            }
        ).replace("<", "\\u003c"),
    )
    text = shown.get_snapshot(9, additional_js_code=script)
    words = f"{len(numbers)} of {len(states.times)} states"
    return _titled(text, result.title), ", ".join(filter(None, [words, scene.appearance.note]))


def _camera(scene: Scene, view: View, numbers: list[int], fitted_camera: Camera) -> list[float]:
    """Eye, point that it looks at, and direction upwards, in lengths of the view."""
    points = np.concatenate([scene.extent(number) for number in numbers])
    points = points if len(points) else view.points
    # a picture of 60 degrees holds a ball at twice its radius, and a long body somewhat nearer
    diameter = float(np.linalg.norm(np.ptp(points, axis=0))) / fitted_camera.half_height
    eye = NEAR * 0.5 * diameter * fitted_camera.towards
    return [*map(float, eye), 0.0, 0.0, 0.0, *map(float, fitted_camera.up)]


def _key(colour_scale: ColourScale, scene: Scene) -> list[tuple[str, str]]:
    """Colours of the picture and their meaning."""
    note = [("", scene.appearance.note)] if scene.appearance.note else []
    if not colour_scale.name:
        return note + [(colour, name) for name, colour in scene.legend()[:MAX_NAMES]]
    unit = f" {colour_scale.shown_unit}" if colour_scale.shown_unit not in ("", "1") else ""
    entries = []
    for share in (0.0, 0.25, 0.5, 0.75, 1.0):
        red, green, blue = colour_scale.table[int(255 * share)].astype(int)
        value = (
            colour_scale.low + share * (colour_scale.high - colour_scale.low)
        ) * colour_scale.scale
        entries.append((f"#{red:02x}{green:02x}{blue:02x}", f"{value:.3g}{unit}"))
    others = [(colour, name) for name, colour in scene.legend()]
    return [*note, ("", colour_scale.name.replace("_", " ")), *entries, *others]


def _thinned(scene: Scene, count: int) -> list[int]:
    """Numbers of states spread evenly, both ends among them, few enough for the page."""
    numbers = sum(map(_numbers, scene.at(0).surfaces))
    most = int(np.clip(MAX_NUMBERS / max(numbers, 1), 2, MAX_STATES))
    return sorted({int(k) for k in np.linspace(0, count - 1, min(most, count)).round()})


def _numbers(surface: Surface) -> int:
    """Count of numbers of a surface on the page at each state."""
    if surface.values is None:
        return 3 * len(surface.points)
    if len(surface.corners) > FINE:
        return 4 * len(surface.points)
    return 12 * (surface.corners.shape[1] - 2) * len(surface.corners)


def _colour_scale(scene: Scene, numbers: list[int]) -> ColourScale:
    if not scene.appearance.color:
        return ColourScale()
    ranges = [scene.range(number) for number in numbers]
    low, high = min(r[0] for r in ranges), max(r[1] for r in ranges)
    return ColourScale.of(scene.appearance.color, scene.color_unit, low, high)


def _put(
    k3d: ModuleType,
    shown: k3d.Plot,
    frames: dict[str, Drawing],
    colour_scale: ColourScale,
    arrow: float,
    fitted_camera: Camera,
) -> None:
    """Surfaces of one colour each, or of a field; lines, dots and arrows beside them."""
    first = next(iter(frames.values()))
    for number, surface in enumerate(first.surfaces):
        same = {key: drawing.surfaces[number] for key, drawing in frames.items()}
        if not len(surface.corners):
            continue
        if surface.values is not None:
            shown += _field_mesh(k3d, surface, same, colour_scale)
            continue
        for kind in np.unique(surface.which):
            shown += _plain_mesh(k3d, surface, same, int(kind))
    for number, lines in enumerate(first.lines):
        # k3d stops drawing after an object without points
        if not len(lines.ends):
            continue
        ends = {key: drawing.lines[number].ends for key, drawing in frames.items()}
        shown += _segments(k3d, ends, lines.colour, 0.5 * WIDTH * lines.width)
    for number, dots in enumerate(first.dots):
        if not len(dots.points):
            continue
        positions = {key: one.dots[number].points.astype(np.float32) for key, one in frames.items()}
        size = 2.0 * fitted_camera.dot / fitted_camera.half_height
        shown += k3d.points(positions, point_size=size, shader="mesh", color=_code(dots.colour))
    if arrow:
        shown += _segments(k3d, _arrow_ends(frames, arrow), ARROW, 2.0 * WIDTH)


def _plain_mesh(
    k3d: ModuleType, first: Surface, same: dict[str, Surface], kind: int
) -> k3d.objects.Mesh:
    """Mesh of the polygons with one colour of a surface's palette."""
    of = first.which == kind
    still = all(np.array_equal(s.points, first.points) for s in same.values())
    cells = _fan(first.corners[of])
    used, numbers = np.unique(cells, return_inverse=True)
    if all(len(s.corners) == len(first.corners) for s in same.values()):
        vertices = {key: s.points[used].astype(np.float32) for key, s in same.items()}
        indices = numbers.reshape(-1, 3).astype(np.uint32)
    else:
        vertices = {key: _separate_triangles(first, s, of) for key, s in same.items()}
        indices = np.arange(3 * len(cells), dtype=np.uint32).reshape(-1, 3)
    return k3d.mesh(
        next(iter(vertices.values())) if still else vertices,
        indices,
        color=_code(first.colours[kind]),
        side="double",
        flat_shading=True,
    )


def _field_mesh(
    k3d: ModuleType, first: Surface, same: dict[str, Surface], colour_scale: ColourScale
) -> k3d.objects.Mesh:
    """Mesh coloured by a field, polygon by polygon."""
    per_cell = first.corners.shape[1] - 2
    vertices, values = {}, {}
    is_whole = all(len(surface.corners) == len(first.corners) for surface in same.values())
    if is_whole and len(first.corners) > FINE:
        indices = _fan(first.corners).astype(np.uint32)
        for key, surface in same.items():
            vertices[key] = surface.points.astype(np.float32)
            values[key] = _at_vertices(surface.values, surface.corners, len(surface.points))
    else:
        everything = np.ones(len(first.corners), bool)
        indices = np.arange(3 * per_cell * len(first.corners), dtype=np.uint32).reshape(-1, 3)
        for key, surface in same.items():
            vertices[key] = _separate_triangles(first, surface, everything)
            whole = np.zeros(len(first.corners))
            whole[_positions(first, surface)] = surface.values
            values[key] = np.repeat(whole, 3 * per_cell).astype(np.float32)
    table = colour_scale.table[:: len(colour_scale.table) // COLOURS] / 255.0
    shares = np.linspace(0.0, 1.0, len(table))
    return k3d.mesh(
        vertices,
        indices,
        attribute=values,
        color_map=np.column_stack([shares, table]).ravel().astype(np.float32),
        color_range=[colour_scale.low, colour_scale.high],
        side="double",
        flat_shading=True,
    )


def _at_vertices(values: np.ndarray | None, corners: np.ndarray, count: int) -> np.ndarray:
    """Values (n,) of points: the mean of those of the polygons around each."""
    assert values is not None
    weights = np.repeat(values, corners.shape[1])
    sums = np.bincount(corners.ravel(), weights, minlength=count)
    around = np.bincount(corners.ravel(), minlength=count)
    means: np.ndarray = (sums / np.maximum(around, 1)).astype(np.float32)
    return means


def _separate_triangles(first: Surface, surface: Surface, of: np.ndarray) -> np.ndarray:
    """Vertices (n, 3) of triangles that share none; of those deleted since, all in one point."""
    positions = _positions(first, surface)
    corners = first.corners.copy()
    gone = np.ones(len(corners), bool)
    gone[positions] = False
    corners[gone] = corners[gone][:, :1]
    triangles: np.ndarray = surface.points[_fan(corners[of]).ravel()].astype(np.float32)
    return triangles


def _positions(first: Surface, surface: Surface) -> np.ndarray:
    """Indices of the polygons of a surface among those of the first."""
    return np.searchsorted(first.rows, surface.rows)


def _fan(corners: np.ndarray) -> np.ndarray:
    """Triangles (m, 3) of polygons, those of one polygon one after the other."""
    inner = range(1, corners.shape[1] - 1)
    return np.stack([corners[:, [0, k, k + 1]] for k in inner], axis=1).reshape(-1, 3)


def _segments(
    k3d: ModuleType, ends: dict[str, np.ndarray], colour: str, width: float
) -> k3d.objects.Lines:
    """Lines (n, 2, 3) that move."""
    count = len(next(iter(ends.values())))
    vertices = {key: two.reshape(-1, 3).astype(np.float32) for key, two in ends.items()}
    indices = np.arange(2 * count, dtype=np.uint32).reshape(-1, 2)
    return k3d.lines(
        vertices, indices, indices_type="segment", width=width, color=_code(colour), shader="mesh"
    )


def _arrow_ends(frames: dict[str, Drawing], arrow: float) -> dict[str, np.ndarray]:
    """Ends (n, 2, 3) of arrows, as many at all times: those missing have no length."""
    ends_of = {}
    for key, drawing in frames.items():
        ends = [np.stack([starts, starts + arrow * v], axis=1) for starts, v in drawing.arrows]
        ends_of[key] = np.concatenate([np.empty((0, 2, 3)), *ends])
    most = max(1, *(len(ends) for ends in ends_of.values()))
    return {key: np.concatenate([e, np.zeros((most - len(e), 2, 3))]) for key, e in ends_of.items()}


def _code(colour: str) -> int:
    return int(colour[1:], 16)


def _titled(text: str, title: str) -> str:
    """The page with its title in the browser's tab."""
    before, _, rest = text.partition("<title>")
    _, _, after = rest.partition("</title>")
    return f"{before}<title>{escape(title)}</title>{after}"
