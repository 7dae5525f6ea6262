# SPDX-License-Identifier: Apache-2.0
"""Mono as the tests use it: compile C# for it, run it, translate it ahead of time.

Unity's editor and desktop players also run on Mono. The full ahead-of-time mode, without a JIT
compiler, stands in for IL2CPP.
"""

import hashlib
import os
import shutil
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

from tests.unity import compiler
from tests.unity.compiler import CACHE, CompileError, Framework, Request

TRANSLATE_TIMEOUT_S: Final = 900

# By default there is room for 4096 delegates and lazily bound calls in a process, and for 512 calls
# by interfaces. One that runs hundreds of tests needs more.
_TRANSLATE: Final = "--aot=full,ntrampolines=65536,nimt-trampolines=16384"

_OF_MONO: Final = Framework.of_mono()
_UNDOCUMENTED: Final = "CS1591"
_NUNIT_DIRECTORIES: Final = Path("/usr/lib/cli")
_FRAMEWORK_DIRECTORY: Final = Path("/usr/lib/mono/4.5")
# mscorlib first: the others are translated against it
_FRAMEWORK: Final = (
    *("mscorlib", "System", "System.Core", "System.Configuration", "System.Xml"),
    *("System.Security", "System.Numerics", "Mono.Security"),
)


@dataclass(frozen=True)
class Binary:
    """A compiled assembly and those that it needs at run time."""

    path: Path
    references: tuple["Binary", ...] = ()

    @property
    def name(self) -> str:
        """The assembly's name."""
        return self.path.stem

    def closure(self) -> Iterator["Binary"]:
        """Yield it and everything that it needs, what is needed first, each once."""
        seen: dict[Path, Binary] = {}
        for reference in self.references:
            for needed in reference.closure():
                seen.setdefault(needed.path, needed)
        seen.setdefault(self.path, self)
        yield from seen.values()


def missing() -> str:
    """Say what is not installed, in words for a skipped test. Empty if all is there."""
    absent = ["mono"] if shutil.which("mono") is None else []
    if not _nunit_paths():
        absent.append("NUnit 2.6")
    words = f"{', '.join(absent)} missing: run tools/make-mono.sh as root" if absent else ""
    return words or compiler.missing()


def missing_ahead_of_time() -> str:
    """Like `missing`, for `ahead_of_time`."""
    absent = [program for program in ("as", "ld") if shutil.which(program) is None]
    return missing() or (
        f"{', '.join(absent)} missing: run tools/make-mono.sh as root" if absent else ""
    )


def nunit() -> Binary:
    """The NUnit framework that the tests are compiled against."""
    return Binary(_nunit_paths()[-1])


def compile_assembly(
    name: str,
    sources: Sequence[Path],
    *,
    references: Sequence[Binary] = (),
    defines: Sequence[str] = (),
    suppressed: Sequence[str] = (),
    documented: bool = False,
    style: Path | None = None,
    framework: Framework = _OF_MONO,
) -> Binary:
    """Compile `sources` to ``name.dll`` (or ``.exe``, by the name), warnings being errors.

    The same sources, references and options are compiled once, and found again by later runs.

    Args:
        name: The assembly's.
        sources: Its files.
        references: What it is compiled against, besides the framework.
        defines: Its symbols.
        suppressed: Codes of warnings that do not count.
        documented: Whether each public member needs a summary.
        style: An ``.editorconfig``. Code that breaks one of its rules is an error.
        framework: Its libraries.

    Raises:
        CompileError: With the compiler's words.
    """
    filename = name if name.endswith(".exe") else f"{name}.dll"
    if not sources:
        raise CompileError(f"{name} has no sources")
    request = Request(
        filename,
        tuple(map(str, sources)),
        tuple(defines),
        (*(str(reference.path) for reference in references), *framework.libraries),
        (*suppressed, *(() if documented else (_UNDOCUMENTED,))),
        str(style or ""),
    )
    digest = hashlib.sha256(f"{compiler.identity()}{request}".encode())
    for source in (*sources, *([style] if style else ())):
        digest.update(f"\n{source}\n".encode() + source.read_bytes())

    def fill(directory: Path) -> None:
        compiler.compile_now(replace(request, Out=str(directory / filename)))

    directory = compiler.cached(digest.hexdigest()[:16], fill)
    return Binary(directory / filename, tuple(references))


def ahead_of_time(binary: Binary) -> Binary:
    """Translate an assembly and everything that it needs to machine code, completely.

    Raises:
        CompileError: With the translator's words.
    """
    framework = _translated_framework()
    translated: dict[Path, Binary] = {}
    for needed in binary.closure():
        references = tuple(translated[reference.path] for reference in needed.references)
        translated[needed.path] = _translated(needed, (framework, *references))
    return translated[binary.path]


def command(binary: Binary, *arguments: str, full_aot: bool = False) -> list[str]:
    """The command that runs a program, with its `environment`."""
    return ["mono", "--debug", *(["--full-aot"] if full_aot else []), str(binary.path), *arguments]


def environment(*binaries: Binary) -> dict[str, str]:
    """Return the environment in which a program finds these and what they need."""
    directories = {str(n.path.parent): None for binary in binaries for n in binary.closure()}
    return {**os.environ, "MONO_PATH": ":".join(directories)}


def _translated(binary: Binary, references: tuple[Binary, ...]) -> Binary:
    key = "\n".join(str(path) for path in (binary.path, *(r.path for r in references)))
    digest = hashlib.sha256(key.encode() + binary.path.read_bytes()).hexdigest()[:16]
    translated = Binary(CACHE / f"{digest}-aot" / binary.path.name, references)

    def fill(directory: Path) -> None:
        _copy(binary.path, directory)
        _translate(directory / binary.path.name, environment(*references))

    compiler.cached(translated.path.parent.name, fill)
    return translated


def _translated_framework() -> Binary:
    """All of the framework in one directory. `mscorlib` stands for it."""
    sources = [_FRAMEWORK_DIRECTORY / f"{name}.dll" for name in _FRAMEWORK]
    digest = hashlib.sha256(_TRANSLATE.encode())
    for source in sources:
        digest.update(source.read_bytes())
    framework = CACHE / f"{digest.hexdigest()[:16]}-framework"

    def fill(directory: Path) -> None:
        for source in sources:
            _copy(source, directory)
        for source in sources:
            _translate(directory / source.name, {**os.environ, "MONO_PATH": str(directory)})

    compiler.cached(framework.name, fill)
    return Binary(framework / "mscorlib.dll")


def _translate(library: Path, env: dict[str, str]) -> None:
    compiler.run(["mono", _TRANSLATE, str(library)], TRANSLATE_TIMEOUT_S, env)


def _copy(binary: Path, directory: Path) -> None:
    shutil.copy(binary, directory)
    for symbols in (binary.with_suffix(".pdb"), Path(f"{binary}.mdb")):
        if symbols.exists():
            shutil.copy(symbols, directory)


def _nunit_paths() -> list[Path]:
    return sorted(_NUNIT_DIRECTORIES.glob("nunit.framework-2.6*/nunit.framework.dll"))
