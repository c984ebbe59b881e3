"""The gallery: each number of an answer is one that its script prints, its picture is drawn, its page has all of it."""

from __future__ import annotations

import ast
import base64
import contextlib
import io
import json
import re
import struct
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import matplotlib
import pytest
from matplotlib import pyplot

ROOT = Path(__file__).parents[2]
GALLERY = ROOT / "cases" / "gallery"
NAMES = sorted(path.stem for path in GALLERY.glob("*.py") if path.stem != "pages")
LONGEST = 80  # lines of a script's code
NOTEBOOKS = sorted(path.stem for path in GALLERY.glob("*.ipynb"))
LARGEST = 300_000  # bytes of a notebook, pictures included


@pytest.fixture(scope="module")
def pages() -> Iterator[ModuleType]:
    sys.path.insert(0, str(GALLERY))
    import pages as module  # type: ignore[import-not-found]

    yield module
    sys.path.remove(str(GALLERY))
    del sys.modules["pages"]


NEAR = 1e-11  # share of a number by which another processor may have it


class Edges(ast.NodeTransformer):
    """Each number that a script formats is noted where one ``NEAR`` it has another text, as 141.5 by ``.0f``."""

    def __init__(self) -> None:
        self.found: list[str] = []

    def visit_FormattedValue(self, node: ast.FormattedValue) -> ast.AST:
        """``noted(value, spec)`` in place of a value with a fixed format."""
        self.generic_visit(node)
        if isinstance(node.format_spec, ast.JoinedStr) and len(node.format_spec.values) == 1:
            call = ast.Call(ast.Name("noted", ast.Load()), [node.value, node.format_spec.values[0]], [])
            return ast.copy_location(ast.FormattedValue(call, -1, node.format_spec), node)
        return node

    def noted(self, value: Any, spec: str) -> Any:
        """The same value, noted where it stands on an edge."""
        if isinstance(value, float) and len({format(value * (1 + each * NEAR), spec) for each in (-1, 0, 1)}) > 1:
            self.found.append(f"{value!r} as {spec}")
        return value

    def run(self, file: Path, folder: Path, monkeypatch: pytest.MonkeyPatch) -> str:
        """What a script prints, run in ``folder`` with its numbers noted."""
        tree = ast.fix_missing_locations(self.visit(ast.parse(file.read_text(encoding="utf-8"))))
        monkeypatch.chdir(folder)
        matplotlib.use("Agg")
        with contextlib.redirect_stdout(io.StringIO()) as printed, pyplot.rc_context():
            exec(compile(tree, str(file), "exec"), {"__file__": str(file), "__name__": "__main__", "noted": self.noted})
        pyplot.close("all")
        return printed.getvalue()


@pytest.mark.parametrize("name", NAMES)
def test_an_answer_holds_what_its_script_prints(
    pages: ModuleType, name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    script, edges = pages.script_of(GALLERY / f"{name}.py"), Edges()
    printed = edges.run(script.path, tmp_path, monkeypatch)
    assert edges.found == []
    assert pages.unfounded(script, printed) == []
    assert undetected(pages, script.answer, printed) == []
    width, height = size_of(tmp_path / script.picture)
    assert width >= 900
    assert height >= 500
    assert [path.name for path in tmp_path.iterdir()] == [script.picture]
    made = pages.page(script, printed)
    assert all(part in made for part in (script.question, script.answer, printed, script.code, script.picture))


def test_a_number_on_a_rounding_edge_is_seen(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    place, edges = tmp_path / "one.py", Edges()
    place.write_text(
        'x = 141.5\nprint(f"{x:.0f} Hz, {x - 1e-10:.0f} Hz, {x:.1f} Hz, {141.0:.0f} Hz, {x!r}, {14:.0f}")\n'
    )
    assert edges.run(place, tmp_path, monkeypatch) == "142 Hz, 141 Hz, 141.5 Hz, 141 Hz, 141.5, 14\n"
    assert edges.found == ["141.5 as .0f", "141.4999999999 as .0f"]


def undetected(pages: ModuleType, answer: str, printed: str) -> list[str]:
    """Numbers of an answer that could be larger by one in the last digit, and nothing would be said."""
    known = pages.printed_claims(printed)
    claims = pages.claims(answer)
    assert len(claims) >= 4
    moved = [pages.Claim(each.text, each.value + 2 * each.half, each.half, each.unit) for each in claims]
    return [each.text for each in moved if any(map(each.holds, known)) and not any(map(each.holds, claims))]


def size_of(picture: Path) -> tuple[int, int]:
    """Width and height of a PNG."""
    return struct.unpack(">II", picture.read_bytes()[16:24])  # type: ignore[return-value]


@pytest.mark.parametrize("name", NAMES)
def test_a_script_is_a_question_an_answer_and_few_lines(pages: ModuleType, name: str) -> None:
    script = pages.script_of(GALLERY / f"{name}.py")
    assert script.question.endswith("?")
    assert len(script.answer.split()) >= 60
    assert len(script.code.splitlines()) <= LONGEST
    assert f'savefig("{script.picture}"' in script.code


def test_the_page_of_the_gallery_lists_all(pages: ModuleType) -> None:
    listed = dict(re.findall(r"\[([^\]]+)\]\((\w+\.(?:py|ipynb))\)", (GALLERY / "README.md").read_text("utf-8")))
    found = {pages.script_of(GALLERY / f"{name}.py").question: f"{name}.py" for name in NAMES}
    assert {title: file for title, file in listed.items() if file.endswith(".py") and file != "pages.py"} == found
    assert {file for file in listed.values() if file.endswith(".ipynb")} == {path.name for path in pages.NOTEBOOKS}


def test_numbers_are_read_with_their_units(pages: ModuleType) -> None:
    text = "By 1 000 N/mm −0.5 % (§ 3), 1.2e-3 s, 8 modes, 4 ms; `5 mm`, [x#7](y8), fig13, 2² and 3 wide."
    read = [(each.value, each.unit) for each in pages.claims(text)]
    assert read == [(1000, "N/mm"), (-0.5, "%"), (3, ""), (1.2e-3, "s"), (8, "mode"), (4, "ms"), (3, "")]
    assert [each.value for each in pages.printed_claims("label 5: 7 Hz\nno label 8\n")] == [7]


def test_a_wrong_number_or_unit_is_seen(pages: ModuleType, tmp_path: Path) -> None:
    place = tmp_path / "one.py"
    place.write_text('"""Why?\n\nIt has 12.3 mm and 4 modes.\n"""\nprint("a: 12.34 mm, 4 modes")\n')
    script = pages.script_of(place)
    assert pages.unfounded(script, pages.run(place, tmp_path)) == []
    for printed in ("a: 12.36 mm, 4 modes", "a: 12.34 Hz, 4 modes", "a: 12.34 mm, 5 modes", "12.34 mm, 4 modes"):
        assert len(pages.unfounded(script, f"{printed}\n")) >= 1


def cells_of(name: str) -> list[dict[str, Any]]:
    """Cells of a notebook that hold code."""
    found = json.loads((GALLERY / f"{name}.ipynb").read_text(encoding="utf-8"))["cells"]
    return [cell for cell in found if cell["cell_type"] == "code"]


def outputs_of(cell: dict[str, Any]) -> tuple[str, list[bytes]]:
    """What is stored of a cell that was executed: printed text, and pictures."""
    text = "".join("".join(each["text"]) for each in cell["outputs"] if each["output_type"] == "stream")
    shown = [each["data"] for each in cell["outputs"] if each["output_type"] == "display_data"]
    assert len(cell["outputs"]) == len(shown) + bool(text)  # no warning, no error, no other kind of output
    assert all(each["name"] == "stdout" for each in cell["outputs"] if each["output_type"] == "stream")
    return text, [base64.b64decode("".join(each["image/png"])) for each in shown]


def executed(cells: list[dict[str, Any]], monkeypatch: pytest.MonkeyPatch) -> list[tuple[str, int]]:
    """What cells print, and how many pictures each shows, executed one after the other."""
    matplotlib.use("Agg")
    found, known = [], dict[str, Any]()
    shown: list[int] = []
    monkeypatch.setattr(pyplot, "show", lambda: shown.extend(pyplot.get_fignums()) or pyplot.close("all"))
    with pyplot.rc_context():
        for cell in cells:
            shown.clear()
            with contextlib.redirect_stdout(io.StringIO()) as printed:
                exec(compile("".join(cell["source"]), "cell", "exec"), known)
            found.append((printed.getvalue(), len(shown)))
    return found


@pytest.mark.parametrize("name", NOTEBOOKS)
def test_a_notebook_holds_what_its_cells_print_and_show(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    cells = cells_of(name)
    assert [cell["execution_count"] for cell in cells] == list(range(1, len(cells) + 1))
    stored = [outputs_of(cell) for cell in cells]
    assert executed(cells, monkeypatch) == [(text, len(pictures)) for text, pictures in stored]
    assert sum(bool(text) for text, _ in stored) >= 4
    assert all(picture.startswith(b"\x89PNG") for _, pictures in stored for picture in pictures)
    assert sum(len(pictures) for _, pictures in stored) >= 1
    assert (GALLERY / f"{name}.ipynb").stat().st_size < LARGEST


@pytest.mark.parametrize("name", NOTEBOOKS)
def test_the_page_of_a_notebook_has_its_words_outputs_and_pictures(
    pages: ModuleType, name: str, tmp_path: Path
) -> None:
    page = pages.notebook_page(GALLERY / f"{name}.ipynb", tmp_path)
    assert page.startswith("# ")
    for text, _ in map(outputs_of, cells_of(name)):
        assert text.rstrip() in page
    linked = re.findall(r"!\[\]\(([^)]+)\)", page)
    assert sorted(linked) == sorted(path.name for path in tmp_path.iterdir()) != []


def test_a_stale_output_of_a_notebook_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    cell = {"source": ["import matplotlib.pyplot as plt\n", "print(1 + 1)"], "outputs": []}
    assert executed([cell], monkeypatch) == [("2\n", 0)]
    drawn = cell | {"source": ["import matplotlib.pyplot as plt\n", "plt.subplots()\n", "plt.show()"]}
    assert executed([drawn], monkeypatch) == [("", 1)]
