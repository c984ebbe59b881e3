"""Shaded pictures of surfaces: a parallel projection, hidden parts by a depth buffer, one light beside the viewer.

A pixel shows the triangle that is nearest to the viewer at its middle; a picture is made twice as fine as it is shown.
Brightness follows Lambert's law, so that colour alone tells the value, and grey the form.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vibeam_models.arrays import Array, Index

AZIMUTH, ELEVATION = np.radians(25.0), np.radians(22.0)  # of the viewer, from the side and from the plane z = 0
LIGHT = np.array([0.5, 0.75, 0.45]) / np.linalg.norm([0.5, 0.75, 0.45])  # to the right, up, toward the viewer
AMBIENT = 0.45  # brightness of what the light does not reach
FINER = 2  # pixels made for one shown, along each side
AT_ONCE = 4_000_000  # pixels of triangles


class ShadedPicture(NamedTuple):
    """Pixels (rows, columns, 4) from above, and where they lie: left, right, bottom, top in m of the projection."""

    pixels: Array
    extent: tuple[float, float, float, float]


def axes_of_view() -> Array:
    """Unit vectors (3, 3): to the right, up, toward the viewer."""
    side, high = np.array([np.cos(AZIMUTH), -np.sin(AZIMUTH), 0.0]), np.sin(ELEVATION)
    toward = np.array([-np.sin(AZIMUTH), -np.cos(AZIMUTH), 0.0]) * np.cos(ELEVATION) + np.array([0.0, 0.0, high])
    return np.stack([side, np.cross(toward, side), toward])


def projected(points: Array) -> Array:
    """Places (…, 3) as seen: to the right, up, toward the viewer, m."""
    return np.asarray(points @ axes_of_view().T)


def picture(points: Array, triangles: Index, colours: Array, pixel: float) -> ShadedPicture:
    """Picture of the ``triangles`` (t, 3) of ``points`` (k, 3), seen from outside, in ``colours`` (k, 3) of 0 … 1.

    ``pixel``: side of a pixel as shown, m.
    """
    corners = projected(points)[triangles]
    low, high = corners[..., :2].min(axis=(0, 1)), corners[..., :2].max(axis=(0, 1))
    columns, rows = (FINER * np.ceil((high - low) / pixel + 1)).astype(int)
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    seen = np.flatnonzero(normal[:, 2] > 0)
    normal = normal[seen] / np.linalg.norm(normal[seen], axis=1, keepdims=True)
    light = AMBIENT + (1 - AMBIENT) * np.maximum(normal @ LIGHT, 0.0)
    corners[..., :2] = (corners[..., :2] - low) * (FINER / pixel)
    found = np.zeros((rows * columns, 4))
    depth = np.full(rows * columns, -np.inf)
    for some in _parts(corners[seen]):
        _draw(corners[seen][some], light[some], colours[triangles[seen][some]], columns, depth, found)
    image = found.reshape(rows // FINER, FINER, columns // FINER, FINER, 4).mean(axis=(1, 3))
    image[..., :3] /= np.maximum(image[..., 3:], 1e-12)  # an edge is as transparent as it is empty
    extent = (low[0], low[0] + pixel * image.shape[1], low[1], low[1] + pixel * image.shape[0])
    return ShadedPicture(image[::-1], tuple(map(float, extent)))  # type: ignore[arg-type]


def _boxes(corners: Array) -> tuple[Index, Index]:
    """First pixel (t, 2) whose middle may lie in each triangle, and numbers (t, 2) of pixels along both sides."""
    first = np.ceil(corners[..., :2].min(axis=1) - 0.5).astype(np.int64)
    last = np.floor(corners[..., :2].max(axis=1) - 0.5).astype(np.int64)
    return first, np.maximum(last - first + 1, 0)


def _parts(corners: Array) -> list[Index]:
    """Triangles in parts of so many pixels that there is room for them."""
    count = np.cumsum(_boxes(corners)[1].prod(axis=1))
    return np.split(np.arange(len(corners)), np.flatnonzero(np.diff(count // AT_ONCE)) + 1)


def _draw(corners: Array, light: Array, colours: Array, columns: int, depth: Array, found: Array) -> None:
    """Put triangles (t, 3, 3), in pixels, into ``found`` (pixels, 4) where they lie before ``depth`` (pixels,)."""
    first, sides = _boxes(corners)
    count = sides.prod(axis=1)
    which = np.repeat(np.arange(len(corners)), count)
    place = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
    x, y = first[which, 0] + place % sides[which, 0], first[which, 1] + place // sides[which, 0]
    weights = _weights(corners[which, :, :2], np.stack([x, y], axis=1) + 0.5)
    inside = (weights >= 0).all(axis=1)
    which, weights, pixel = which[inside], weights[inside], (y * columns + x)[inside]
    near = np.einsum("pc,pc->p", weights, corners[which, :, 2])
    np.maximum.at(depth, pixel, near)
    front = near == depth[pixel]
    which, weights, pixel = which[front], weights[front], pixel[front]
    found[pixel, :3] = light[which, None] * np.einsum("pc,pck->pk", weights, colours[which])
    found[pixel, 3] = 1.0


def _weights(corners: Array, points: Array) -> Array:
    """Barycentric coordinates (p, 3) of points (p, 2) in triangles (p, 3, 2)."""
    one, two, off = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0], points - corners[:, 0]
    area = one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0]
    second = (off[:, 0] * two[:, 1] - off[:, 1] * two[:, 0]) / area
    third = (one[:, 0] * off[:, 1] - one[:, 1] * off[:, 0]) / area
    return np.stack([1 - second - third, second, third], axis=1)
