"""Make ``solid_rigs.json``: rigs as solids by tetrahedra of two sizes; a minute and a half.

Frequencies come from above, those of smooth modes with h⁴; corners of a clamp and of steps leave h^1.1 … h^1.4
(Williams, J. appl. Mech. 19 (1952) 526), so that the limit is no further below than ``limit`` says.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
from solid_rigs import Part, Rig, answer

STEEL, ALUMINIUM = (210e9, 0.3, 7850.0), (70e9, 0.33, 2700.0)
LENGTH, WIDTH, HEIGHT = 0.12, 0.024, 0.008
ACROSS = (-WIDTH / 2, WIDTH / 2)
PATCH = ((0.096, 0.104), ACROSS)
INNER = ((0.096, 0.104), (-0.006, 0.006))


def strip(start=0.0, end=LENGTH, height=HEIGHT, material=STEEL):
    """A stretch of the strip."""
    return Part((start, end), ACROSS, (-height / 2, height / 2), material)


def layer(start, end, width, low, high, material):
    """A plate or half a block on the strip."""
    return Part((start, end), (-width / 2, width / 2), (low, high), material)


def tapered(nodes):
    """The strip's height falls linearly from 0.008 at x = 0.04 to 0.004 at its tip."""
    share = np.clip((nodes[:, 0] - 0.04) / 0.08, 0, 1)
    return nodes * np.column_stack([np.ones_like(share), np.ones_like(share), 1 - share / 2])


BLOCK = ALUMINIUM[0], ALUMINIUM[1], 0.1 / (0.02 * 0.03 * 0.01)
TOP = HEIGHT / 2
RIGS = {
    "bare": Rig((strip(),), (0.0,), INNER, TOP),
    "both ends": Rig((strip(),), (0.0, LENGTH), ((0.056, 0.064), ACROSS), TOP),
    "zone": Rig((strip(),), (0.0,), PATCH, TOP, (0.07, 0.09, 0.08, 0.2, (2e-5, 3e-5, 3e-5))),
    "step": Rig((strip(0, 0.04), strip(0.04, 0.08, 0.012), strip(0.08)), (0.0,), PATCH, TOP),
    "plate": Rig((strip(), layer(0.04, 0.08, WIDTH, TOP, TOP + 0.004, ALUMINIUM)), (0.0,), PATCH, TOP),
    "narrow plates": Rig(
        (strip(), *(layer(0.04, 0.08, 0.012, *z, STEEL) for z in ((TOP, 0.006), (-0.006, -TOP)))), (0.0,), PATCH, TOP
    ),
    "block": Rig(
        (strip(), *(layer(0.07, 0.09, 0.03, *z, BLOCK) for z in ((TOP, 0.014), (-0.014, -TOP)))), (0.0,), PATCH, TOP
    ),
    "taper": Rig((strip(),), (0.0,), PATCH, TOP, bend=tapered),
}
SIZES = (0.006, 0.006, 0.004), (0.004, 0.004, 0.0027)
SLOWEST = 1.1


def numbers(rig):
    """What is stored of one rig: of the finer size all, of the coarser its frequencies, and the lowest limit."""
    coarse, fine = (answer(rig, sizes) for sizes in SIZES)
    found = {name: np.asarray(value).tolist() for name, value in vars(fine).items()}
    ratio = (SIZES[0][0] / SIZES[1][0]) ** SLOWEST
    limit = fine.frequencies + (fine.frequencies - coarse.frequencies) / (ratio - 1)
    return {**found, "coarse": coarse.frequencies.tolist(), "limit": limit.tolist()}


if __name__ == "__main__":
    made = {name: numbers(rig) for name, rig in RIGS.items()}
    (Path(__file__).parent / "solid_rigs.json").write_text(json.dumps(made, indent=1) + "\n", encoding="utf-8")
    print({name: np.array(each["frequencies"]) / each["coarse"] - 1 for name, each in made.items()})
