"""Form of the product: sizes of packages and files, names that stand for one thing each."""

from __future__ import annotations

import ast
import re
import subprocess
from collections import Counter
from doctest import DocTestParser
from itertools import chain
from pathlib import Path
from statistics import median

ROOT = Path(__file__).parents[1]
FILES = sorted(
    file for package in ("vibeam", "models", "reductions") for file in (ROOT / package).rglob("*.py")
    if "__pycache__" not in file.parts
)  # fmt: skip
SCRIPTS = sorted((ROOT / "vibeam").rglob("*.js"))
CHAPTERS = [file for file in FILES if file.name not in ("__init__.py", "__main__.py")]
# Lines of each package: a number may only fall (``test_no_bound_was_ever_raised``). What a capability costs is found
# again in the same package: what it makes unnecessary goes with it.
BOUNDS = {
    "javascript": 6654, "models": 6883, "reductions": 406, "vibeam": 64, "vibeam/batches": 685,
    "vibeam/case": 1925, "vibeam/casefile": 7607, "vibeam/cli": 2160, "vibeam/exchange": 4643,
    "vibeam/extensions": 1, "vibeam/extensions/dictionary": 541, "vibeam/extensions/explore": 1212,
    "vibeam/extensions/identification": 1652, "vibeam/extensions/paper": 1459, "vibeam/extensions/solid": 5055,
    "vibeam/figures": 4454, "vibeam/flight": 19718, "vibeam/maps": 2500, "vibeam/observe": 2125,
    "vibeam/periodic": 4698, "vibeam/report": 6748, "vibeam/runs": 6023, "vibeam/solvers": 1824,
    "vibeam/store": 1240, "vibeam/studies": 8785, "vibeam/system": 2497,
}  # fmt: skip
NAMED = {"vibeam/exchange": 4662}  # package: a higher bound that the plan names for a capability
SHORTEST_MEDIAN = 120
EXAMPLES = DocTestParser()
QUESTION = re.compile(r"(What|Whether|Where|How|Which|When)\b")


def length(file: Path) -> int:
    """Lines of a file without those of the examples in its docstrings, which are tests."""
    text = file.read_text(encoding="utf-8")
    examples = [each for told in docstrings(text) for each in EXAMPLES.get_examples(told)] if ">>>" in text else []
    return len(text.splitlines()) - sum(f"{each.source}{each.want}".count("\n") for each in examples)


def package_of(file: Path) -> str:
    """``vibeam/flight``, ``vibeam/extensions/explore``, ``models``, or ``vibeam`` for what lies loose in it."""
    parts = file.relative_to(ROOT).parts
    depth = 3 if parts[:2] == ("vibeam", "extensions") and len(parts) > 3 else 2
    return "/".join(parts[: depth if parts[0] == "vibeam" and len(parts) > 2 else 1])


def sizes() -> dict[str, int]:
    """Lines of each package; of JavaScript by itself."""
    found = Counter({"javascript": sum(len(file.read_text("utf-8").splitlines()) for file in SCRIPTS)})
    for file in FILES:
        found[package_of(file)] += length(file)
    return dict(found)


def bounds_of(text: str) -> dict[str, int]:
    """``BOUNDS`` as a version of this file states them."""
    named = {each.targets[0].id: each.value for each in ast.parse(text).body
             if isinstance(each, ast.Assign) and isinstance(each.targets[0], ast.Name)}  # fmt: skip
    return ast.literal_eval(named["BOUNDS"]) if "BOUNDS" in named else {}


def earlier_bounds() -> list[dict[str, int]]:
    """Bounds of all earlier versions of this file, the newest first; none where there is no history."""
    name = Path(__file__).relative_to(ROOT).as_posix()

    def git(*words: str) -> str:
        return subprocess.run(["git", *words], cwd=ROOT, capture_output=True, text=True, encoding="utf-8").stdout

    texts = (git("show", f"{commit}:{name}") for commit in git("log", "--format=%H", "-GBOUNDS", "--", name).split())
    return [found for text in texts if (found := bounds_of(text))]


def raised(now: dict[str, int], before: list[dict[str, int]]) -> dict[str, int]:
    """Packages whose bound is above one that they had, with it."""
    lowest = {name: min(each[name] for each in before if name in each) for name in {*chain(*before)}}
    return {name: low for name, low in lowest.items() if now.get(name, 0) > max(low, NAMED.get(name, 0))}


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


def test_each_package_stays_within_its_bound() -> None:
    found = sizes()
    assert found.keys() == BOUNDS.keys()
    assert {name: lines for name, lines in found.items() if lines > BOUNDS[name]} == {}
    assert median(length(file) for file in CHAPTERS) >= SHORTEST_MEDIAN


def test_no_bound_was_ever_raised() -> None:
    assert raised(BOUNDS, earlier_bounds()) == {}


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
    assert (classes([one])["A"], questions(one)) == (2, ["Whether it counts."])
    assert bounds_of("BOUNDS = {'a': 1}") == {"a": 1}
    assert raised({"a": 3, "b": 1}, [{"a": 3, "b": 2}, {"a": 2}]) == {"a": 2}
    assert package_of(ROOT / "vibeam" / "flight" / "solver.py") == "vibeam/flight"
    assert package_of(ROOT / "vibeam" / "extensions" / "a" / "b.py") == "vibeam/extensions/a"
