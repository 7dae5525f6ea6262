# SPDX-License-Identifier: Apache-2.0
"""Roslyn, the C# compiler of Unity, as the tests use it: once per content, in one process.

It comes in a package of Microsoft's on npm that needs it, and runs on the .NET that Microsoft has
on PyPI. Both are installed by ``tools/make-clients.sh``. That .NET knows OpenSSL up to 1.1, which
wheels bring, those of ROS too.
"""

import atexit
import fcntl
import hashlib
import itertools
import json
import os
import shutil
import subprocess
import sys
import sysconfig
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from functools import cache
from pathlib import Path
from typing import Final

from tests.clients.driver import INSTALLED

ROOT: Final = Path(__file__).resolve().parents[2]
CACHE: Final = ROOT / ".cache" / "unity"
TIMEOUT_S: Final = 300  # takes 0.1 to 3 s, on a machine that does nothing else

_DRIVER: Final = Path(__file__).parent / "roslyn_driver"
_PACKAGE: Final = INSTALLED / "roslyn-3.10" / "node_modules" / "@autorest" / "csharp"
_DOTNET: Final = INSTALLED / "dotnetcore2-3.1" / "dotnetcore2" / "bin"
_PYTHONNET: Final = INSTALLED / "pythonnet-3.2.1"
_NET: Final = _DOTNET / "shared" / "Microsoft.NETCore.App" / "3.1.23"
_MONO: Final = Path("/usr/lib/mono/4.5")
SETTINGS: Final = """{"runtimeOptions": {"tfm": "netcoreapp3.1",
    "framework": {"name": "Microsoft.NETCore.App", "version": "3.1.0"},
    "configProperties": {"System.Globalization.Invariant": true}}}
"""


class CompileError(Exception):
    """The C# compiler or the translator refused. The text is what it said."""


@dataclass(frozen=True)
class Framework:
    """The libraries that every program gets."""

    libraries: tuple[str, ...]

    @classmethod
    def of_mono(cls) -> "Framework":
        """Return what a program needs that Mono runs."""
        names = ("mscorlib", "System", "System.Core", "System.Xml", "System.Numerics")
        return cls(tuple(str(_MONO / f"{name}.dll") for name in names))

    @classmethod
    def of_net(cls) -> "Framework":
        """Return those of .NET, which has all of .NET Standard 2.1."""
        names = ("System*.dll", "Microsoft*.dll", "mscorlib.dll", "netstandard.dll")
        paths = itertools.chain.from_iterable(map(_NET.glob, names))
        return cls(tuple(sorted(str(path) for path in paths if "Native" not in path.name)))


@dataclass(frozen=True)
class Request:
    """The assembly to compile, as the driver reads it."""

    Out: str
    Sources: tuple[str, ...]
    Defines: tuple[str, ...]
    References: tuple[str, ...]
    Suppressed: tuple[str, ...]
    Style: str = ""


def missing() -> str:
    """Say what is not installed, in words for a skipped test. Empty if all is there."""
    if not all(path.exists() for path in (_DOTNET / "dotnet", _PACKAGE, _PYTHONNET)):
        return "Roslyn is missing: run tools/make-clients.sh .venv"
    return "" if _openssl() else "Roslyn needs OpenSSL 1.1, which no wheel here brings"


def identity() -> str:
    """Return what a compiled assembly also depends on: the compiler."""
    return _driver().parent.name


def compile_now(request: Request) -> None:
    """Compile.

    Raises:
        CompileError: With the compiler's words: errors and warnings, with file and line.
    """
    process = _process()
    assert process.stdin is not None
    assert process.stdout is not None
    process.stdin.write(json.dumps(asdict(request)) + "\n")
    process.stdin.flush()
    line = process.stdout.readline()
    if not line:
        _process.cache_clear()
        raise CompileError("Roslyn ended in the middle of a request: see its standard error")
    if told := json.loads(line):
        raise CompileError("\n".join(told))


def cached(name: str, fill: Callable[[Path], None]) -> Path:
    """Return a directory of `CACHE` that *fill* fills: once, even if others want it."""
    path = CACHE / name
    if path.exists():
        return path
    CACHE.mkdir(parents=True, exist_ok=True)
    with (CACHE / f"{name}.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if path.exists():
            return path
        temporary = Path(tempfile.mkdtemp(prefix="new-", dir=CACHE))
        try:
            fill(temporary)
            temporary.rename(path)
        finally:
            shutil.rmtree(temporary, ignore_errors=True)
    return path


def net_command(program: Path) -> list[str]:
    """Return the command by which .NET runs a program. `SETTINGS` are next to it."""
    return [str(_DOTNET / "dotnet"), str(program)]


def net_environment() -> dict[str, str]:
    """Return the environment in which .NET finds OpenSSL."""
    return _environment(_driver().parent)


def run(arguments: Sequence[str], timeout_s: float, env: dict[str, str] | None = None) -> None:
    """Run a program that compiles.

    Raises:
        CompileError: With its words.
    """
    done = subprocess.run(
        arguments,
        cwd=ROOT,
        env=env,
        timeout=timeout_s,
        check=False,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    if done.returncode != 0:
        raise CompileError(f"{arguments[0]} failed:\n{done.stdout}")


@cache
def _process() -> "subprocess.Popen[str]":
    driver = _driver()
    process = subprocess.Popen(
        net_command(driver),
        env=net_environment(),
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    atexit.register(process.kill)
    return process


@cache
def _driver() -> Path:
    """Compile the driver, and put next to it what it needs: Roslyn, and OpenSSL by its name."""
    sources = sorted(_DRIVER.iterdir())
    content = "\n".join(
        [
            *(source.read_text() for source in sources if source.is_file()),
            SETTINGS,
            str(_openssl()[0]),
        ]
    )
    return cached(hashlib.sha256(content.encode()).hexdigest()[:16], _fill) / "roslyn.dll"


def _fill(directory: Path) -> None:
    for library in _PACKAGE.glob("*.dll"):
        (directory / library.name).symlink_to(library)
    # without it the framework's own, older versions of two libraries would be taken
    (directory / "roslyn.deps.json").symlink_to(_PACKAGE / "AutoRest.CSharp.deps.json")
    (directory / "roslyn.runtimeconfig.json").write_text(SETTINGS)
    (directory / "libssl.so.1.1").symlink_to(_openssl()[0])
    bootstrap = [sys.executable, str(_DRIVER / "bootstrap.py"), str(_DOTNET), str(_PACKAGE)]
    sources = map(str, sorted(_DRIVER.glob("*.cs")))
    run(
        [*bootstrap, str(directory / "roslyn.dll"), *sources],
        TIMEOUT_S,
        {**_environment(directory), "PYTHONPATH": str(_PYTHONNET)},
    )


def _environment(directory: Path) -> dict[str, str]:
    return {**os.environ, "LD_LIBRARY_PATH": f"{directory}:{_openssl()[0].parent}"}


@cache
def _openssl() -> list[Path]:
    return sorted(Path(sysconfig.get_path("platlib")).glob("*.libs/libssl-*.so.1.1*"))
