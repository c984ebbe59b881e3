"""What the keys of [measurement] say together: a filter and what it needs, noise and its seed."""

from __future__ import annotations

from collections.abc import Iterator
from types import SimpleNamespace

from vibeam.reading import Complaint


def measurement_checks(chain: SimpleNamespace | None) -> Iterator[Complaint]:
    """Complaints about the filter and the noise of [measurement]."""
    if chain is None:
        return
    path = ("measurement",)
    for name, example in (("order", "4"), ("cut_off", '"500 Hz"')):
        given = getattr(chain, name) is not None
        if chain.low_pass is None and given:
            yield (*path, name), 'goes with a filter: write low_pass = "bessel", or leave it away'
        elif chain.low_pass is not None and not given:
            yield (*path, name), f"missing: the filter needs it; write {name} = {example}"
    for name in ("ripple", "attenuation"):
        if getattr(chain, name) is not None and chain.low_pass != "elliptic":
            yield (*path, name), 'goes with low_pass = "elliptic" alone: leave it away'
    if chain.ripple is not None and chain.attenuation is not None and chain.ripple >= chain.attenuation:
        yield (*path, "ripple"), f"{chain.ripple:g} dB is not below attenuation, {chain.attenuation:g} dB"
    if chain.noise is not None and chain.seed is None:
        yield (*path, "seed"), "missing: the noise needs one; write seed = 1"
    elif chain.noise is None and chain.seed is not None:
        yield (*path, "seed"), "goes with noise: leave it away"
