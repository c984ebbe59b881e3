"""Wheels and the source archive: each holds its own libraries of kernels, is tagged truly, and runs where installed."""

from __future__ import annotations

import ctypes
import importlib.util
import json
import lzma
import os
import re
import shutil
import struct
import subprocess
import sys
import tarfile
import zipfile
from collections.abc import Iterator
from email.parser import Parser
from hashlib import sha256
from pathlib import Path
from types import ModuleType

import pytest
from hatchling.builders.sdist import SdistBuilder
from hatchling.builders.wheel import WheelBuilder

from vibeam.flight.engine.loading import FOLDER, KEPT, LEVELS, WASM, file_of, manifest, write_manifest

ROOT = Path(__file__).parents[3]
HOOK = ROOT / ".ci" / "build_hook.py"
PLACE = "vibeam/flight/libraries/"
SHORT = ("sweep.frequency.points=3", "sweep.settle=20", "sweep.hold=10")
STEPPING = 'fidelity={stepping={reduction="static_mode",solver="moreau"}}'
OLDEST = "GLIBC_2.2.5"  # what the first glibc for x86-64 called all that it had
NEEDED, HASH, NAMES, SYMBOLS, RELATIVE, VERSIONS = 1, 4, 5, 6, 36, 0x6FFFFFFE  # tags of an ELF's dynamic section
NO_CODE = (b"\x89PNG\r\n", b"$MeshFormat\n")
HERE = "manylinux_2_5_x86_64"


@pytest.fixture(scope="module")
def hook() -> ModuleType:
    described = importlib.util.spec_from_file_location("build_hook", HOOK)
    assert described is not None
    assert described.loader is not None
    module = importlib.util.module_from_spec(described)
    described.loader.exec_module(module)
    return module


@pytest.fixture(autouse=True)
def unasked(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("VIBEAM_WHEEL", "VIBEAM_LIBRARIES"):
        monkeypatch.delenv(name, raising=False)


@pytest.fixture(scope="module")
def libraries(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Libraries of all systems: those of others than Linux without anything in them."""
    folder = tmp_path_factory.mktemp("libraries")
    shutil.copytree(FOLDER, folder, dirs_exist_ok=True)
    found = manifest()
    about = json.loads(json.dumps(found["libraries"]))
    for library in about:
        for level in set(LEVELS) - set(KEPT):
            path = file_of(library, level, folder)
            path.parent.mkdir(exist_ok=True)
            path.write_bytes(f"{level} {library}\0".encode())
            about[library]["levels"][level] = sha256(path.read_bytes()).hexdigest()
    write_manifest(folder, found["made_with"], about)
    return folder


def wheel(folder: Path, name: str = "", libraries: Path | None = None, root: Path = ROOT) -> Path:
    """A wheel of the project, asked for by the variables."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("VIBEAM_WHEEL", name)
        patch.setenv("VIBEAM_LIBRARIES", str(libraries or ""))
        return Path(next(WheelBuilder(str(root)).build(directory=str(folder), versions=["standard"])))


def read(path: Path, name: str) -> str:
    """A text of a wheel's metadata."""
    with zipfile.ZipFile(path) as archive:
        return archive.read(next(each for each in archive.namelist() if each.endswith(f".dist-info/{name}"))).decode()


def held(path: Path) -> set[str]:
    """Files of a wheel that are no text, as by their names among the libraries."""
    with zipfile.ZipFile(path) as archive:
        return {each.removeprefix(PLACE) for each in archive.namelist() if not is_text(archive.read(each))}


def is_text(content: bytes) -> bool:
    """UTF-8, without a zero."""
    try:
        return "\0" not in content.decode()
    except UnicodeDecodeError:
        return False


def numba_of(path: Path) -> list[str]:
    """A wheel's requirements of numba, without those of extras."""
    required = Parser().parsestr(read(path, "METADATA")).get_all("Requires-Dist") or []
    return [each for each in required if each.startswith("numba") and "extra ==" not in each]


def test_every_level_is_in_the_wheels_of_its_own_system(hook: ModuleType, libraries: Path, tmp_path: Path) -> None:
    assert {level for levels in hook.WHEELS.values() for level in levels} == set(LEVELS)
    for name, levels in hook.WHEELS.items():
        files = {str(file_of(each, level, Path())) for each in manifest()["libraries"] for level in levels}
        pages = {f"{WASM}/{each.name}" for each in (FOLDER / WASM).glob("*.gz")}
        assert set(hook.taken(libraries, name, ROOT)) == files | pages
        folder = tmp_path / name
        folder.mkdir()
        (folder / "manifest.json").write_text(hook.manifest_of(libraries, name), encoding="utf-8")
        told = manifest(folder)["libraries"]
        assert {level for each in told.values() for level in each["levels"]} == {*levels, WASM}


def test_a_wheel_is_tagged_and_the_same_each_time(libraries: Path, tmp_path: Path) -> None:
    one, other = (wheel(tmp_path / each, "win_amd64", libraries) for each in ("one", "other"))
    assert one.read_bytes() == other.read_bytes()
    assert one.name.endswith("-py3-none-win_amd64.whl")
    told = Parser().parsestr(read(one, "WHEEL"))
    assert (told["Tag"], told["Root-Is-Purelib"]) == ("py3-none-win_amd64", "false")
    levels = {each.partition("/")[0] for each in held(one)}
    assert levels == {"windows-x86-64-v3", "windows-x86-64-v2", WASM}
    assert ["sys_platform not in" in each for each in numba_of(one)] == [True]


def test_the_pure_wheel_holds_no_kernel_and_needs_numba(tmp_path: Path) -> None:
    made = wheel(tmp_path, "pure")
    assert (made.name[-17:], held(made)) == ("-py3-none-any.whl", set())
    assert "numba>=0.60" in numba_of(made)


@pytest.mark.parametrize(
    ("name", "fault"), [("linux", "'linux' is none of"), ("win_amd64", r"windows-x86-64-v3/\w+\.dll is not there")]
)
def test_a_wheel_that_cannot_be_as_asked_is_refused(
    name: str, fault: str, tmp_path: Path, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(SystemExit):
        wheel(tmp_path, name, FOLDER)
    said = capfd.readouterr()
    assert re.search(fault, said.out + said.err)
    assert list(tmp_path.iterdir()) == []


def test_a_damaged_or_a_stale_library_is_refused(hook: ModuleType, libraries: Path, tmp_path: Path) -> None:
    folder = tmp_path / "libraries"
    shutil.copytree(libraries, folder)
    (folder / "windows-x86-64-v2" / "points.dll").write_bytes(b"\0")
    about = json.loads((folder / "manifest.json").read_text(encoding="utf-8"))
    about["libraries"]["moreau"]["sources"] = "0" * 64
    (folder / "manifest.json").write_text(json.dumps(about), encoding="utf-8")
    with pytest.raises(hook.Unavailable) as found:
        hook.taken(folder, "win_amd64", ROOT)
    for each in ("moreau is older than its sources", "windows-x86-64-v2/points.dll is damaged"):
        assert each in str(found.value)


@pytest.fixture(scope="module")
def unpacked(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The source archive, unpacked."""
    folder = tmp_path_factory.mktemp("sdist")
    archive = next(SdistBuilder(str(ROOT)).build(directory=str(folder), versions=["standard"]))
    with tarfile.open(archive) as file:
        file.extractall(folder, filter="data")
    return next(each for each in folder.iterdir() if each.is_dir())


def test_the_source_archive_holds_no_binary(unpacked: Path) -> None:
    files = [each for each in unpacked.rglob("*") if each.is_file()]
    assert {each.suffix for each in files if not is_text(each.read_bytes())} == {".png", ".msh"}
    assert unpacked / ".ci" / "build_hook.py" in files
    assert list((unpacked / PLACE).rglob("*.??")) == [unpacked / PLACE / "__init__.py"]


def test_what_compiles_is_asked_for_where_the_linker_is(
    unpacked: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setenv("VIBEAM_WHEEL", HERE)
    monkeypatch.setattr("platform.machine", lambda: "x86_64")
    assert WheelBuilder(str(unpacked)).config.dependencies == []
    (tmp_path / "lld-link").touch(mode=0o755)  # of another system
    assert WheelBuilder(str(unpacked)).config.dependencies == []
    (tmp_path / "ld.lld-15").touch(mode=0o755)
    assert {"numba>=0.60", "numpy>=1.26"} <= set(WheelBuilder(str(unpacked)).config.dependencies)
    assert WheelBuilder(str(ROOT)).config.dependencies == []  # the repository keeps the libraries


@pytest.fixture(scope="module")
def environment(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An empty environment, with pip where there is none here."""
    folder = tmp_path_factory.mktemp("environment")
    words = ["--without-pip"] if importlib.util.find_spec("pip") else []
    subprocess.run([sys.executable, "-m", "venv", *words, folder], check=True)
    return folder


def ran(environment: Path, wheel: Path, folder: Path, *given: str, **variables: str) -> str:
    """What a short case says by an installed wheel, which takes its dependencies from this environment."""
    python, packages = environment / "bin" / "python", next(environment.glob("lib/python3*/site-packages"))
    (packages / "dependencies.pth").unlink(missing_ok=True)
    words = ["install", "--quiet", "--no-deps", "--no-index", "--force-reinstall", "--disable-pip-version-check"]
    pip = (
        [sys.executable, "-m", "pip", "--python", python] if importlib.util.find_spec("pip") else [python, "-m", "pip"]
    )
    subprocess.run([*pip, *words, wheel], check=True)
    lines = [each for each in sys.path if each.endswith(("site-packages", "dist-packages"))]
    (packages / "dependencies.pth").write_text("\n".join(lines), encoding="utf-8")
    clean = {key: value for key, value in os.environ.items() if not key.startswith(("PYTHON", "VIBEAM"))}
    usual = clean | {"MPLBACKEND": "agg", "VIBEAM_CACHE": "", "NUMBA_CACHE_DIR": str(folder / "cache")} | variables
    where = [python, "-c", "import vibeam; print(vibeam.__file__)"]
    assert subprocess.run(where, cwd=folder, env=usual, capture_output=True, text=True).stdout.startswith(str(packages))
    subprocess.run([environment / "bin" / "vibeam", "new", "case.toml"], cwd=folder, env=usual, check=True)
    keys = [word for each in (*SHORT, *given) for word in ("--set", each)]
    command = [environment / "bin" / "vibeam", "run", "case.toml", "--json", *keys]
    done = subprocess.run(command, cwd=folder, env=usual, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout + done.stderr


@pytest.mark.skipif(sys.platform != "linux" or os.uname().machine != "x86_64", reason="the wheel of another machine")
def test_wheels_of_this_machine_and_of_the_source_archive_run_where_they_are_installed(
    environment: Path, unpacked: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    made = wheel(tmp_path)
    assert made.name.endswith(f"-{HERE}.whl")
    assert "numba" not in ran(environment, made, tmp_path, VIBEAM_KERNELS="library")
    monkeypatch.setenv("PATH", str(tmp_path))  # without the linker
    other = wheel(tmp_path, root=unpacked)
    assert other.name.endswith("-any.whl")
    (tmp_path / "case.toml").unlink()
    assert "there are no compiled kernels" in ran(environment, other, tmp_path, STEPPING)


def dynamic(content: bytes) -> tuple[set[int], set[str], set[str]]:
    """Tags of a library's dynamic section, the libraries that it needs, and the names that it takes from them."""
    heads, (number,) = struct.unpack_from("<Q", content, 32)[0], struct.unpack_from("<H", content, 56)
    segments = [struct.unpack_from("<II6Q", content, heads + 56 * each) for each in range(number)]
    loaded = [(place, offset, size) for kind, _, offset, place, _, size, *_ in segments if kind == 1]

    def at(place: int) -> int:
        return next(place - begin + offset for begin, offset, size in loaded if begin <= place < begin + size)

    _, _, begin, _, _, size, *_ = next(each for each in segments if each[0] == 2)
    found = [struct.unpack_from("<qQ", content, begin + 16 * each) for each in range(size // 16)]
    tags = dict(found)

    def text(offset: int) -> str:
        start = at(tags[NAMES]) + offset
        return content[start : content.index(b"\0", start)].decode()

    (symbols,) = struct.unpack_from("<I", content, at(tags[HASH]) + 4)
    told = [struct.unpack_from("<IBBHQQ", content, at(tags[SYMBOLS]) + 24 * each) for each in range(1, symbols)]
    taken = {text(name) for name, _, _, section, *_ in told if section == 0}
    return set(tags), {text(value) for tag, value in found if tag == NEEDED}, taken


def test_libraries_take_nothing_that_the_oldest_glibc_has_not() -> None:
    names = set()
    for library in manifest()["libraries"]:
        for level in KEPT:
            tags, needed, taken = dynamic(lzma.decompress(file_of(library, level).read_bytes()))
            assert needed <= {"libm.so.6", "libc.so.6"}
            assert not tags & {VERSIONS, RELATIVE}  # names without versions; relocations as always
            names |= taken
    assert len(names) > 10
    if sys.platform == "linux" and os.uname().machine == "x86_64" and os.confstr("CS_GNU_LIBC_VERSION"):
        assert {each for each in names if not since(each, OLDEST)} == set()
        assert not since("exp10f128", OLDEST)


def since(name: str, version: str) -> bool:
    """Whether a system's mathematical library, or its C library, has had a function since a version."""
    ask = ctypes.CDLL(None).dlvsym
    ask.restype, ask.argtypes = ctypes.c_void_p, (ctypes.c_void_p, ctypes.c_char_p, ctypes.c_char_p)
    opened = [ctypes.CDLL(each)._handle for each in ("libm.so.6", "libc.so.6")]
    return any(ask(each, name.encode(), version.encode()) for each in opened)


def binaries(root: Path) -> Iterator[str]:
    """Files that the repository keeps and that are no text."""
    asked = subprocess.run(["git", "ls-files", "-z"], cwd=root, capture_output=True, check=True).stdout.decode()
    for name in filter(None, asked.split("\0")):
        if (root / name).is_file() and not is_text((root / name).read_bytes()):
            yield name


@pytest.mark.skipif(not (ROOT / ".git").exists(), reason="no repository")
def test_the_repository_keeps_no_binary_but_its_libraries_pictures_and_meshes(tmp_path: Path) -> None:
    about = manifest()["libraries"]
    kept = {
        file_of(library, level).relative_to(ROOT).as_posix() for library in about for level in about[library]["levels"]
    }
    found = set(binaries(ROOT))
    others = {each for each in found - kept if (ROOT / each).read_bytes().startswith(NO_CODE)}
    assert found - others == kept
    subprocess.run(["git", "init", "-q"], cwd=tmp_path, check=True)
    (tmp_path / "kernels.dll").write_bytes(b"MZ\0")
    (tmp_path / "page.md").write_text("text é")
    subprocess.run(["git", "add", "."], cwd=tmp_path, check=True)
    assert list(binaries(tmp_path)) == ["kernels.dll"]
