"""Modules of pages: numbers come from node and go to the bit, texts of numbers, what the bundle can read."""

import math
import re
from base64 import b64encode
from pathlib import Path

import numpy as np
import pytest
from javascript import ScriptError

from vibeam.report.page import parts

PI = math.pi


def test_numbers_come_and_go_to_the_bit(node):
    given = {"x": [PI, 5e-324, 1.7976931348623157e308, -0.0, 2**53], "array": np.array([[1 / 3, 0.1]])}
    there, back = node("return [given.x, Float64Array.from(given.array[0])];", given)
    assert [each.hex() for each in map(float, there)] == [each.hex() for each in map(float, given["x"])]
    assert back == [1 / 3, 0.1]
    odd = node("return [NaN, -Infinity, -0, 2n ** 70n, undefined, { number: 2 }];")
    assert math.isnan(odd[0])
    assert math.copysign(1, odd[2]) == -1
    assert odd[1:] == [-math.inf, -0.0, 2**70, None, {"number": 2}]


def test_an_error_is_its_message_and_the_console_is_a_fault(node):
    with pytest.raises(ScriptError, match=r"^no such frequency$"):
        node("throw new Error('no such frequency');")
    with pytest.raises(ScriptError, match="SyntaxError"):
        node("return (;")
    with pytest.raises(ScriptError, match="heard"):
        node("console.log('heard'); return 1;")


def test_texts_of_numbers(node):
    script = """
        const { short, metres, percent, withUnit } = await load("report/page/numbers.js");
        return [short(given.pi), short(NaN), metres(2e-6), metres(-0.3), percent(0.1234), withUnit("Gap", "mm")];
    """
    assert node(script, {"pi": PI}) == ["3.142", "–", "2 µm", "-0.3 m", "12.3 %", "Gap (mm)"]


def test_packed_numbers(node):
    whole = np.array([0, 1, 65535], dtype="<u2")
    packed = {"data": b64encode(whole.tobytes()).decode(), "low": -1.0, "step": 0.5}
    script = 'return (await load("report/page/numbers.js")).unpacked(given);'
    assert node(script, packed) == (-1.0 + 0.5 * whole).tolist()


SCRIPTS = sorted(each for each in Path(parts.__file__).parents[2].rglob("*.js") if each.parent.name != "vendor")
LONGEST = 260


def test_modules_are_written_as_the_bundle_reads_them():
    """What is exported or imported in another form would be missing in the page alone."""
    assert len(SCRIPTS) > 40
    for file in SCRIPTS:
        text = file.read_text(encoding="utf-8")
        assert text.count("\n") <= LONGEST, file.name
        if file.name == "node.js":  # a program, not part of a page
            continue
        assert len(re.findall(r"^export\b", text, re.MULTILINE)) == len(parts.EXPORT.findall(text)), file.name
        assert len(re.findall(r"^import\b", text, re.MULTILINE)) == len(parts.IMPORT.findall(text)), file.name
        assert not re.search(r"^export (const|let) (\w+\s*,|[{\[])", text, re.MULTILINE), file.name
        named = [name.strip() for each in parts.IMPORT.findall(text) for name in each[0].strip("{} ").split(",")]
        assert all(re.fullmatch(r"\w+", name) for name in filter(None, named)), file.name  # no "as"
