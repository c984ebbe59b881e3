"""Drawing of a scene to scale, as SVG: the beam with supports, masses, stop, sensors and drive; its mode shapes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from html import escape
from math import isinf

import numpy as np

from vibeam.report.page.parts import Picture, as_csv
from vibeam.studies.modes import ModeTable, mode_table
from vibeam.system.number_text import percent, shown_in
from vibeam_models.arrays import Array
from vibeam_models.beams.beam import Beam
from vibeam_models.scene import AnyScene, Scene

WIDTH, HEIGHT = 960, 250  # px of the drawing
LEFT, RIGHT, AXIS = 70.0, 50.0, 135.0  # px to the first end of the beam, beyond its other end, down to its axis
THIN = 1.5  # px: least height of a beam that is drawn
POINTS = 8  # of the outline on each stretch
LETTER, ROW = 6.6, 14.0  # px: mean width of a letter, height of a line of text


@dataclass(frozen=True)
class SceneFrame:
    """Pixels of a place along the beam, and of a height."""

    length: float

    @property
    def scale(self) -> float:
        """Pixels a metre."""
        return (WIDTH - LEFT - RIGHT) / self.length

    def x(self, place: float) -> float:
        """Pixels from the left to a ``place`` (m) along the beam."""
        return LEFT + self.scale * place


@dataclass(frozen=True)
class _Label:
    """Text with its middle at ``x`` and its base line at ``y``, px; ``way``: 1 gives way downward, −1 upward."""

    x: float
    y: float
    text: str
    way: int = 1

    @property
    def half(self) -> float:
        return 0.5 * LETTER * len(self.text)

    def meets(self, other: _Label) -> bool:
        return abs(self.x - other.x) < self.half + other.half + 4 and abs(self.y - other.y) < ROW

    def __str__(self) -> str:
        return f'<text x="{self.x:.1f}" y="{self.y:.1f}">{escape(self.text)}</text>'


def _apart(labels: Iterable[_Label]) -> list[_Label]:
    """Labels inside the drawing, each a line further from the beam where it would meet one before it."""
    placed: list[_Label] = []
    for label in labels:
        own = replace(label, x=min(max(label.x, label.half + 2), WIDTH - label.half - 2))
        while any(own.meets(other) for other in placed):
            own = replace(own, y=own.y + ROW * own.way)
        placed.append(own)
    return placed


def drawing(scene: AnyScene) -> str:
    """SVG of a rig to one scale in both directions; empty where a scene has no beam.

    Masses have no known shape: a box over their rigid zone, or a small one. A gap that is less than a pixel is said.
    """
    if not isinstance(scene, Scene):
        return ""
    frame = SceneFrame(scene.beam.length)
    parts = [*_base(scene, frame), *_beam(scene.shaped_beam, frame), *_held(scene, frame), *_masses(scene, frame)]
    parts += [*_stop(scene, frame), *_sensors(scene, frame), *_drive(scene, frame)]
    labels = _apart(_labels(scene, frame))
    height = max([HEIGHT, *(each.y + 2 * ROW for each in labels)])
    parts += [*map(str, labels), *_ruler(frame, height - 8)]
    return _svg(height, _spoken(scene), parts)


def _svg(height: float, words: str, parts: Iterable[str]) -> str:
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height:.0f}" role="img" '
        f'aria-label="{escape(words, quote=True)}" class="scene">{"".join(parts)}</svg>'
    )


def _spoken(scene: Scene) -> str:
    mass = "no attached mass" if scene.mass is None else f"a mass of {scene.mass.mass:.4g} kg"
    return (
        f"Side view to scale: a {scene.beam.ends} beam of {_said('m', scene.beam.length)}, {mass}, "
        f"a stop at {_said('m', scene.stop.position)} with a gap of {_said('m', scene.stop.gap)}"
    )


def _beam(beam: Beam, frame: SceneFrame) -> Iterator[str]:
    for piece in beam.stretches:
        x = np.linspace(piece.start, piece.end, POINTS)
        height = piece.section(x).height
        known = height is not None
        half = np.broadcast_to(0.0 if height is None else np.asarray(height, dtype=float), x.shape) / 2 * frame.scale
        half = np.maximum(half, THIN / 2)
        upper = [f"{frame.x(a):.2f},{AXIS - b:.2f}" for a, b in zip(x, half, strict=True)]
        lower = [f"{frame.x(a):.2f},{AXIS + b:.2f}" for a, b in zip(x[::-1], half[::-1], strict=True)]
        yield f'<polygon class="beam{"" if known else " unknown"}" points="{" ".join(upper + lower)}"/>'


def _held(scene: Scene, frame: SceneFrame) -> Iterator[str]:
    for each in scene.shaped_beam.held:
        x = frame.x(each.position)
        if isinf(each.stiffness) and isinf(each.rotational_stiffness):
            left = x if each.position else x - 16
            yield f'<rect class="wall" x="{left:.1f}" y="{AXIS - 40}" width="16" height="80"/>'
        elif isinf(each.stiffness):
            yield f'<path class="part" d="M{x:.1f} {AXIS + 3} l-9 16 h18 z"/>'
        else:
            yield _spring(x, AXIS + 3)


def _masses(scene: Scene, frame: SceneFrame) -> Iterator[str]:
    zones = dict(scene.rigid_zones)
    for _, position in scene.weights:
        half = max(zones.get(position, 0.0) * frame.scale, 5.0)
        x = frame.x(position)
        yield f'<rect class="mass" x="{x - half:.1f}" y="{AXIS - 18}" width="{2 * half:.1f}" height="36" rx="2"/>'


def _stops(scene: Scene) -> Iterator[tuple[str, float, float, int]]:
    """Name, place (m), gap (m) and side of every stop: −1 above the beam, 1 below."""
    stop = scene.stop
    yield "stop", stop.position, stop.gap, -1
    if stop.second_gap is not None:
        yield "second stop", stop.position, stop.second_gap, 1
    for each in scene.named("further_stop"):
        yield "further stop", each.position, each.gap, -1 if each.side == "above" else 1


def _stop(scene: Scene, frame: SceneFrame) -> Iterator[str]:
    for _, position, gap, way in _stops(scene):
        away = _reach(scene, position, frame) + max(gap, 0.0) * frame.scale
        tip = f"M{frame.x(position):.1f} {AXIS + way * away:.2f} l-7 {14 * way} v{16 * way} h14 v{-16 * way} z"
        yield f'<path class="stop" d="{tip}"/>'


def _reach(scene: Scene, position: float, frame: SceneFrame) -> float:
    """Pixels from the axis to the surface that the stop meets: of the mass where one is there."""
    zones = dict(scene.rigid_zones)
    near = (abs(position - at) <= max(zones.get(at, 0.0), 5 / frame.scale) for _, at in scene.weights)
    return 18.0 if any(near) else THIN


def _sensors(scene: Scene, frame: SceneFrame) -> Iterator[str]:
    for _, position in _outputs(scene):
        below = 24 + _lower(scene, position, frame)
        yield f'<path class="sensor" d="M{frame.x(position):.1f} {AXIS + below} v18 m-4 -12 l4 -6 l4 6"/>'


def _lower(scene: Scene, position: float, frame: SceneFrame) -> float:
    """Pixels by which a sensor gives way to a stop below the beam."""
    return 10.0 if any(way > 0 and abs(at - position) * frame.scale < 12 for _, at, _, way in _stops(scene)) else 0.0


def _outputs(scene: Scene) -> list[tuple[str, float]]:
    return [("sensor", scene.sensor.position), *((each.name, each.position) for each in scene.outputs)]


def _labels(scene: Scene, frame: SceneFrame) -> Iterator[_Label]:
    """Label of everything that is drawn, the masses' first: these have the least room."""
    arrows = [frame.x(position) for _, position in _outputs(scene)]
    for mass, position in scene.weights:
        label = _Label(frame.x(position), AXIS + 34, _said("kg", mass))
        met = any(abs(label.x - x) < label.half + 8 for x in arrows)
        yield replace(label, x=label.x - label.half - 12) if met else label
    for each in scene.shaped_beam.held:
        if not isinf(each.stiffness):
            words = f"{each.stiffness:.4g} N/m" if each.stiffness else "turns stiffly"
            yield _Label(frame.x(each.position), AXIS + 62, words)
    opposite = ", on the opposite beam" if scene.named("opposite") else ""
    first, *others = (
        _Label(frame.x(at), AXIS - 82 if way < 0 else AXIS + 90, f"{name}, gap {_said('m', gap)}", way)
        for name, at, gap, way in _stops(scene)
    )
    yield replace(first, text=first.text + opposite)
    for name, position in _outputs(scene):
        yield _Label(frame.x(position), AXIS + 56 + _lower(scene, position, frame), name)
    on = scene.base.on_beam
    yield _Label(22, 195, "drive") if on is None else _Label(frame.x(on[0]), AXIS + 74, "moment" if on[1] else "force")
    yield from others
    if scene.platform is not None:
        words = f"platform, {scene.platform.coupling}, {scene.platform.mass:.4g} kg"
        yield _Label(WIDTH / 2, AXIS + 104, words)


def _base(scene: Scene, frame: SceneFrame) -> Iterator[str]:
    if scene.platform is None:
        return
    yield f'<rect class="platform" x="{LEFT - 24}" y="{AXIS + 78}" width="{WIDTH - LEFT - RIGHT + 40}" height="12"/>'
    yield f'<path class="platform" d="M{LEFT - 16} {AXIS - 40} V{AXIS + 78}"/>'
    yield _spring(LEFT + 20, AXIS + 90, 20) + _spring(WIDTH - RIGHT, AXIS + 90, 20)


def _drive(scene: Scene, frame: SceneFrame) -> Iterator[str]:
    on = scene.base.on_beam
    if on is None:
        yield '<path class="drive" d="M22 95 v80 m-5 -72 l5 -8 l5 8 m-10 64 l5 8 l5 -8"/>'
        return
    yield f'<path class="drive" d="M{frame.x(on[0]):.1f} {AXIS + 60} v-34 m-5 8 l5 -8 l5 8"/>'


def _ruler(frame: SceneFrame, y: float) -> Iterator[str]:
    step = 10.0 ** np.floor(np.log10(frame.length))
    step = step / 2 if 2 * step > frame.length else step
    yield f'<path class="ruler" d="M{LEFT} {y} h{step * frame.scale:.2f} m0 -4 v8 M{LEFT} {y - 4} v8"/>'
    yield f'<text class="small" x="{LEFT + step * frame.scale + 8:.1f}" y="{y + 4}">{_said("m", step)}, to scale</text>'


def _spring(x: float, y: float, length: float = 40) -> str:
    turn = length / 8
    zigzag = " ".join(f"l{way * 7} {turn:.2f}" for way in (1, -2, 2, -2, 2, -2, 1))
    return f'<path class="part line" d="M{x:.1f} {y:.1f} v{turn:.2f} {zigzag} m-10 0 h20"/>'


def _said(unit: str, value: float) -> str:
    """A number in the prefix that suits it."""
    name, factor = shown_in(unit, value)
    return f"{value * factor:.4g} {name}" if value else "0"


FEWEST, MOST = 3, 8  # modes drawn
STRIP, REACH = 46.0, 17.0  # px: height of a strip, largest deflection in it
WORDS = (
    "Shapes of the first modes, each to its own height, above the place along the beam. Dotted: the stop's place, with "
    "the deflection there. Right: share of the contact's mobility that the modes up to this one carry."
)


def mode_shapes(scene: AnyScene, modes: int) -> Picture | None:
    """Picture of the first modes, ``modes`` of them but from three to eight; None where a scene has no beam."""
    if not isinstance(scene, Scene):
        return None
    table = mode_table(scene, min(max(modes, FEWEST), MOST))
    x, height = SceneFrame(scene.beam.length).x(scene.stop.position), STRIP * len(table.rows) + 8
    parts = [f'<path class="contact" d="M{x:.1f} 0V{height:.0f}"/>']
    parts += [part for at in range(len(table.rows)) for part in _strip(table, at, scene)]
    words = f"Shapes of {len(table.rows)} modes at " + ", ".join(_said("Hz", row.frequency) for row in table.rows)
    heads = [f"mode {row.number}, {row.frequency:.6g} Hz (kg^-1/2)" for row in table.rows]
    numbers = as_csv(["place (m)", *heads], np.column_stack([table.positions, table.shapes]).tolist())
    return Picture("Mode shapes", WORDS, _svg(height, words, parts), numbers)


def _strip(table: ModeTable, at: int, scene: Scene) -> Iterator[str]:
    frame, row, middle = SceneFrame(scene.beam.length), table.rows[at], STRIP * (at + 0.5) + 4
    shape = _scaled(table.shapes[:, at])
    points = " ".join(f"{frame.x(x):.1f},{middle - REACH * y:.1f}" for x, y in zip(table.positions, shape, strict=True))
    touch = middle - REACH * float(np.interp(scene.stop.position, table.positions, shape))
    yield f'<path class="axis" d="M{LEFT} {middle}H{WIDTH - RIGHT}"/><polyline class="shape" points="{points}"/>'
    yield f'<circle class="touch" cx="{frame.x(scene.stop.position):.1f}" cy="{touch:.1f}" r="3.5"/>'
    yield f'<text class="end" x="{LEFT - 8}" y="{middle - 2}">mode {row.number}</text>'
    yield f'<text class="end" x="{LEFT - 8}" y="{middle + 12}">{_said("Hz", row.frequency)}</text>'
    yield f'<text class="end" x="{WIDTH - 4}" y="{middle + 4}">{percent(row.share)}</text>'


def _scaled(shape: Array) -> Array:
    """Deflections over the largest, which is positive; 0 of a mode that does not bend the beam."""
    largest = float(shape[np.argmax(np.abs(shape))])
    return shape / largest if largest else shape
