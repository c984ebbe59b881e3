"""Flow of disturbances in a linear regime: exp(A t) block by block, on all columns at once."""

from __future__ import annotations

from vibeam.flight.kernels.compiler import kernel
from vibeam.flight.kernels.roots.pair import propagator
from vibeam.flight.kernels.tangents import layout as row
from vibeam.flight.kernels.tangents.layout import Flow, Workspace
from vibeam_models.arrays import Array


@kernel
def power(flow: Flow, k: int, t: float) -> tuple[float, float]:
    """C and S with exp(A t) = C + S (A + σ) of block k, t ≥ 0."""
    blocks = flow.blocks
    _, odd, _, rest = propagator(blocks[row.SIGMA, k], blocks[row.OMEGA, k], blocks[row.DISC, k], t)
    return rest + blocks[row.SIGMA, k] * odd, odd


@kernel
def propagate(flow: Flow, frame: Array, t: float, work: Workspace) -> None:
    """Columns of ``frame`` (2n, c) over t ≥ 0; in a regime that holds the contact, what would move it is taken out."""
    if flow.into.shape[0] == 0:
        propagate_modes(flow, frame, t)
        return
    to_blocks(flow, frame, work.frame)
    for k in range(flow.blocks.shape[1]):
        even, odd = power(flow, k, t)
        turn(flow, k, even, odd, work.frame, frame.shape[1])
    from_blocks(flow, work.frame, frame)


@kernel
def propagate_modes(flow: Flow, frame: Array, t: float) -> None:
    """The same of modes by themselves."""
    blocks, n = flow.blocks, flow.blocks.shape[1]
    for k in range(n):
        p00, p01, p10, p11 = propagator(blocks[row.SIGMA, k], blocks[row.OMEGA, k], blocks[row.DISC, k], t)
        for j in range(frame.shape[1]):
            x, y = frame[k, j], frame[n + k, j]
            frame[k, j], frame[n + k, j] = p00 * x + p01 * y, p10 * x + p11 * y


@kernel
def turn(flow: Flow, k: int, even: float, odd: float, y: Array, columns: int) -> None:
    """C + S (A + σ) on the rows 2k and 2k + 1 of y, its first columns."""
    blocks = flow.blocks
    sigma = blocks[row.SIGMA, k]
    p00, p01 = even + odd * (blocks[row.A11, k] + sigma), odd * blocks[row.A12, k]
    p10, p11 = odd * blocks[row.A21, k], even + odd * (blocks[row.A22, k] + sigma)
    for j in range(columns):
        a, b = y[2 * k, j], y[2 * k + 1, j]
        y[2 * k, j], y[2 * k + 1, j] = p00 * a + p01 * b, p10 * a + p11 * b


@kernel
def to_blocks(flow: Flow, frame: Array, y: Array) -> None:
    """Columns (2n, c) in the flow's coordinates."""
    if flow.into.shape[0] == 0:
        n = flow.blocks.shape[1]
        for k in range(n):
            for j in range(frame.shape[1]):
                y[2 * k, j], y[2 * k + 1, j] = frame[k, j], frame[n + k, j]
        return
    multiply(flow.into, frame, y, frame.shape[1])


@kernel
def from_blocks(flow: Flow, y: Array, frame: Array) -> None:
    """Columns (2n, c) out of the flow's coordinates."""
    if flow.into.shape[0] == 0:
        n = flow.blocks.shape[1]
        for k in range(n):
            for j in range(frame.shape[1]):
                frame[k, j], frame[n + k, j] = y[2 * k, j], y[2 * k + 1, j]
        return
    multiply(flow.outof, y, frame, frame.shape[1])


@kernel
def multiply(left: Array, right: Array, out: Array, columns: int) -> None:
    """out = left · right, of the first columns."""
    for i in range(left.shape[0]):
        for j in range(columns):
            out[i, j] = 0.0
        for k in range(left.shape[1]):
            factor = left[i, k]
            if factor != 0.0:
                for j in range(columns):
                    out[i, j] += factor * right[k, j]
