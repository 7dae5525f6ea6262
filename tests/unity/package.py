# SPDX-License-Identifier: Apache-2.0
"""The packages' assembly definitions, compiled for a target as Unity compiles them."""

import itertools
import json
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any, Final

from tests.unity import mono
from tests.unity.compiler import CompileError, Framework
from tests.unity.mono import Binary
from tools import unity_metas

HOME: Final = unity_metas.HOME
PACKAGES: Final = unity_metas.PACKAGES
CLIENT, DISPLAYS, ROBOTS = PACKAGES
STUB: Final = Path(__file__).parent / "stub"
RUNNER: Final = Path(__file__).parent / "runner"
SURFACE: Final = Path(__file__).parent / "surface"
MONO: Final = Framework.of_mono()
STYLE: Final = HOME / ".editorconfig"

_OF_THE_STUB: Final = ("CS0067", "CS0169", "CS0414", "CS0649")  # Unity uses these
_STUB_REFERENCES: Final[dict[str, tuple[str, ...]]] = {
    "UnityEngine": (),
    "UnityEditor": ("UnityEngine",),
    "UnityEngine.TestRunner": ("UnityEngine",),
    "UnityEngine.UI": ("UnityEngine",),
    "Unity.InputSystem": ("UnityEngine",),
    "Unity.TextMeshPro": ("UnityEngine", "UnityEngine.UI"),
    "Unity.XR.Interaction.Toolkit": ("UnityEngine", "Unity.InputSystem"),
}
_INPUT_SYSTEM: Final = "com.unity.inputsystem"
_OPTIONAL: Final = {
    "com.unity.ugui": "UnityEngine.UI",
    "com.unity.textmeshpro": "Unity.TextMeshPro",  # from Unity 6 on in com.unity.ugui
    _INPUT_SYSTEM: "Unity.InputSystem",
    "com.unity.xr.interaction.toolkit": "Unity.XR.Interaction.Toolkit",
}
# every version that has its own define, oldest first
_UNITY_VERSIONS: Final = (
    *("2019_1", "2019_2", "2019_3", "2019_4", "2020_1", "2020_2", "2020_3"),
    *("2021_1", "2021_2", "2021_3", "2022_1", "2022_2", "2022_3", "2023_1", "2023_2"),
    *("6000_0",),
)


@dataclass(frozen=True)
class Target:
    """The target of Unity's build: decides which assemblies are compiled, and their defines."""

    name: str
    platform: str
    """As in an assembly definition's ``includePlatforms``."""
    defines: tuple[str, ...]
    unity: str = "2021_3"
    packages: frozenset[str] = frozenset()
    """The optional packages that are installed."""
    legacy_input: bool = True
    """Whether the player settings have the Input Manager on, even with the Input System."""
    tests: bool = False
    """Whether Unity's Test Framework also compiles its tests."""
    net: bool = False
    """Whether .NET's libraries are those to compile with, not those of Mono, which runs it then."""

    def __str__(self) -> str:
        return self.name

    def with_everything(self) -> "Target":
        """Return it with the newest Unity, all optional packages and the tests."""
        return replace(
            self, unity="6000_0", packages=frozenset(_OPTIONAL), tests=True, name=f"{self}-full"
        )

    def with_net(self) -> "Target":
        """Return it with .NET's libraries, which have all that Unity's have. Nothing runs it."""
        return replace(self, net=True, name=f"{self}-net")

    def framework(self) -> Framework:
        """Return the libraries of every program."""
        return Framework.of_net() if self.net else MONO

    def all_defines(self) -> tuple[str, ...]:
        """Return every symbol that Unity defines."""
        versions = _UNITY_VERSIONS[: _UNITY_VERSIONS.index(self.unity) + 1]
        return (
            *self.defines,
            *(f"UNITY_{version}_OR_NEWER" for version in versions),
            *("CSHARP_7_3_OR_NEWER", "NET_STANDARD", "NET_STANDARD_2_1", "NETSTANDARD2_1"),
            *self._inputs(),
            *(("UNITY_INCLUDE_TESTS",) if self.tests else ()),
        )

    def _inputs(self) -> tuple[str, ...]:
        return (
            *(("ENABLE_LEGACY_INPUT_MANAGER",) if self.legacy_input else ()),
            *(("ENABLE_INPUT_SYSTEM",) if _INPUT_SYSTEM in self.packages else ()),
        )


_LINUX: Final = ("UNITY_STANDALONE", "UNITY_STANDALONE_LINUX", "UNITY_64", "ENABLE_MONO")
EDITOR: Final = Target(
    "editor",
    "Editor",
    (*_LINUX, "UNITY_EDITOR", "UNITY_EDITOR_64", "UNITY_EDITOR_LINUX", "DEBUG", "UNITY_ASSERTIONS"),
)
STANDALONE: Final = Target("standalone", "LinuxStandalone64", _LINUX)
ANDROID: Final = Target("android", "Android", ("UNITY_ANDROID", "ENABLE_IL2CPP"))
WEBGL: Final = Target("webgl", "WebGL", ("UNITY_WEBGL", "ENABLE_IL2CPP"))
TARGETS: Final = (EDITOR, STANDALONE, ANDROID, WEBGL)


@dataclass(frozen=True)
class AssemblyDefinition:
    """An ``.asmdef`` file."""

    path: Path
    name: str
    references: tuple[str, ...]
    include_platforms: tuple[str, ...]
    exclude_platforms: tuple[str, ...]
    constraints: tuple[str, ...]
    version_defines: tuple[tuple[str, str], ...]
    """Package and symbol."""
    precompiled: tuple[str, ...]
    engine: bool

    @classmethod
    def read(cls, path: Path) -> "AssemblyDefinition":
        """Read the file."""
        content: dict[str, Any] = json.loads(path.read_text())
        return cls(
            path,
            content["name"],
            tuple(content.get("references", ())),
            tuple(content.get("includePlatforms", ())),
            tuple(content.get("excludePlatforms", ())),
            tuple(content.get("defineConstraints", ())),
            tuple((entry["name"], entry["define"]) for entry in content.get("versionDefines", ())),
            tuple(content.get("precompiledReferences", ())),
            not content.get("noEngineReferences", False),
        )

    def package(self) -> Path | None:
        """Return the folder of its package. None if it is of a project."""
        return next((one for one in PACKAGES if one in self.path.parents), None)

    def sources(self) -> list[Path]:
        """Return its files: those below it that no other definition claims."""
        return sorted(_sources(self.path.parent, top=True))

    def defines(self, target: Target) -> tuple[str, ...]:
        """Return the symbols for its sources."""
        return (
            *target.all_defines(),
            *(define for name, define in self.version_defines if name in target.packages),
        )

    def applies_to(self, target: Target) -> bool:
        """Tell whether Unity compiles it for the target."""
        if self.include_platforms and target.platform not in self.include_platforms:
            return False
        defines = self.defines(target)
        return target.platform not in self.exclude_platforms and all(
            any(_holds(symbol.strip(), defines) for symbol in constraint.split("||"))
            for constraint in self.constraints
        )


@cache
def assembly_definitions() -> dict[str, AssemblyDefinition]:
    """Return those of the packages and their samples, by name."""
    definitions = map(AssemblyDefinition.read, sorted(HOME.rglob("*.asmdef")))
    return {definition.name: definition for definition in definitions}


@cache
def installed_with(package: Path) -> frozenset[Path]:
    """Return a package and its dependencies, as its ``package.json`` names them."""
    manifests = {one: json.loads((one / "package.json").read_text("utf-8")) for one in PACKAGES}
    needed = manifests[package]["dependencies"]
    direct = (one for one, manifest in manifests.items() if manifest["name"] in needed)
    return frozenset({package}.union(*map(installed_with, direct)))


def libraries(target: Target, *packages: Path) -> list[Binary]:
    """Compile what a project may refer to: the runtime of some packages, or of all."""
    return [
        compiled(name, target)
        for name, definition in assembly_definitions().items()
        if any(one / "Runtime" in definition.path.parents for one in packages or PACKAGES)
    ]


@cache
def compiled(name: str, target: Target) -> Binary:
    """Compile an assembly of a package and what it refers to.

    Raises:
        CompileError: With the compiler's words.
    """
    definition = assembly_definitions()[name]
    return compiled_definition(definition, target, definition.sources())


def compiled_definition(
    definition: AssemblyDefinition, target: Target, sources: list[Path]
) -> Binary:
    """Compile sources as an assembly definition says, which may be that of a project.

    Raises:
        CompileError: With the compiler's words.
    """
    references = [
        compiled(reference, target)
        if reference in assembly_definitions()
        else stub(reference, target.framework())
        for reference in referenced(definition, target)
    ]
    if "nunit.framework.dll" in definition.precompiled:
        references.append(mono.nunit())
    return mono.compile_assembly(
        definition.name,
        sources,
        references=references,
        defines=definition.defines(target),
        suppressed=_suppressed(definition),
        framework=target.framework(),
    )


def referenced(definition: AssemblyDefinition, target: Target) -> list[str]:
    """Name the assemblies of the packages and of the stub that one is compiled against.

    Raises:
        ValueError: It refers to an assembly that is not installed with its package.
    """
    names = list(_present(definition, target))
    if definition.engine:
        names.insert(0, "UnityEngine")
        if target.platform == "Editor":
            names.append("UnityEditor")
    return list(dict.fromkeys(names))


def complaints(name: str, *, documented: bool) -> str:
    """Return what the compiler says of a package's assembly by the rules of ``.editorconfig``.

    With *documented*, also of public members without a summary. Empty if all is well.
    """
    definition = assembly_definitions()[name]
    target = EDITOR.with_everything()
    try:
        mono.compile_assembly(
            name,
            definition.sources(),
            references=compiled(name, target).references,
            defines=definition.defines(target),
            suppressed=_suppressed(definition),
            documented=documented,
            style=STYLE,
        )
    except CompileError as error:
        return str(error)
    return ""


@cache
def stub(name: str, framework: Framework = MONO) -> Binary:
    """Compile one of the stub's assemblies."""
    return mono.compile_assembly(
        name,
        sorted((STUB / name).rglob("*.cs")),
        references=[stub(reference, framework) for reference in _STUB_REFERENCES[name]],
        suppressed=_OF_THE_STUB,
        framework=framework,
    )


def stubs() -> list[Binary]:
    """Compile all of the stub."""
    return [stub(name) for name in _STUB_REFERENCES]


@cache
def runner() -> Binary:
    """Compile what runs NUnit's tests."""
    return mono.compile_assembly(
        "runner.exe",
        sorted(RUNNER.glob("*.cs")),
        references=[
            mono.nunit(),
            *map(stub, ("UnityEngine", "UnityEngine.TestRunner")),
        ],
    )


def _suppressed(definition: AssemblyDefinition) -> tuple[str, ...]:
    # a serialized field is assigned by Unity, which silences this warning as well
    return ("CS0649",) if definition.engine else ()


def _present(definition: AssemblyDefinition, target: Target) -> Iterator[str]:
    """Leave out the optional packages that are not installed, as Unity does."""
    package = definition.package()
    for reference in definition.references:
        if (found := assembly_definitions().get(reference)) is not None:
            if package and found.package() not in installed_with(package):
                raise ValueError(f"{definition.name}: {reference} is not of a declared dependency")
            if found.applies_to(target):
                yield reference
        elif reference in _OPTIONAL.values():
            if any(_OPTIONAL[one] == reference for one in target.packages):
                yield reference
        elif reference == "UnityEngine.TestRunner":
            yield reference
        elif reference != "UnityEditor.TestRunner":
            raise ValueError(f"unknown assembly {reference}: not of a package, nor of the stub")


def _sources(directory: Path, *, top: bool) -> Iterator[Path]:
    entries = sorted(directory.iterdir())
    if not top and any(entry.suffix == ".asmdef" for entry in entries):
        return
    yield from (entry for entry in entries if entry.suffix == ".cs")
    folders = (entry for entry in entries if entry.is_dir())
    kept = (f for f in folders if not f.name.endswith("~") and not f.name.startswith("."))
    yield from itertools.chain.from_iterable(_sources(folder, top=False) for folder in kept)


def _holds(symbol: str, defines: tuple[str, ...]) -> bool:
    return symbol[1:] not in defines if symbol.startswith("!") else symbol in defines
