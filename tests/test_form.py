"""Form of the product: sizes of files, shares of imports, names that stand for one thing each."""

from __future__ import annotations

import ast
import re
from collections import Counter
from doctest import DocTestParser
from pathlib import Path
from statistics import median

ROOT = Path(__file__).parents[1]
FILES = sorted(
    file for package in ("vibeam", "models", "reductions") for file in (ROOT / package).rglob("*.py")
    if "__pycache__" not in file.parts
)  # fmt: skip
CHAPTERS = [file for file in FILES if file.name not in ("__init__.py", "__main__.py")]
MOST_LINES, MOST_FILES = 95_990, 690  # only ever made smaller: 61 000 and 450 are the aim
LONGEST, SHORTEST_MEDIAN, IMPORTS = 350, 120, 0.089
EXAMPLES = DocTestParser()
QUESTION = re.compile(r"(What|Whether|Where|How|Which|When)\b")


def length(file: Path) -> int:
    """Lines of a file without those of the examples in its docstrings, which are tests."""
    text = file.read_text(encoding="utf-8")
    examples = [each for told in docstrings(text) for each in EXAMPLES.get_examples(told)] if ">>>" in text else []
    return len(text.splitlines()) - sum(f"{each.source}{each.want}".count("\n") for each in examples)


def imports(text: str) -> int:
    """Lines of import statements."""
    found = [node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Import | ast.ImportFrom)]
    return sum((node.end_lineno or node.lineno) - node.lineno + 1 for node in found)


def classes(files: list[Path]) -> Counter[str]:
    """Number of classes of each name."""
    trees = (ast.parse(file.read_text(encoding="utf-8")) for file in files)
    return Counter(node.name for tree in trees for node in ast.walk(tree) if isinstance(node, ast.ClassDef))


def docstrings(text: str) -> list[str]:
    """Docstrings of a module, its classes and functions."""
    kinds = ast.Module | ast.ClassDef | ast.FunctionDef
    nodes = [node for node in ast.walk(ast.parse(text)) if isinstance(node, kinds)]
    return list(filter(None, map(ast.get_docstring, nodes)))


def questions(file: Path) -> list[str]:
    """Docstrings that open with a question word in place of a noun."""
    return [told for told in docstrings(file.read_text(encoding="utf-8")) if QUESTION.match(told)]


def test_the_product_stays_within_its_budget() -> None:
    lengths = {file: length(file) for file in FILES}
    assert sum(lengths.values()) <= MOST_LINES
    assert len(FILES) <= MOST_FILES
    assert {str(file): lines for file, lines in lengths.items() if lines > LONGEST} == {}
    assert median(lengths[file] for file in CHAPTERS) >= SHORTEST_MEDIAN


def test_imports_are_a_small_share_of_the_lines() -> None:
    total = sum(map(length, FILES))
    assert sum(imports(file.read_text(encoding="utf-8")) for file in FILES) <= IMPORTS * total


def test_no_class_name_stands_for_two_things() -> None:
    assert {name: number for name, number in classes(FILES).items() if number > 1} == {}


def test_docstrings_open_with_a_noun() -> None:
    assert {str(file): found for file in FILES if (found := questions(file))} == {}


def test_the_checks_see_what_they_forbid(tmp_path: Path) -> None:
    one = tmp_path / "one.py"
    one.write_text('"""A\n\n>>> 1\n1\n"""\n')
    assert length(one) == 3
    one.write_text(
        '"""Whether it counts."""\nimport ast, re\nfrom a import (\n    b,\n)\n\n\nclass A: ...\n\n\nclass A: ...\n'
    )
    assert (imports(one.read_text()), classes([one])["A"], questions(one)) == (4, 2, ["Whether it counts."])
