"""The cases of the repository, those with a sweep and those with a record."""

import re
from pathlib import Path

CASES = Path(__file__).parents[2] / "cases"
ALL = sorted(CASES.rglob("*.toml"))
RECORDS = [file for file in ALL if re.search(r"^\[record\]", file.read_text(encoding="utf-8"), re.MULTILINE)]
SWEPT = [file for file in ALL if file not in RECORDS]

#: meshes of the larger solids for tests in which the mesh decides nothing: 4 s of CPU time become 1 s
COARSE = {name: {"solid.along": 6, "solid.across": 2, "solid.through": 1} for name in ("hammer", "stuttgart_left")}
