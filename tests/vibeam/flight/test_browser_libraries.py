"""Libraries for web pages: what a page gets of them is whole, small, named as the kernels are, and never stale."""

from __future__ import annotations

import ast
import gzip
import json
import shutil
import subprocess
import sys
from base64 import b64decode
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest
from wasm_kernels import shared_memory

from vibeam.flight.ahead_of_time import webassembly
from vibeam.flight.engine.browser import FIRST, LAYOUTS, LIBRARIES, SLOT, browser_libraries, place_of, slots_table
from vibeam.flight.engine.entries import ENTRIES
from vibeam.flight.engine.loading import FOLDER, KernelsUnavailable, write_manifest

ROOT = Path(__file__).parents[3]
PLAIN, REGIMES = ("tables", "flight", "points"), ("tables", "regimes")
BASE64_MOST = 400_000  # bytes of what one page carries


@pytest.mark.parametrize("library", LIBRARIES)
def test_a_module_imports_memory_alone_and_exports_its_entry_points_alone(library: str) -> None:
    inside = shared_memory()
    exported = dict(inside.instance(library).exports(inside.store).items())
    assert set(exported) == {f"{library}_{name}" for name in LIBRARIES[library]}


@pytest.mark.parametrize("names", [PLAIN, REGIMES])
def test_a_page_carries_little(names: tuple[str, ...]) -> None:
    found = browser_libraries(names)
    assert tuple(found) == names
    assert sum(map(len, found.values())) <= BASE64_MOST


def test_the_page_of_flight_states_the_sizes() -> None:
    text = (ROOT / "vibeam/flight/README.md").read_text(encoding="utf-8")
    for names in (*((library,) for library in LIBRARIES), PLAIN, REGIMES):
        packed = [b64decode(each) for each in browser_libraries(names).values()]
        modules = sum(len(gzip.decompress(each)) for each in packed)
        sizes = [modules, sum(map(len, packed)), sum(map(len, browser_libraries(names).values()))]
        row = " | ".join(f"{size / 1000:.0f}" for size in sizes)
        assert f" | {row} |\n" in text, (names, row)


def test_places_in_the_shared_memory_do_not_overlap() -> None:
    places = [place_of(library) for library in LIBRARIES]
    assert places[0] >= SLOT  # what address 0 means in C is written to by none
    assert all(later - earlier >= SLOT for earlier, later in zip(places, [*places[1:], FIRST], strict=True))


def data_end(module: bytes) -> int:
    """The last byte that a module's data segments fill, by the binary format of WebAssembly."""
    at, end = 8, 0

    def number() -> int:
        nonlocal at
        value, shift = 0, 0
        while True:
            byte, at = module[at], at + 1
            value |= (byte & 127) << shift
            shift += 7
            if byte < 128:
                return value - (1 << shift) if signed and byte & 64 else value

    while at < len(module):
        signed, section = False, module[at]
        at += 1
        length = number()
        following = at + length
        if section == 11:
            for _ in range(number()):
                assert module[at : at + 2] == b"\x00\x41"  # active, i32.const
                at, signed = at + 2, True
                begin, signed = number(), False
                at += 1
                size = number()
                at, end = at + size, max(end, begin + size)
        at = following
    return end


@pytest.mark.parametrize("library", LIBRARIES)
def test_constants_leave_room_for_the_stack(library: str) -> None:
    module = gzip.decompress(b64decode(browser_libraries([library])[library]))
    begin, end = place_of(library), data_end(module)
    assert begin < end <= begin + SLOT // 2  # the stack takes the other half (``webassembly.linked_module``)


def parameters(module: str, name: str) -> list[str]:
    """Names of a kernel's arguments, as its file has them."""
    path = ROOT.joinpath(*module.split(".")).with_suffix(".py")
    tree = ast.parse(path.read_text(encoding="utf-8"))
    [found] = [each for each in tree.body if isinstance(each, ast.FunctionDef) and each.name == name]
    return [each.arg for each in found.args.args]


def tuples(arguments: list[Any]) -> dict[str, list[str]]:
    """The fields of every named tuple among arguments."""
    found: dict[str, list[str]] = {}
    for _, kind in arguments:
        if isinstance(kind, dict):
            found |= {kind["tuple"]: [name for name, _ in kind["fields"]]} | tuples(kind["fields"])
    return found


def test_the_table_of_slots_names_arguments_and_fields_as_the_kernels_do() -> None:
    entries = slots_table(LIBRARIES)["entries"]
    assert set(entries) == {f"{library}.{name}" for library, names in LIBRARIES.items() for name in names}
    for each in ENTRIES:
        if found := entries.get(f"{each.library}.{each.name}"):
            assert [name for name, _ in found["arguments"]] == parameters(each.module, each.name)
    classes = {name: value for module in LAYOUTS.values() for name, value in vars(import_module(module)).items()}
    seen = {name: fields for found in entries.values() for name, fields in tuples(found["arguments"]).items()}
    assert {"Engine", "Regime", "Watch", "RegimeEngine", "Task", "Lane"} <= set(seen)
    assert seen == {name: list(classes[name]._fields) for name in seen}


def test_the_table_of_slots_has_every_number_of_the_layouts() -> None:
    rows = slots_table([])["rows"]
    for name, module in LAYOUTS.items():
        found = vars(import_module(module))
        assert rows[name] == {key: found[key] for key in found if key.isupper()}
        assert all(type(value) in (int, float) for value in rows[name].values())
    assert json.loads(json.dumps(rows, allow_nan=False)) == rows


def test_neither_needs_numba() -> None:
    code = (
        "import sys; sys.modules.update(numba=None, llvmlite=None)\n"
        "from vibeam.flight.engine.browser import LIBRARIES, browser_libraries, slots_table\n"
        "browser_libraries(LIBRARIES), slots_table(LIBRARIES)\n"
    )
    subprocess.run([sys.executable, "-c", code], cwd=ROOT, check=True)


def test_a_stale_a_missing_and_a_damaged_library_are_refused(tmp_path: Path) -> None:
    def refused(library: str) -> str:
        with pytest.raises(KernelsUnavailable, match=r"^a page cannot carry the engine: ") as raised:
            browser_libraries([library], folder)
        return str(raised.value)

    folder = tmp_path / "libraries"
    shutil.copytree(FOLDER, folder, ignore=shutil.ignore_patterns("*.py", "__pycache__"))
    about = json.loads((folder / "manifest.json").read_text())
    about["libraries"]["flight"]["sources"] = "0"
    del about["libraries"]["points"]["levels"]["wasm"]
    write_manifest(folder, about["made_with"], about["libraries"])
    assert "older than their sources" in refused("flight")
    assert "there are no compiled kernels for wasm" in refused("points")
    (folder / "wasm" / "regimes.gz").write_bytes(gzip.compress(b"something else"))
    assert "are damaged" in refused("regimes")
    (folder / "wasm" / "tables.gz").unlink()
    assert "cannot be read" in refused("tables")


def test_what_is_missing_to_link_them_is_named_with_its_package(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(RuntimeError, match=r"libc\.a is not there: apt install wasi-libc$"):
        webassembly.archive("wasi-libc", tmp_path)
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(RuntimeError, match="wasm-ld is not installed: apt install lld"):
        webassembly.archive_versions()
