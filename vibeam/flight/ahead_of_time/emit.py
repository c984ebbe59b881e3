"""Object code of a library for one level: of the optimised modules of its entry points, by LLVM.

What the kernels were compiled to holds for every system and processor; it is linked in ``linking``.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

import llvmlite.binding as llvm

from vibeam.flight.ahead_of_time.wrapper import Compiled, wrapper
from vibeam.flight.engine.loading import WASM

GNU, MSVC = "unknown-linux-gnu", "pc-windows-msvc"
MACOS = "11.0"  # the first system of arm64
WASM_FEATURES = "+simd128,+bulk-memory,+sign-ext,+nontrapping-fptoint"  # in every browser since 2023
SHRINKING = (  # exact ones; most of it are numba's arguments that no callee reads: a seventh of the bytes
    "merge_functions", "ipsccp", "dead_arg_elimination", "aggressive_dce", "simplify_cfg", "merge_functions",
    "global_dead_code_eliminate",
)  # fmt: skip
OF_WINDOWS = """
@_fltused = constant i32 1
module asm ".globl __chkstk
__chkstk:
 movq %rax, %r10
 leaq 8(%rsp), %r11
0: cmpq $4096, %r10
 jb 1f
 subq $4096, %r11
 testq %r11, (%r11)
 subq $4096, %r10
 jmp 0b
1: subq %r10, %r11
 testq %r11, (%r11)
 retq
.globl processor
processor:
 pushq %rbx
 movq %rcx, %r8
 movl $1, %eax
 cpuid
 movq %rcx, (%r8)
 movl $7, %eax
 xorl %ecx, %ecx
 cpuid
 movq %rbx, 8(%r8)
 movl $0x80000001, %eax
 cpuid
 movq %rcx, 16(%r8)
 movq $0, 24(%r8)
 btl $27, (%r8)
 jnc 2f
 xorl %ecx, %ecx
 xgetbv
 movl %eax, 24(%r8)
2: xorl %eax, %eax
 popq %rbx
 retq"
"""  # the mark of floating-point numbers, a probe of each page of a large frame, and ``processor``: four registers


@dataclass(frozen=True)
class Target:
    """A system and its processor as LLVM and the linker name them."""

    triple: str
    processor: str
    features: str
    emulation: str
    relocation: str = "pic"
    passes: tuple[str, ...] = ()  # over the whole library before it is emitted
    support: str = ""  # LLVM's text of what the system expects in each library


TARGETS = {
    "x86-64-v3": Target(f"x86_64-{GNU}", "x86-64-v3", "", "elf_x86_64"),
    "x86-64-v2": Target(f"x86_64-{GNU}", "x86-64-v2", "", "elf_x86_64"),
    "aarch64": Target(f"aarch64-{GNU}", "generic", "", "aarch64linux"),
    "windows-x86-64-v3": Target(f"x86_64-{MSVC}", "x86-64-v3", "", "x64", support=OF_WINDOWS),
    "windows-x86-64-v2": Target(f"x86_64-{MSVC}", "x86-64-v2", "", "x64", support=OF_WINDOWS),
    "macos-arm64": Target(f"arm64-apple-macosx{MACOS}.0", "apple-m1", "", "arm64"),
    "macos-x86-64-v2": Target(f"x86_64-apple-macosx{MACOS}.0", "x86-64-v2", "", "x86_64"),
    WASM: Target("wasm32-unknown-unknown", "mvp", WASM_FEATURES, "wasm32", "static", SHRINKING),
}


def emitted(library: str, parts: Sequence[Compiled], level: str) -> bytes:
    """Object code with one exported function ``library_name`` for each entry point."""
    target = TARGETS[level]
    machine = _machine(target)
    exported = {f"{library}_{part.entry.name}": part for part in parts}
    whole = _parsed(target.support, machine, target)
    for name, part in exported.items():
        module = _parsed(part.text, machine, target)
        module.link_in(_parsed(wrapper(part, name), machine, target))
        _hide(module, {name})
        _run(("global_dead_code_eliminate",), module, machine)
        whole.link_in(module)
    _run(target.passes, whole, machine)
    return bytes(machine.emit_object(whole))


def object_code(text: str, target: Target) -> bytes:
    """Object code of a module in LLVM's language."""
    machine = _machine(target)
    return bytes(machine.emit_object(_parsed(text, machine, target)))


def _machine(target: Target) -> llvm.TargetMachine:
    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    llvm.initialize_native_asmparser()
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
