"""Keys of ``[stop]`` that several contact laws share: a law's field refers to its key here."""

from __future__ import annotations

from vibeam_models.keys import Key

RESTITUTION = Key(
    "speed after over speed before an impact",
    0.72,
    least=0,
    most=1,
    plain=("speed after over speed before an impact", 0.9, ""),
)

HERTZ_STIFFNESS = Key(
    "of laws hertz and hunt-crossley: force over penetration^exponent, in N/m^exponent",
    1e9,
    above=0,
    written=False,
    missing="N/m^exponent",
    plain=(
        "of hertz and hunt-crossley, force over mass and penetration^exponent",
        1e4,
        "force over mass and penetration^exponent",
    ),
)

EXPONENT = Key(
    "of the penetration, absent = 1.5; in velocity restitution the n of R = R0 (v/v0)^-n, absent = 0.25",
    1.5,
    above=0,
    written=False,
    plain=("of the penetration, absent = 1.5; of the velocity in R = R0 (v/v0)^-n, absent = 0.25", 1.5, ""),
)

VELOCITY = Key(
    "of impact, v0, at which the restitution holds; for laws hunt-crossley and velocity restitution",
    "0.1 m/s",
    "m/s",
    above=0,
    written=False,
    missing="at which the restitution holds",
    plain=(
        "at which the restitution holds, for hunt-crossley and velocity restitution",
        0.01,
        "at which the restitution holds",
    ),
)
