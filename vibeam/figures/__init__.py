"""What a case shows beside its frequency-response curves: each kind of [show.NAME] table is one entry and one module.

A kind's module has ``sheets(case, fidelity, plan)``, the numbers of one fidelity (kept in the results file), and
``draw(figure, result, plan, sheets)``, which makes the figure of them; ``size(plan)`` (inches) where the usual one will
not do. A case without such tables loads no kind.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class FigureKind:
    """One kind: where it is, what it shows, the keys that it needs and those that it may have.

    ``reads``: its columns that [expect.NAME] may hold to a number, ``entries``: the column by which one of them is
    chosen (none: their mean is meant). ``exact``: whether it asks for a motion that is exact between events.
    """

    home: str
    meaning: str
    needs: tuple[str, ...] = ()
    takes: tuple[str, ...] = ()
    reads: tuple[str, ...] = ()
    entries: str = ""
    exact: bool = False


MOTION = ("periods", "settle", "output")

OVER = ("frequency", *MOTION)

SHARES = ("energy_share", "displacement_share", "velocity_share", "impulse_share")

RINGING = ("ringing_frequency", "counted_frequency", "ringing_decay", "ringing_displacement", "ringing_velocity")

RESTITUTIONS = tuple(f"{how}_restitution" for how in ("true", "adjacent", "extremum", "extrapolated", "first_mode"))

KINDS = {
    "history": FigureKind("vibeam.figures.kinds.history", "displacement and velocity over time", ("frequency",), MOTION, ("jump",)),
    "portrait": FigureKind("vibeam.figures.kinds.portrait", "velocity over displacement", ("frequency",), MOTION),
    "section": FigureKind("vibeam.figures.kinds.section", "one point a drive period", ("frequency",), MOTION),
    "curve": FigureKind("vibeam.figures.kinds.curve", "another quantity over frequency", ("quantity",)),
    "boundaries": FigureKind("vibeam.figures.kinds.boundaries", "averaging's limits beside the exact ones", ("quantity",)),
    "harmonics": FigureKind(
        "vibeam.figures.kinds.harmonics", "amplitudes at multiples of the drive frequency, bars at a few, lines over many", (),
        (*OVER, "highest", "subdivision"), ("harmonic",), "order", exact=True,
    ),
    "spectrum": FigureKind(
        "vibeam.figures.kinds.spectrum", "amplitude spectra of displacement and velocity", ("frequency",), MOTION, exact=True
    ),
    "participation": FigureKind(
        "vibeam.figures.kinds.participation", "shares of the modes in energy, displacement, velocity and impulse",
        ("frequency",), MOTION, SHARES, "mode", exact=True,
    ),
    "ringing": FigureKind(
        "vibeam.figures.kinds.ringing", "frequency, by fit and by counted peaks, and size of what rings between impacts",
        ("near",), OVER, RINGING, exact=True,
    ),
    "restitution": FigureKind(
        "vibeam.figures.kinds.restitution", "the contact's restitution beside what is read off in other ways", (), OVER,
        RESTITUTIONS, exact=True,
    ),
    "modal": FigureKind(
        "vibeam.figures.kinds.modal", "frequencies and damping ratios of the modes", (), (), ("mode_frequency", "mode_damping"),
        "mode",
    ),
}  # fmt: skip

READ = tuple(dict.fromkeys(name for kind in KINDS.values() for name in kind.reads))

KEYS = ("frequency", "periods", "settle", "quantity", "output", "near", "highest", "subdivision")  # by kind

#: of the kind ``boundaries``: Q* of eq. 24, Δ_MAX of eq. 26, and the reach and the gap at the exact folds
LIMITS = ("least_stable_reach", "largest_gap")
