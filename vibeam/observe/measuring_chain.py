"""Measuring chain of an experiment as an observer of any motion (paper §5: 500 Hz low-pass, 5 kHz).

Sensor → low-pass → sampling → noise → quantisation → velocity. Stages that a chain does not name are absent.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from vibeam.observe.low_pass import LowPass, filtered
from vibeam.observe.motion import Path
from vibeam_models.arrays import Array

Velocity = Literal["exact", "central differences"]


@dataclass(frozen=True)
class Chain:
    """Measuring chain of a displacement.

    ``rate``: samples a second. ``low_pass``: the analog filter before sampling. ``noise``: rms of white Gaussian noise
    on the samples, m, from ``seed``, which it needs. ``quantum``: the converter's step, m. ``velocity``: by central
    differences of the record, or ``"exact"``: a second, ideal sensor behind the same filter. ``oversampling``: inputs
    of the filter a sample; its error falls with the square. ValueError names every argument that is wrong.
    """

    rate: float
    low_pass: LowPass | None = None
    noise: float | None = None
    seed: int | None = None
    quantum: float | None = None
    velocity: Velocity = "central differences"
    oversampling: int = 16

    def __post_init__(self) -> None:
        faults = []
        for name in ("rate", "noise", "quantum"):
            value = getattr(self, name)
            if value is not None and not (np.isfinite(value) and value > 0):
                faults.append(f"{name}: {value} is not positive")
        if (self.noise is None) != (self.seed is None):
            faults.append("noise and seed: the one needs the other")
        if self.velocity not in get_args(Velocity):
            faults.append(f"velocity: {self.velocity!r} is none of {', '.join(get_args(Velocity))}")
        if self.oversampling < 1:
            faults.append(f"oversampling: {self.oversampling} is below 1")
        if faults:
            raise ValueError("; ".join(faults))


@dataclass(frozen=True)
class Record:
    """Evenly spaced samples (m,): ``time`` s, ``displacement`` m, ``velocity`` m/s."""

    time: Array
    displacement: Array
    velocity: Array

    @property
    def rate(self) -> float:
        """Sampling rate, 1/s."""
        return (len(self.time) - 1) / float(self.time[-1] - self.time[0])

    def after(self, t: float) -> Record:
        """Record from time t on, for example without the transient of a filter."""
        kept = self.time >= t
        return Record(self.time[kept], self.displacement[kept], self.velocity[kept])


def measure(path: Path, chain: Chain, output: str = "sensor") -> Record:
    """Measured record of an output, from the motion's start to its end.

    The filter is causal: its output lags by about ``low_pass.delay()``, and starts as if the first value had always
    been there. ValueError for a motion shorter than three samples, KeyError for an unknown output.
    """
    count = int(np.floor((path.t_end - path.t_start) * chain.rate * (1 + 1e-12)))
    if count < 2:
        raise ValueError(f"rate: at {chain.rate} Hz the motion is shorter than three samples")
    fine = chain.oversampling if chain.low_pass is not None else 1
    dense = path.t_start + np.arange(count * fine + 1) / (chain.rate * fine)
    dense = np.minimum(dense, path.t_end)
    displacement = _sampled(path.at(dense, output), chain, fine)
    displacement = _with_noise_and_steps(displacement, chain)
    if chain.velocity == "exact":
        velocity = _sampled(path.velocity_at(dense, output), chain, fine)
    else:
        velocity = central_differences(displacement, 1 / chain.rate)
    return Record(dense[::fine], displacement, velocity)


def central_differences(values: ArrayLike, step: float) -> Array:
    """Central differences (x_{j+1} − x_{j−1})/2h (m,); one-sided differences of first order at both ends."""
    return np.asarray(np.gradient(np.asarray(values, dtype=float), step))


def _sampled(dense: Array, chain: Chain, fine: int) -> Array:
    if chain.low_pass is None:
        return dense
    return filtered(chain.low_pass, dense, 1 / (chain.rate * fine))[::fine]


def _with_noise_and_steps(samples: Array, chain: Chain) -> Array:
    """Samples with the noise and quantisation of the chain."""
    if chain.noise is not None:
        samples = samples + chain.noise * np.random.default_rng(chain.seed).standard_normal(len(samples))
    if chain.quantum is not None:
        samples = chain.quantum * np.round(samples / chain.quantum)
    return samples
