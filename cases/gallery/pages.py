"""Pages of the gallery: every script run, its question, answer, picture, printed numbers and code; the notebooks.

    python cases/gallery/pages.py OUT

writes one page for each into the folder OUT, with its pictures beside it. Links on a page are those of its script: they
hold where the page lies in the script's place.
"""

from __future__ import annotations

import argparse
import ast
import base64
import contextlib
import io
import json
import os
import re
import runpy
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parent
SCRIPTS = sorted(path for path in HERE.glob("*.py") if path.name != Path(__file__).name)
NOTEBOOKS = sorted(HERE.glob("*.ipynb"))
UNITS = ("Hz", "mm/s", "m/s²", "m/s", "µm", "mm", "ms", "s", "N/mm", "N", "kg", "g", "m", "%")
COUNTED = ("mode", "impact", "step", "period", "digit", "root", "record")  # singular or plural
NUMBER = re.compile(
    r"(?<![\w.^/#])([-−]?\d+(?: \d{3})*(?:\.\d+)?(?:e[-+−]?\d+)?)(?![\w/]|\.\d)"
    + rf"(?:\s+(?:({'|'.join(map(re.escape, UNITS))})|({'|'.join(COUNTED)})s?)(?![\w/²]))?"
)
NO_CLAIM = re.compile(r"`[^`]*`|\[[^\]]*\]\([^)]*\)", re.DOTALL)  # code, links


@dataclass(frozen=True)
class Claim:
    """Number of a text: its value, half a unit of its last digit, and its unit, or what it counts."""

    text: str
    value: float
    half: float
    unit: str

    def holds(self, printed: Claim) -> bool:
        """Test whether a printed number, rounded, is this one; of text, signs are left out ("too small")."""
        near = abs(abs(printed.value) - abs(self.value)) <= self.half * (1 + 1e-9)
        return near and printed.unit == self.unit


@dataclass(frozen=True)
class Script:
    """Script of the gallery: its question, its answer as Markdown, and its code without them."""

    path: Path
    question: str
    answer: str
    code: str

    @property
    def picture(self) -> str:
        """File name of its picture."""
        return f"{self.path.stem}.png"


def script_of(path: Path) -> Script:
    """Script read from its file; its docstring is the question and, below, the answer."""
    text = path.read_text(encoding="utf-8")
    tree = ast.parse(text)
    question, _, answer = (ast.get_docstring(tree) or "").partition("\n\n")
    code = "\n".join(text.splitlines()[tree.body[0].end_lineno :]).strip()
    return Script(path, question, answer, code)


def claims(text: str) -> list[Claim]:
    """Numbers that a text claims, without those in code and in links."""
    return [_claim(*match.groups()) for match in NUMBER.finditer(NO_CLAIM.sub(" ", text))]


def printed_claims(printed: str) -> list[Claim]:
    """Numbers that a script printed, of each line what follows its label."""
    return [claim for line in printed.splitlines() for claim in claims(line.partition(": ")[2])]


def _claim(text: str, unit: str | None, counted: str | None) -> Claim:
    plain = text.replace("−", "-").replace(" ", "")
    mantissa, _, power = plain.partition("e")
    half = 0.5 * 10.0 ** (int(power or 0) - len(mantissa.partition(".")[2]))
    return Claim(text, float(plain), half, unit or counted or "")


def unfounded(script: Script, printed: str) -> list[str]:
    """Numbers of a script's answer that it does not print."""
    known = printed_claims(printed)
    return [f"{each.text} {each.unit}".strip() for each in claims(script.answer) if not any(map(each.holds, known))]


def run(path: Path, folder: Path) -> str:
    """Output of a script run in ``folder``, into which it draws."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    printed, before = io.StringIO(), Path.cwd()
    os.chdir(folder)
    try:
        with contextlib.redirect_stdout(printed), pyplot.rc_context():
            runpy.run_path(str(path), run_name="__main__")
    finally:
        os.chdir(before)
        pyplot.close("all")
    return printed.getvalue()


def page(script: Script, printed: str) -> str:
    """Page of a script as Markdown."""
    return (
        f"# {script.question}\n\n{script.answer}\n\n![{script.question}]({script.picture})\n\n"
        f"## What it prints\n\n```text\n{printed}```\n\n## The script\n\n"
        f"`python cases/gallery/{script.path.name}` in a checkout of the repository:\n\n```python\n{script.code}\n```\n"
    )


def notebook_page(path: Path, folder: Path) -> str:
    """Page of an executed notebook as Markdown, its pictures written into ``folder``."""
    parts: list[str] = []
    for number, cell in enumerate(json.loads(path.read_text(encoding="utf-8"))["cells"]):
        source = "".join(cell["source"])
        parts.append(source if cell["cell_type"] == "markdown" else f"```python\n{source}\n```")
        for output in cell.get("outputs", []):
            parts.append(_output(output, folder / f"{path.stem}_{number}.png"))
    return "\n\n".join(part for part in parts if part) + "\n"


def _output(output: dict[str, Any], picture: Path) -> str:
    data = output.get("data", {})
    if "image/png" in data:
        picture.write_bytes(base64.b64decode("".join(data["image/png"])))
        return f"![]({picture.name})"
    text = "".join(output.get("text", data.get("text/plain", "")))
    return f"```text\n{text.rstrip()}\n```" if text else ""


def main(arguments: list[str] | None = None) -> int:
    """Write all pages; 1 where an answer has numbers that its script does not print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=Path, help="folder of the pages, made where there is none")
    out: Path = parser.parse_args(arguments).out.resolve()
    out.mkdir(parents=True, exist_ok=True)
    faults: list[str] = []
    for script in map(script_of, SCRIPTS):
        printed = run(script.path, out)
        (out / f"{script.path.stem}.md").write_text(page(script, printed), encoding="utf-8")
        faults += [f"{script.path.name}: {each} is not printed" for each in unfounded(script, printed)]
    for path in NOTEBOOKS:
        (out / f"{path.stem}.md").write_text(notebook_page(path, out), encoding="utf-8")
    print(*faults, sep="\n", end="\n" if faults else "", file=sys.stderr)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
