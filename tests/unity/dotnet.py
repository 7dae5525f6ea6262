# SPDX-License-Identifier: Apache-2.0
"""The project files for programs outside Unity, compiled and run without the .NET SDK."""

import shutil
from pathlib import Path
from typing import Final
from xml.etree import ElementTree as ET

from tests.unity import compiler, mono, package
from tests.unity.compiler import Framework
from tests.unity.mono import Binary

PROJECTS: Final = package.HOME / "dotnet"


def library(project: Path, framework: Framework) -> Binary:
    """Compile the sources that a project file names, and the projects that it refers to.

    Raises:
        CompileError: With the compiler's words.
    """
    root = ET.parse(project).getroot()  # noqa: S314  # a file of this repository
    included = (item.attrib["Include"] for item in root.iter("Compile"))
    sources = [path for pattern in included for path in _matching(project.parent, pattern)]
    projects = (item.attrib["Include"] for item in root.iter("ProjectReference"))
    references = [library((project.parent / one).resolve(), framework) for one in projects]
    name = root.findtext("PropertyGroup/AssemblyName")
    assert name is not None
    return mono.compile_assembly(name, sources, references=references, framework=framework)


def put(program: Binary, directory: Path) -> None:
    """Put a program and what it needs into a directory, as a build does."""
    for one in program.closure():
        shutil.copy(one.path, directory)
    settings = directory / f"{program.path.stem}.runtimeconfig.json"
    settings.write_text(compiler.SETTINGS)


def _matching(directory: Path, pattern: str) -> list[Path]:
    base, _, rest = pattern.partition("**/")
    return sorted((directory / base).resolve().rglob(rest))
