"""Compiles flatgrasp_cli/kernels: as hatchling's build hook, and as `python hatch_build.py` beside the sources.

The compiler is the system's or, where there is none, zig's, which pip then fetches for the time of the build.
"""

from __future__ import annotations

import contextlib
import importlib.util
import os
import shlex
import shutil
import subprocess
import sys
import sysconfig
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

ROOT = Path(__file__).resolve().parent
KERNELS = Path("flatgrasp_cli", "kernels")
ZIG = "ziglang>=0.13,<0.18"
# Sums are rounded alike by every compiler and processor: products are not fused into them. Without what only a debugger
# reads (-g0, which undoes Python's own -g) kernels are a quarter of the size, compiled in three quarters of the time.
FLAGS = ("-O2", "-ffp-contract=off", "-g0")
ZIG_FLAGS = ("-mcpu=baseline", "-fno-sanitize=undefined", "-DNDEBUG")
DIRECTIVES = {
    "language_level": 3,
    "boundscheck": False,  # it takes as long again; tests check bounds
    "wraparound": False,
    "initializedcheck": False,
    "cdivision": True,
}


class KernelsHook(BuildHookInterface):  # type: ignore[misc]
    """Adds the compiled kernels to a wheel, or compiles them in place for an editable installation."""

    def dependencies(self) -> list[str]:
        """What the build needs besides `build-system.requires`: a compiler, where there is none."""
        return [] if has_compiler() else [ZIG]

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Compile; called before a wheel is put together."""
        build_data["pure_python"] = False
        build_data["infer_tag"] = True
        if version == "editable":
            compile_kernels(ROOT / KERNELS)
            return
        self.folder = tempfile.mkdtemp()
        made = compile_kernels(Path(self.folder))
        build_data["force_include"].update({str(path): str(KERNELS / path.name) for path in made})

    def finalize(self, version: str, build_data: dict[str, Any], artifact_path: str) -> None:  # noqa: ARG002
        """Tidy up; called when the wheel is written."""
        if version != "editable":
            shutil.rmtree(self.folder)


def has_compiler() -> bool:
    """Whether this system has a C compiler that setuptools can call."""
    if sys.platform != "win32":
        return _unix_compiler() is not None
    import setuptools  # noqa: F401, I001 (it brings distutils, which newer Pythons lack)
    from distutils.ccompiler import new_compiler
    from distutils.errors import DistutilsPlatformError

    try:
        new_compiler().initialize()
    except DistutilsPlatformError:
        return False
    return True


def _unix_compiler() -> str | None:
    """The command of a C compiler: the one that is asked for, or the one that made this Python, or another."""
    asked = os.environ.get("CC")
    commands = [asked] if asked else [sysconfig.get_config_var("CC"), "cc", "gcc", "clang"]
    return next((command for command in commands if command and _runs(command)), None)


def _runs(command: str) -> bool:
    """Whether there is such a compiler; macOS has a `cc` that only says that there is none."""
    try:
        done = subprocess.run([*shlex.split(command), "--version"], capture_output=True, check=False)  # noqa: S603
    except OSError:
        return False
    return done.returncode == 0


def compile_kernels(folder: Path, **directives: bool) -> list[Path]:
    """Compile all kernels into `folder`, with other directives to Cython; returns the files that were made."""
    freshness, headers = _freshness(), sysconfig.get_path("include")
    if not Path(headers, "Python.h").exists():
        sys.exit(f"flatgrasp: Python's headers are missing in {headers}; install them (Debian's python3-dev)")
    receipt: Path = freshness.receipt(folder)
    receipt.unlink(missing_ok=True)
    with tempfile.TemporaryDirectory() as temporary:
        sources = _translated(freshness.kernels(ROOT / KERNELS), Path(temporary), DIRECTIVES | directives)
        try:
            made = (_built if has_compiler() else _built_with_zig)(sources, Path(temporary))
        except Exception as error:  # noqa: BLE001 (whatever setuptools raises, the compiler has said the rest)
            sys.exit(f"flatgrasp: the kernels cannot be compiled: {error}; CC names another C compiler")
        placed = [_placed(path, folder) for path in made]
    receipt.write_text(freshness.digest(ROOT / KERNELS), encoding="utf-8")
    return [*placed, receipt]


def _placed(path: Path, folder: Path) -> Path:
    """Copy a file into `folder`; a program that runs with the one before it keeps that."""
    target = folder / path.name
    return Path(shutil.copy(path, target.with_suffix(".new"))).replace(target)


def _freshness() -> Any:
    """The module that says whether kernels are compiled; without the package, whose import asks for that."""
    spec = importlib.util.spec_from_file_location("_freshness", ROOT / KERNELS / "_freshness.py")
    assert spec is not None  # noqa: S101
    assert spec.loader is not None  # noqa: S101
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def _translated(kernels: list[Path], temporary: Path, directives: dict[str, Any]) -> list[Any]:
    """The kernels as setuptools' extensions, whose sources are C."""
    from Cython.Build import cythonize
    from setuptools import Extension

    flags = [] if sys.platform == "win32" else list(FLAGS)
    shared = KERNELS / f"{_freshness().SHARED}.c"  # which Cython writes
    extensions = [Extension(_dotted(path), [str(path)], extra_compile_args=flags) for path in (*kernels, shared)]
    with contextlib.chdir(ROOT):
        translated: list[Any] = cythonize(
            extensions,
            build_dir=str(temporary),
            compiler_directives=directives,
            shared_utility_qualified_name=_dotted(shared),
            quiet=True,
            force=True,
        )
    return translated


def _dotted(source: Path) -> str:
    """The name of the module that is compiled from a file."""
    return ".".join((*KERNELS.parts, source.stem))


def _built(extensions: list[Any], temporary: Path) -> list[Path]:
    """Compile with the system's compiler, as setuptools does it."""
    from setuptools import Distribution
    from setuptools.command.build_ext import build_ext

    if sys.platform != "win32":
        os.environ["CC"] = _unix_compiler() or ""
    command = build_ext(Distribution({"ext_modules": extensions}))
    command.build_lib, command.build_temp = str(temporary / "lib"), str(temporary / "temp")
    command.parallel = os.cpu_count()
    command.ensure_finalized()
    command.run()
    return [Path(path) for path in command.get_outputs()]


def _built_with_zig(extensions: list[Any], temporary: Path) -> list[Path]:
    """Compile with zig: this Python's own flags are for another compiler."""
    if importlib.util.find_spec("ziglang") is None:
        raise RuntimeError("there is no C compiler, and pip install ziglang did not bring one")
    zig = [sys.executable, "-m", "ziglang", "cc", "-shared", *FLAGS, *ZIG_FLAGS, "-I", sysconfig.get_path("include")]

    def build(extension: Any) -> Path:
        made: Path = temporary / (extension.name.rpartition(".")[2] + sysconfig.get_config_var("EXT_SUFFIX"))
        subprocess.run([*zig, *extension.sources, "-o", str(made), *_link_flags()], check=True)  # noqa: S603
        return made

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return list(pool.map(build, extensions))


def _link_flags() -> list[str]:
    if sys.platform == "win32":
        name = f"python{sys.version_info.major}{sys.version_info.minor}"
        return ["-L", str(Path(sys.base_prefix, "libs")), f"-l{name}"]
    return ["-fPIC", *(["-Wl,-undefined,dynamic_lookup"] if sys.platform == "darwin" else [])]


if __name__ == "__main__":
    for each in compile_kernels(ROOT / KERNELS):
        print(each.relative_to(ROOT))
