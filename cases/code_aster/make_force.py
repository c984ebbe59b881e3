"""Write sdnd102_force.csv: what the moving support of SDND102 does to its mass, k b + c b'.

    python cases/code_aster/make_force.py

Support b = −sin Ωt / Ω² (acceleration sin Ωt, 1 m/s², 10 Hz), with k, m and ζ of sdnd102a.comm; every 1 ms.
"""

import math
from pathlib import Path

MASS, STIFFNESS, DAMPING_RATIO, OMEGA = 25.0, 98696.0, 0.07, 2 * math.pi * 10
DAMPING = 2 * DAMPING_RATIO * math.sqrt(STIFFNESS * MASS)


def main() -> None:
    """The command."""
    lines = ["time [s],force [N]"]
    for k in range(1001):
        turn = OMEGA * k / 1000
        force = -STIFFNESS * math.sin(turn) / OMEGA**2 - DAMPING * math.cos(turn) / OMEGA
        lines.append(f"{k / 1000:.3f},{force:.12g}")
    Path(__file__).with_name("sdnd102_force.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
