"""Figures of a case beside its frequency-response curves: each kind of [show.NAME] table is one entry and one module.

No kind is loaded for a case without such tables.
"""

from __future__ import annotations

from typing import Any

from vibeam.figures.declaration import FigureKind
from vibeam_models.keys import Key
from vibeam_models.registry import Registry

FREQUENCY = ("frequency",)
MOTION = ("periods", "settle", "output")
OVER = ("frequency", *MOTION)
SHARES = dict.fromkeys(("energy_share", "displacement_share", "velocity_share", "impulse_share"), "1")
RINGING = {
    "ringing_frequency": "Hz",
    "counted_frequency": "Hz",
    "counted_scatter": "Hz",
    "ringing_decay": "1/s",
    "ringing_displacement": "q",
    "ringing_velocity": "q/s",
    "counted_velocity": "q/s",
}
SHOCKED = {"acceleration": "m s-2", "pseudo_velocity": "m s-1", "displacement": "m"}
SHOCK = {f"{whose}_{what}": unit for whose in ("shock", "base", "free") for what, unit in SHOCKED.items()}
RESTITUTIONS = tuple(f"{how}_restitution" for how in ("true", "adjacent", "extremum", "extrapolated", "first_mode"))


def _own(name: str, *declared: Any, **more: Any) -> FigureKind:
    """Kind whose module in ``kinds`` has its name."""
    return FigureKind(name, f"vibeam.figures.kinds.{name}", *declared, **more)


FIGURES = Registry(
    "kind of figure",
    _own(
        "history",
        "displacement and velocity over time; of a record its input, impacts and contact force too",
        FREQUENCY,
        MOTION,
        {"jump": "q/s"},
        derivatives=True,
        record=True,
        record_keys=("output", "window"),
        keys={
            "window": Key(
                "of history, of a record: begin and end of the part that is shown beside the whole; absent = around "
                "the largest value",
                ["0.20 s", "0.35 s"],
                "s",
                least=0,
                several=True,
                ascending=True,
            )
        },
    ),
    _own(
        "impact_velocities",
        "how many impacts a second are harder than a velocity, of all fidelities",
        record=True,
        sweep=False,
    ),
    _own(
        "spectrogram",
        "density of the output over time and frequency, under the first realisation",
        takes=("output",),
        exact=True,
        derivatives=True,
        record=True,
        sweep=False,
    ),
    _own("portrait", "velocity over displacement", FREQUENCY, MOTION, derivatives=True),
    _own("section", "one point a drive period", FREQUENCY, MOTION),
    _own("curve", "another quantity over frequency", ("quantity",)),
    _own(
        "harmonics",
        "amplitudes at multiples of the drive frequency, bars at a few, lines over many",
        takes=OVER,
        reads={"harmonic": "q"},
        entries="order",
        exact=True,
        derivatives=True,
        keys={
            "highest": Key("of harmonics: the last order; absent = 8", 8, least=1, most=100, whole=True),
            "subdivision": Key(
                "of harmonics: 2 shows orders ½, 1, 1½ …; absent = 1, whole orders",
                2,
                least=1,
                most=64,
                whole=True,
            ),
        },
    ),
    _own("spectrum", "amplitude spectra of displacement and velocity", FREQUENCY, MOTION, exact=True),
    _own(
        "participation",
        "shares of the modes in energy, displacement, velocity and impulse",
        FREQUENCY,
        MOTION,
        SHARES,
        "mode",
        exact=True,
        one_harmonic=True,
    ),
    _own(
        "ringing",
        "frequency, by fit and by counted peaks, and size of what rings between impacts",
        ("near",),
        OVER,
        RINGING,
        exact=True,
        one_harmonic=True,
    ),
    _own(
        "restitution",
        "the contact's restitution beside what is read off in other ways",
        takes=OVER,
        reads=dict.fromkeys(RESTITUTIONS, "1"),
        exact=True,
        one_harmonic=True,
    ),
    _own(
        "decay",
        "free decay without drive and stop, its envelope and its spectrum",
        ("start",),
        ("periods", "output"),
        {"decay_frequency": "Hz", "decay_damping": "1", "spectrum_frequency": "Hz"},
        keys={
            "start": Key(
                "of decay: how far the output is drawn aside, by a force at the contact, and let go",
                "2 mm",
                "m",
                above=0,
            )
        },
    ),
    _own(
        "impact",
        "one collision at given velocities: restitution and contact time as results",
        ("velocity",),
        reads={
            "first_mode_restitution": "1",
            "true_restitution": "1",
            "energy_restitution": "1",
            "mode_share": "1",
            "contact_time": "s",
            "contact_periods": "1",
        },
        entries="velocity",
        exact=True,
        keys={
            "velocity": Key(
                "of impact: the contact's at first touch",
                ["20 mm/s", "50 mm/s"],
                "m/s",
                above=0,
                several=True,
                alone=True,
                ascending=True,
            )
        },
    ),
    _own(
        "chirp",
        "a swept-sine test, the drive frequency changing at a rate, beside the sweep's settled points",
        ("rate",),
        MOTION,
        {"swept_peak": "q", "swept_peak_frequency": "Hz"},
        transient=True,
        derivatives=True,
        one_harmonic=True,
        keys={
            "rate": Key("of chirp: by how much the drive frequency changes a second", "0.1 Hz/s", "Hz/s", above=0),
            "direction": Key(
                "of chirp: which way, absent = both, up and then down; of vtu: on which branch of the sweep, "
                "absent = that reached from rest",
                "up",
                words=("up", "down", "both"),
            ),
        },
    ),
    _own(
        "vtu",
        "the whole beam and its stops in motion: a series of VTU files for ParaView, in place of a picture",
        FREQUENCY,
        ("direction", "periods", "settle"),
        derivatives=True,
        ending="pvd",
        of_beam=True,
        keys={
            "frames": Key(
                "of vtu: steps a drive period; absent = 36, fewer of a long period",
                36,
                least=4,
                most=1000,
                whole=True,
            ),
        },
    ),
    _own(
        "shock_spectrum",
        "largest responses of equipment at the output, or of the device with and without stop, over natural frequency",
        takes=("output",),
        reads=SHOCK | {"shock_impacts": "1", "shock_impact_velocity": "c/s"},
        entries="natural",
        exact=True,
        derivatives=True,
        record=True,
        sweep=False,
        keys={
            "response_of": Key(
                "of shock_spectrum: equipment, oscillators mounted at the output (absent); or device, the case's own "
                "structure with its natural frequencies multiplied, with its stop and without",
                "device",
                words=("equipment", "device"),
            ),
            "measure": Key(
                "of shock_spectrum: what is drawn; absent = acceleration of equipment, displacement of a device",
                "pseudo_velocity",
                words=("acceleration", "pseudo_velocity", "displacement"),
            ),
            "natural": Key(
                "of shock_spectrum: natural frequencies, of a device the lowest one; absent = 30 a decade, a tenth "
                "of the fidelity's lowest to 100 times it, of a device 10 times",
                ["50 Hz", "100 Hz"],
                "Hz",
                above=0,
                several=True,
                alone=True,
                ascending=True,
            ),
            "equipment_damping": Key(
                "of shock_spectrum: damping ratio of the equipment; absent = 0.05", 0.05, least=0, most=0.99
            ),
        },
    ),
    _own(
        "response_spectrum",
        "power spectral densities under noise with intervals, their ratio to the last fidelity's, coherence",
        takes=("output",),
        reads={"density_ratio": "1", "coherence": "1"},
        entries="frequency",
        exact=True,
        derivatives=True,
        record=True,
        sweep=False,
        keys={
            "up_to": Key(
                "of response_spectrum: highest frequency; absent = ten times the lowest natural one",
                "500 Hz",
                "Hz",
                above=0,
            ),
            "resolution": Key(
                "of response_spectrum: spacing of the lines; absent = eight segments a realisation",
                "1 Hz",
                "Hz",
                above=0,
            ),
        },
    ),
    _own(
        "modal",
        "frequencies and damping ratios of the modes",
        reads={"mode_frequency": "Hz", "mode_damping": "1"},
        entries="mode",
    ),
    _own(
        "shapes",
        "mode shapes of each fidelity to one scale, a solid shaded, a beam as its line",
        derivatives=True,
        record=True,
        refuses=True,
    ),
)

COMMON = ("frequency", "periods", "settle", "quantity", "output", "near")  # keys that no kind alone declares


def units_read() -> dict[str, str]:
    """Units of what [expect.NAME] and [measured.NAME] can read off figures, by name."""
    return {name: unit for kind in FIGURES.values() for name, unit in kind.reads.items()}


def kinds_alone() -> dict[str, str]:
    """Kind off which a quantity is read without a [show.NAME]: one that needs and takes no key."""
    return {name: kind.name for kind in FIGURES.values() if not kind.known for name in kind.reads}


def quantities_shown() -> dict[str, str]:
    """Units of quantities over frequency that kinds of figure compute themselves, by name."""
    return {name: unit for kind in FIGURES.values() for name, unit in kind.quantities.items()}


def own_keys() -> dict[str, Key]:
    """The keys of [show.NAME] that kinds of figure declare, by name."""
    return {name: key for kind in FIGURES.values() for name, key in kind.keys.items()}


#: of a response and its model: the reach Q = Δ − min of the sweep's output, as the paper gives it of the sensor
OF_OUTPUT = ("output_reach",)


def register_figure(kind: FigureKind) -> None:
    """Register a further kind of figure for case files; ValueError where the name is taken.

    >>> import vibeam
    >>> vibeam.register_figure(vibeam.FigureKind("mine", "mine.figure", "what it shows", takes=("frequency",)))
    >>> case = vibeam.load("cases/dtu_neutral.toml", {"show.a.kind": "mine", "show.a.frequency": "15 Hz"})
    >>> case.shows["a"].kind
    'mine'
    """
    FIGURES.add(kind)
