"""Time integral of each mode's energy ½(η'² + ω²η²) in block flow: rest, contact with a linear stop, coupled damping.

Every mode is a sum of the same exponentials, η_k = Σ_i Re(a_ki e^{λ_i t}): one of each block (two where it is
overdamped), the steady response, the offset. So the integrals of their products are those of ``energy``, made once for
all modes. Gauss's quadrature takes the place where it costs less, and where the closed form would lose digits: blocks
near critical damping or carried by Taylor series, sums that cancel. Where the whole would take too many panels it goes
on from panel to panel, each as long as what has not yet decayed allows.
"""

from __future__ import annotations

from math import ceil, sqrt

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.block_flow import advance_blocks, block_after
from vibeam.flight.kernels.compiler import joined, kernel
from vibeam.flight.kernels.drive import phase, wrap
from vibeam.flight.kernels.energy import (
    CANCELLED,
    FADED,
    MOST,
    NODES,
    PANEL,
    SPLIT,
    WEIGHTS,
    SteadyResponse,
    flight_energy,
    growth,
    integral,
)
from vibeam.flight.kernels.layout import Regime, Watch
from vibeam_models.arrays import Array

LOST = 1e-9  # share of its parts below which a sum is not taken, though quadrature takes many panels
STEPS = 131_072  # panels of a regime at most
RATE, GROWN, AMPLITUDE = range(3)  # columns of regime.terms: λ, e^{λt} − 1, and from there on a mode's amplitude each


@kernel
def energy_in_blocks(regime: Regime, drive: Array, own: Array, clock: float, duration: float, watch: Watch) -> None:
    """Add ∫ E_k dt over ``duration`` of a regime entered at ``clock`` to watch.energy (n,); ``own``: the modes' ω."""
    m, rate = regime.blocks.shape[1], drive[layout.W]
    for k in range(m):
        rate = max(rate, regime.pairs[layout.KAPPA, k])
    panels = int(min(MOST + 1, max(1, ceil(rate * duration / PANEL))))
    if panels > 1 and 8 * panels > m and is_sum_of_exponentials(regime):
        total, parts = watch.scratch[0], watch.scratch[1]
        set_terms(regime, drive, clock, duration)
        sum_products(regime.terms, own, duration, total, parts)
        if not is_cancelled(total, parts, LOST if panels > MOST else CANCELLED):
            for k in range(own.shape[0]):
                watch.energy[k] += total[k]
            return
    if panels > MOST:
        energy_by_steps(regime, drive, own, clock, duration, watch)
    else:
        energy_by_panels(regime, drive, own, clock, duration / panels, panels, watch)


@kernel
def is_sum_of_exponentials(regime: Regime) -> bool:
    """True where every block has a steady response and is not near critical damping."""
    for k in range(regime.blocks.shape[1]):
        own = regime.pairs[layout.OMEGA, k]
        if regime.blocks[layout.CARRIED, k] > 0.0 or abs(regime.pairs[layout.DISC, k]) < SPLIT * SPLIT * own * own:
            return False
    return True


@kernel
def set_terms(regime: Regime, drive: Array, clock: float, duration: float) -> None:
    """Set regime.terms for what the regime was entered with.

    e^{At} z = e^{−σt}(C z + S q), q = (A + σ) z: Re[(z − iq/w) e^{(−σ+iw)t}], or ½(z + q/r) e^{(−σ+r)t} +
    ½(z − q/r) e^{(−σ−r)t}.
    """
    blocks, terms, n, m = regime.blocks, regime.terms, regime.held.shape[0], regime.blocks.shape[1]
    cosine, sine = phase(drive, clock)
    terms[:, :, :] = 0.0
    put(terms, 2 * m, RATE, 1j * drive[layout.W])
    for i in range(n):
        terms[0, 2 * m + 1, AMPLITUDE + i] = regime.held[i]
    for k in range(m):
        sigma, disc, own = regime.pairs[layout.SIGMA, k], regime.pairs[layout.DISC, k], regime.pairs[layout.OMEGA, k]
        z1, z2 = blocks[layout.Z1, k], blocks[layout.Z2, k]
        q1 = (blocks[layout.A11, k] + sigma) * z1 + blocks[layout.A12, k] * z2
        q2 = blocks[layout.A21, k] * z1 + (blocks[layout.A22, k] + sigma) * z2
        root = sqrt(abs(disc))
        if disc < 0.0:
            put(terms, 2 * k, RATE, -sigma + 1j * root)
            add_block(regime, k, 2 * k, z1 - 1j * (q1 / root), z2 - 1j * (q2 / root))
        else:
            put(terms, 2 * k, RATE, complex(-own * own / (sigma + root), 0.0))
            put(terms, 2 * k + 1, RATE, complex(-sigma - root, 0.0))
            add_block(regime, k, 2 * k, 0.5 * (z1 + q1 / root) + 0j, 0.5 * (z2 + q2 / root) + 0j)
            add_block(regime, k, 2 * k + 1, 0.5 * (z1 - q1 / root) + 0j, 0.5 * (z2 - q2 / root) + 0j)
        s1 = blocks[layout.RE1, k] * sine + blocks[layout.IM1, k] * cosine
        c1 = blocks[layout.RE1, k] * cosine - blocks[layout.IM1, k] * sine
        s2 = blocks[layout.RE2, k] * sine + blocks[layout.IM2, k] * cosine
        c2 = blocks[layout.RE2, k] * cosine - blocks[layout.IM2, k] * sine
        add_block(regime, k, 2 * m, s1 - 1j * c1, s2 - 1j * c2)
        add_block(regime, k, 2 * m + 1, blocks[layout.OFFSET1, k] + 0j, blocks[layout.OFFSET2, k] + 0j)
    for i in range(2 * m + 2):
        put(terms, i, GROWN, growth(at(terms, i, RATE), duration))


@joined
def at(terms: Array, i: int, column: int) -> complex:
    """An entry of ``terms``."""
    return complex(terms[0, i, column], terms[1, i, column])


@joined
def put(terms: Array, i: int, column: int, value: complex) -> None:
    """Set an entry of ``terms``."""
    terms[0, i, column], terms[1, i, column] = value.real, value.imag


@kernel
def add_block(regime: Regime, k: int, i: int, first: complex, second: complex) -> None:
    """Add what block k has of the i-th term, in its own coordinates, to every mode's amplitude."""
    for mode in range(regime.held.shape[0]):
        a, b = regime.outof[mode, 2 * k], regime.outof[mode, 2 * k + 1]
        regime.terms[0, i, AMPLITUDE + mode] += a * first.real + b * second.real
        regime.terms[1, i, AMPLITUDE + mode] += a * first.imag + b * second.imag


@kernel
def sum_products(terms: Array, own: Array, t: float, total: Array, parts: Array) -> None:
    """∫ ½(η'² + ω²η²) over t of every mode, and the sum of its parts' sizes.

    Two terms Re(a e^{λt}), Re(b e^{μt}) give ½ Re[ab(λμ + ω²) ∫e^{(λ+μ)t} + ab*(λμ* + ω²) ∫e^{(λ+μ*)t}], a term with
    itself half of that.
    """
    total[:], parts[:] = 0.0, 0.0
    count = terms.shape[1]
    for i in range(count):
        first, grown = at(terms, i, RATE), at(terms, i, GROWN)
        if first == 0.0 and i < count - 2:  # no second term of a block
            continue
        for j in range(i, count):
            second, turned = at(terms, j, RATE), at(terms, j, GROWN)
            if second == 0.0 and j < count - 2:
                continue
            other, weight = second.conjugate(), 0.25 if i == j else 0.5
            one = weight * integral(first + second, grown, turned, t)
            two = weight * integral(first + other, grown, turned.conjugate(), t)
            for k in range(own.shape[0]):
                a, b, square = at(terms, i, AMPLITUDE + k), at(terms, j, AMPLITUDE + k), own[k] * own[k]
                part = (a * b * (first * second + square) * one).real
                part += (a * b.conjugate() * (first * other + square) * two).real
                total[k] += part
                parts[k] += abs(part)


@kernel
def is_cancelled(total: Array, parts: Array, share: float) -> bool:
    """True where some mode's energy is less than that share of the parts of its sum, so that digits are lost."""
    lacking = 0.0
    for k in range(total.shape[0]):
        lacking = max(lacking, share * parts[k] - total[k])
    return lacking > 0.0


@kernel
def energy_by_panels(
    regime: Regime, drive: Array, own: Array, clock: float, h: float, panels: int, watch: Watch
) -> None:
    """The same as ``energy_in_blocks``, by Gauss's quadrature with eight nodes on each of ``panels`` of length h."""
    pose, energy = watch.scratch, watch.energy
    for panel in range(panels):
        for node in range(8):
            advance_blocks(regime, drive, pose, clock, (panel + NODES[node]) * h)
            for k in range(own.shape[0]):
                energy[k] += 0.5 * h * WEIGHTS[node] * (pose[1, k] ** 2 + (own[k] * pose[0, k]) ** 2)


@kernel
def energy_by_steps(regime: Regime, drive: Array, own: Array, clock: float, duration: float, watch: Watch) -> None:
    """The same panel by panel, the regime entered anew at each: as many as are resolved, up to ``STEPS``.

    The blocks' coordinates are those of the end then.
    """
    pose, energy, done = watch.scratch, watch.energy, 0.0
    while done < duration:
        rate, h = rate_left(regime, drive, done), duration - done
        if rate * h > PANEL:
            h = min(h, max(PANEL / rate, duration / STEPS))
        for node in range(8):
            advance_blocks(regime, drive, pose, clock, NODES[node] * h)
            for k in range(own.shape[0]):
                energy[k] += 0.5 * h * WEIGHTS[node] * (pose[1, k] ** 2 + (own[k] * pose[0, k]) ** 2)
        for k in range(regime.blocks.shape[1]):
            z1, z2 = block_after(regime, drive, k, clock, h)
            regime.blocks[layout.Z1, k], regime.blocks[layout.Z2, k] = z1, z2
        clock = wrap(drive, clock + h)
        done += h


@kernel
def rate_left(regime: Regime, drive: Array, time: float) -> float:
    """The fastest rate of the drive and of what has not decayed a time after a regime was entered."""
    pairs, rate = regime.pairs, drive[layout.W]
    for k in range(regime.blocks.shape[1]):
        if regime.blocks[layout.CARRIED, k] > 0.0:
            rate = max(rate, pairs[layout.KAPPA, k])
        elif pairs[layout.DECAY, k] * time <= FADED:
            fast = pairs[layout.SIGMA, k] + sqrt(max(pairs[layout.DISC, k], 0.0))
            rate = max(rate, pairs[layout.KAPPA, k] if fast * time <= FADED else pairs[layout.DECAY, k])
    return float(rate)


@kernel
def is_modal(regime: Regime) -> bool:
    """True where every block of a regime is one mode by itself, with a steady response."""
    for k in range(regime.blocks.shape[1]):
        if regime.blocks[layout.MODE, k] < 0.0 or regime.blocks[layout.CARRIED, k] > 0.0:
            return False
    return True


@kernel
def energy_by_mode(regime: Regime, drive: Array, clock: float, duration: float, energy: Array) -> None:
    """The same where every block is one mode by itself, in closed form."""
    blocks, w, n = regime.blocks, drive[layout.W], energy.shape[0]
    cosine, sine = phase(drive, clock)
    turned = growth(1j * w, duration)
    for k in range(blocks.shape[1]):
        mode = int(blocks[layout.MODE, k])
        at, rate = regime.outof[mode, 2 * k], regime.outof[n + mode, 2 * k + 1]
        re, im = at * blocks[layout.RE1, k], at * blocks[layout.IM1, k]
        offset = at * blocks[layout.OFFSET1, k] + regime.held[mode]
        steady = (re * sine + im * cosine) - 1j * (re * cosine - im * sine)  # Re(steady e^{iΩt})
        x, y = at * blocks[layout.Z1, k], rate * blocks[layout.Z2, k]
        energy[mode] += flight_energy(regime.pairs, k, x, y, SteadyResponse(steady, w, offset), duration, turned)
