"""Animated pictures of a figure: GIF by Pillow, MP4 by ffmpeg where it is installed."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import matplotlib as mpl
import numpy as np
from numpy.typing import NDArray

from vibeam.exchange.whole_files import write_whole
from vibeam.figures.page import PAGE, composed

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.figure import Figure

    from vibeam.case.case import Case

Picture = NDArray[np.uint8]
FRAMES_A_SECOND = 20
DOTS = 100  # dots an inch
COLOURS = 64  # of a GIF, few so that it is small
PICTURES = (".gif", ".mp4")
NO_FFMPEG = 'mp4 needs ffmpeg, which is not found: install it (apt install ffmpeg), or write format = "gif"'


@dataclass(frozen=True)
class Moving:
    """Moving parts of a figure: ``turn(k)`` sets the ``artists`` to frame k of ``count``, the first after the last."""

    count: int
    turn: Callable[[int], None]
    artists: Sequence[Artist]


def write_moving(make: Callable[[], tuple[Figure, Moving]], paths: Sequence[Path], mark: str | None = None) -> None:
    """Draw all frames of a figure and write them, with ``mark`` in the file; the format follows each path's ending.

    ValueError where ffmpeg is needed and not there, or fails.
    """
    frames = pictures(make)
    for path in paths:
        write_whole(path, (gif if path.suffix == ".gif" else mp4)(frames, mark or ""))


def pictures(make: Callable[[], tuple[Figure, Moving]]) -> list[Picture]:
    """Frames (height, width, 3): the page drawn once, and what moves drawn upon it for each."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    made: list[Moving] = []

    def page() -> Figure:
        figure, moving = make()
        made.append(moving)
        return figure

    with mpl.rc_context(PAGE):
        figure = composed(page)
        figure.set_dpi(DOTS)
        canvas: Any = FigureCanvasAgg(figure)
        for artist in made[0].artists:
            artist.set_animated(True)
        canvas.draw()
        still = canvas.copy_from_bbox(figure.bbox)
        return [_picture(canvas, still, made[0], index) for index in range(made[0].count)]


def _picture(canvas: Any, still: Any, moving: Moving, index: int) -> Picture:
    canvas.restore_region(still)
    moving.turn(index)
    for artist in sorted(moving.artists, key=lambda each: float(each.get_zorder())):
        canvas.figure.draw_artist(artist)
    return np.array(canvas.buffer_rgba())[..., :3]


def gif(frames: Sequence[Picture], mark: str) -> bytes:
    """An endless GIF in a few colours common to all frames, without dither."""
    from PIL import Image

    none = Image.Dither.NONE
    seen = np.vstack([frame[::2, ::2] for frame in frames])
    palette = Image.fromarray(seen).quantize(COLOURS, Image.Quantize.MAXCOVERAGE, dither=none)  # rare colours too
    made = [Image.fromarray(frame).quantize(palette=palette, dither=none) for frame in frames]
    content = BytesIO()
    made[0].save(
        content, format="GIF", save_all=True, append_images=made[1:], duration=1000 // FRAMES_A_SECOND, loop=0,
        comment=mark.encode(),
    )  # fmt: skip
    return content.getvalue()


def mp4(frames: Sequence[Picture], mark: str) -> bytes:
    """An MP4 that every browser shows (H.264, 4:2:0); ValueError where ffmpeg is not there, or fails."""
    high, wide = (side - side % 2 for side in frames[0].shape[:2])
    with TemporaryDirectory() as folder:
        path = Path(folder) / "motion.mp4"
        asked = [
            *(require_ffmpeg(), "-loglevel", "error", "-f", "rawvideo", "-pixel_format", "rgb24"),
            *("-video_size", f"{wide}x{high}", "-framerate", str(FRAMES_A_SECOND), "-i", "-"),
            *("-metadata", f"comment={mark}", "-pix_fmt", "yuv420p", "-movflags", "+faststart", str(path)),
        ]
        content = b"".join(np.ascontiguousarray(frame[:high, :wide]).tobytes() for frame in frames)
        done = subprocess.run(asked, input=content, capture_output=True, check=False)
        if done.returncode:
            raise ValueError(f"ffmpeg made no mp4: {done.stderr.decode(errors='replace').strip()}")
        return path.read_bytes()


def require_programs(case: Case) -> None:
    """ValueError, with the table, where a figure of the case needs a program that is not there."""
    for name, plan in case.shows.items():
        if "mp4" in plan.format:
            try:
                require_ffmpeg()
            except ValueError as fault:
                raise ValueError(f"show.{name}.format: {fault}") from None


def require_ffmpeg() -> str:
    """Path of ffmpeg; ValueError, with the cure, where it is not there."""
    found: str | None = shutil.which(mpl.rcParams["animation.ffmpeg_path"])
    if found is None:
        raise ValueError(NO_FFMPEG)
    return found
