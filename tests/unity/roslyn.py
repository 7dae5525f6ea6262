# SPDX-License-Identifier: Apache-2.0
"""Roslyn, the C# compiler of Unity, as the tests use it: it checks assemblies, and emits nothing.

It comes in a package of Microsoft's on npm that needs it, and runs on the .NET that Microsoft has
on PyPI. Both are installed by ``tools/make-clients.sh``. That .NET knows OpenSSL up to 1.1, which
wheels bring, those of ROS too.
"""

import os
import subprocess
import sysconfig
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Final

from tests.clients.driver import INSTALLED
from tests.unity import mono, package
from tests.unity.mono import CompileError
from tests.unity.package import Target

TIMEOUT_S: Final = 600  # takes 10 s for a target, on a machine that does nothing else

_DRIVER: Final = Path(__file__).parent / "roslyn_driver" / "Program.cs"
_PACKAGE: Final = INSTALLED / "roslyn-3.10" / "node_modules" / "@autorest" / "csharp"
_DOTNET: Final = INSTALLED / "dotnetcore2-3.1" / "dotnetcore2" / "bin"
_FRAMEWORK: Final = _DOTNET / "shared" / "Microsoft.NETCore.App" / "3.1.23"

# the references of the driver: the types of .NET, and their stated assemblies
_CORE: Final = (
    *("System.Private.CoreLib", "System.Runtime", "System.Runtime.Extensions", "System.Console"),
    *(
        "System.Collections",
        "System.IO.FileSystem",
        "System.Text.Encoding.Extensions",
        "netstandard",
    ),
)
_COMPILER: Final = (
    *("Microsoft.CodeAnalysis", "Microsoft.CodeAnalysis.CSharp"),
    *("System.Collections.Immutable", "System.Reflection.Metadata"),
)
_OF_THE_STUB: Final = ("CS0067", "CS0169", "CS0414", "CS0649")  # Unity uses these
_SETTINGS: Final = """{"runtimeOptions": {"tfm": "netcoreapp3.1",
    "framework": {"name": "Microsoft.NETCore.App", "version": "3.1.0"},
    "configProperties": {"System.Globalization.Invariant": true}}}
"""


@dataclass(frozen=True)
class Assembly:
    """An assembly to check. A reference is the name of one before it, or a library."""

    name: str
    sources: tuple[Path, ...]
    defines: tuple[str, ...] = ()
    references: tuple[str | Path, ...] = ()
    suppressed: tuple[str, ...] = ()

    def lines(self) -> Iterable[str]:
        """Say it to the driver."""
        yield f"assembly {self.name}"
        yield from (f"source {source}" for source in self.sources)
        yield from (f"define {define}" for define in self.defines)
        yield from (f"suppress {code}" for code in self.suppressed)
        for reference in self.references:
            kind = "library" if isinstance(reference, Path) else "reference"
            yield f"{kind} {reference}"


def described(target: Target) -> list[Assembly]:
    """Describe the stub, and what Unity compiles for a target, in the order of their needs."""
    assemblies = [
        Assembly(name, sources, references=references, suppressed=_OF_THE_STUB)
        for name, (sources, references) in package.stub_sources().items()
    ]
    waiting = [d for d in package.assembly_definitions().values() if d.applies_to(target)]
    while waiting:
        known = {assembly.name for assembly in assemblies}
        one = next(d for d in waiting if known.issuperset(package.referenced(d, target)))
        waiting.remove(one)
        tested = "nunit.framework.dll" in one.precompiled
        assemblies.append(
            Assembly(
                one.name,
                tuple(one.sources()),
                one.defines(target),
                (*package.referenced(one, target), *((mono.nunit().path,) if tested else ())),
                ("CS0649",) if one.engine else (),  # a serialized field is assigned by Unity
            )
        )
    return assemblies


def missing() -> str:
    """Say what is not installed, in words for a skipped test. Empty if all is there."""
    if not (_DOTNET / "dotnet").exists() or not _PACKAGE.exists():
        return "Roslyn is missing: run tools/make-clients.sh .venv"
    if not _openssl():
        return "Roslyn needs OpenSSL 1.1, which no wheel here brings"
    return mono.missing()


def diagnostics(assemblies: Iterable[Assembly]) -> list[str]:
    """Return errors and warnings, each with its assembly, file and line.

    Raises:
        CompileError: The compiler itself failed. With its words.
    """
    driver = _driver()
    libraries = f"{driver.parent}:{_openssl()[0].parent}"
    done = subprocess.run(
        [str(_DOTNET / "dotnet"), str(driver)],
        env={**os.environ, "LD_LIBRARY_PATH": libraries},
        input="\n".join(line for assembly in assemblies for line in assembly.lines()),
        capture_output=True,
        timeout=TIMEOUT_S,
        check=False,
        text=True,
    )
    if done.returncode != 0:
        raise CompileError(f"Roslyn failed:\n{done.stdout}{done.stderr}")
    return done.stdout.splitlines()


@cache
def _driver() -> Path:
    """Compile the driver, and put next to it what it needs: Roslyn, and OpenSSL by its name."""
    references = [f"-reference:{_FRAMEWORK / name}.dll" for name in _CORE]
    references += [f"-reference:{_PACKAGE / name}.dll" for name in _COMPILER]
    content = "\n".join([_DRIVER.read_text(), _SETTINGS, str(_openssl()[0]), *references])
    return mono.cached(content, lambda directory: _fill(directory, references)) / "roslyn.dll"


def _fill(directory: Path, references: list[str]) -> None:
    mono.run(
        [
            *("mcs", "-nologo", "-warnaserror", "-langversion:7.2", "-nostdlib", "-noconfig"),
            *(*references, f"-out:{directory / 'roslyn.dll'}", "-target:exe", str(_DRIVER)),
        ]
    )
    for library in _PACKAGE.glob("*.dll"):
        (directory / library.name).symlink_to(library)
    # without it the framework's own, older versions of two libraries would be taken
    (directory / "roslyn.deps.json").symlink_to(_PACKAGE / "AutoRest.CSharp.deps.json")
    (directory / "roslyn.runtimeconfig.json").write_text(_SETTINGS)
    (directory / "libssl.so.1.1").symlink_to(_openssl()[0])


@cache
def _openssl() -> list[Path]:
    return sorted(Path(sysconfig.get_path("platlib")).glob("*.libs/libssl-*.so.1.1*"))
