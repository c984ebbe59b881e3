"""A library for one level: object code of the optimised modules of its entry points, linked by LLVM's ``ld.lld``.

It is linked against stand-ins of the system's libraries: the same bytes on every machine. What WebAssembly is linked
with, is in ``webassembly``.
"""

from __future__ import annotations

import re
import shutil
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import llvmlite.binding as llvm

from vibeam.flight.ahead_of_time.wrapper import Compiled, wrapper
from vibeam.flight.engine.loading import WASM

LINUX = "unknown-linux-gnu"
LINKER = "ld.lld"
WASM_FEATURES = "+simd128,+bulk-memory,+sign-ext,+nontrapping-fptoint"  # in every browser since 2023
SHRINKING = (  # exact ones; most of it are numba's arguments that no callee reads: a seventh of the bytes
    "merge_functions", "ipsccp", "dead_arg_elimination", "aggressive_dce", "simplify_cfg", "merge_functions",
    "global_dead_code_eliminate",
)  # fmt: skip
SYSTEM = {  # all that the kernels may call of the system, by its library
    "libm.so.6": ("cos", "cosh", "exp", "expm1", "fmod", "hypot", "ldexp", "pow", "sin", "sincos", "sinh"),
    "libc.so.6": ("memcpy", "memset"),
}


@dataclass(frozen=True)
class Target:
    """A processor as LLVM and the linker name it."""

    triple: str
    processor: str
    features: str
    emulation: str
    relocation: str = "pic"
    passes: tuple[str, ...] = ()  # over the whole library before it is emitted


TARGETS = {
    "x86-64-v3": Target(f"x86_64-{LINUX}", "x86-64-v3", "", "elf_x86_64"),
    "x86-64-v2": Target(f"x86_64-{LINUX}", "x86-64-v2", "", "elf_x86_64"),
    "aarch64": Target(f"aarch64-{LINUX}", "generic", "", "aarch64linux"),
    WASM: Target("wasm32-unknown-unknown", "mvp", WASM_FEATURES, "wasm32", "static", SHRINKING),
}


def emitted(library: str, parts: Sequence[Compiled], level: str) -> bytes:
    """Object code with one exported function ``library_name`` for each entry point."""
    target = TARGETS[level]
    machine = _machine(target)
    exported = {f"{library}_{part.entry.name}": part for part in parts}
    whole = _parsed("", machine, target)
    for name, part in exported.items():
        module = _parsed(part.text, machine, target)
        module.link_in(_parsed(wrapper(part, name), machine, target))
        _hide(module, {name})
        _run(("global_dead_code_eliminate",), module, machine)
        whole.link_in(module)
    _run(target.passes, whole, machine)
    return bytes(machine.emit_object(whole))


def stand_ins(symbols: Sequence[str], level: str) -> bytes:
    """Object code of functions that do nothing, for the linker to know their names by."""
    target = TARGETS[level]
    machine = _machine(target)
    text = "\n".join(f"define void @{symbol}() {{ ret void }}" for symbol in symbols)
    return bytes(machine.emit_object(_parsed(text, machine, target)))


def _machine(target: Target) -> llvm.TargetMachine:
    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    return llvm.Target.from_triple(target.triple).create_target_machine(
        cpu=target.processor, features=target.features, opt=3, reloc=target.relocation, codemodel="default"
    )


def _parsed(text: str, machine: llvm.TargetMachine, target: Target) -> llvm.ModuleRef:
    """The module, for that target: attributes that bind functions to another are left out."""
    text = re.sub(r"^target (triple|datalayout) = .*$", "", text, flags=re.MULTILINE)
    text = text.replace("@numba_ldexp(", "@ldexp(")  # the same function under a name of numba's own
    text = re.sub(r'"(target-cpu|target-features|tune-cpu|probe-stack)"="[^"]*"', "", text)
    module = llvm.parse_assembly(text)
    module.triple, module.data_layout = target.triple, str(machine.target_data)
    module.verify()
    return module


def _hide(module: llvm.ModuleRef, exported: set[str]) -> None:
    """Nothing but ``exported`` is seen from outside."""
    for each in (*module.functions, *module.global_variables):
        if not each.is_declaration and each.name not in exported:
            each.linkage = "internal"


def _run(names: Sequence[str], module: llvm.ModuleRef, machine: llvm.TargetMachine) -> None:
    passes = llvm.create_new_module_pass_manager()
    for name in names:
        getattr(passes, f"add_{name}_pass")()
    passes.run(module, llvm.create_pass_builder(machine, llvm.create_pipeline_tuning_options(speed_level=0)))


def linker(name: str = LINKER) -> str:
    """The linker's path; RuntimeError with the cure where there is none."""
    found = shutil.which(name)
    if found is None:
        raise RuntimeError(f"{name} is not installed: apt install lld, or another system's LLVM package")
    return found


def linker_version() -> str:
    """Version of the linker, in its own words."""
    return subprocess.run([linker(), "--version"], capture_output=True, text=True, check=True).stdout.strip()


def linked(content: bytes, level: str) -> bytes:
    """The shared library of one object file."""
    with TemporaryDirectory() as place:
        folder = Path(place)
        (folder / "kernels.o").write_bytes(content)
        for name, symbols in SYSTEM.items():
            (folder / "system.o").write_bytes(stand_ins(symbols, level))
            _link(level, folder, name, "system.o", "-soname", name)
        _link(level, folder, "kernels.so", "kernels.o", "-z", "defs", "--as-needed", *SYSTEM)
        return (folder / "kernels.so").read_bytes()


def _link(level: str, folder: Path, out: str, *given: str) -> None:
    command = [linker(), "-m", TARGETS[level].emulation, "-shared", "-s", "--build-id=none", "-z", "noexecstack"]
    subprocess.run([*command, *given, "-o", out], cwd=folder, check=True)
