"""The kernels of web pages in Chromium and Firefox, opened from a file: the bits are those of wasmtime."""

from __future__ import annotations

import json
from base64 import b64encode
from pathlib import Path
from typing import Any

import pytest
import wasm_kernels
from browsers import Opened
from regular_motions import fly_all

from vibeam.flight.engine.browser import FIRST, LIBRARIES, browser_libraries

PAGE = """<!doctype html><meta charset="utf-8"><title>calls</title>
<script id="given" type="application/json">GIVEN</script>
<script>
const given = JSON.parse(document.getElementById("given").textContent);
const decoded = (text) => Uint8Array.from(atob(text), (each) => each.charCodeAt(0));
const unpacked = (bytes) => new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip")));
async function repeated() {
  const memory = new WebAssembly.Memory({ initial: given.first / 65536 }), functions = {};
  for (const library of Object.values(given.libraries)) {
    const bytes = await unpacked(decoded(library)).arrayBuffer();
    const { instance } = await WebAssembly.instantiate(bytes, { env: { memory } });
    Object.assign(functions, instance.exports);
  }
  return given.calls.map(([name, before, after]) => {
    const bytes = decoded(before), expected = decoded(after);
    const more = given.first + bytes.length - memory.buffer.byteLength;
    if (more > 0) memory.grow(Math.ceil(more / 65536));
    new Uint8Array(memory.buffer).set(bytes, given.first);
    const status = functions[name](given.first);
    const found = new Uint8Array(memory.buffer, given.first, bytes.length);
    return [name, status, expected.reduce((sum, byte, i) => sum + (byte === found[i] ? 0 : 1), 0)];
  });
}
window.answer = repeated();
</script>"""


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, list[str]]:
    """A page that repeats calls, and their names."""
    wasm_kernels.take()
    try:
        with wasm_kernels.noted() as calls:
            fly_all()
    finally:
        wasm_kernels.give_back()
    packed = [[name, *(b64encode(each).decode() for each in images)] for name, *images in calls]
    given = {"first": FIRST, "libraries": browser_libraries(LIBRARIES), "calls": packed}
    file = tmp_path_factory.mktemp("bits") / "page.html"
    file.write_text(PAGE.replace("GIVEN", json.dumps(given)), encoding="utf-8")
    return file, [name for name, _, _ in calls]


@pytest.mark.slow
@pytest.mark.parametrize("engine", ["chromium", "firefox"])
def test_every_bit_is_that_of_wasmtime(engine: str, page: tuple[Path, list[str]], request: Any) -> None:
    file, names = page
    if engine == "chromium":
        found = Opened(request.getfixturevalue("browser"), file).page.evaluate("answer")
    else:
        firefox = request.getfixturevalue("firefox")
        firefox.open(file.as_uri())
        found = json.loads(firefox.run("return JSON.stringify(await window.answer);"))
    assert set(names) == {f"{library}_{name}" for library in LIBRARIES for name in LIBRARIES[library]}
    assert found == [[name, 0, 0] for name in names]
