# SPDX-License-Identifier: Apache-2.0
# mypy: disable-error-code="import-untyped"
"""Build a ROS interface package with the generators of the wheels and gcc, without colcon or CMake.

A package becomes one Python extension and two libraries next to it. rmw asks for these two by name,
long after Python has loaded them with the extension. So the library path stays as it is.
"""

import json
import re
import shutil
import subprocess
import sys
import sysconfig
import tempfile
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any, Final, NamedTuple

import numpy as np
from rosidl_adapter import convert_to_idl
from rosidl_generator_c import generate_c
from rosidl_generator_py.generate_py_impl import generate_py
from rosidl_generator_type_description import generate_type_hash
from rosidl_typesupport_c import generate_c as generate_dispatch
from rosidl_typesupport_fastrtps_c import generate_typesupport_fastrtps_c
from rosidl_typesupport_introspection_c import generate_c as generate_introspection

_KINDS: Final = ("msg", "srv", "action")
_FAST: Final = "rosidl_typesupport_fastrtps_c"
_INTROSPECTION: Final = "rosidl_typesupport_introspection_c"
_DISPATCH: Final = "rosidl_typesupport_c"
_WHEELS: Final = Path(sys.prefix)
_INCLUDED: Final = re.compile(r'#include "(\w+)/(?:msg|srv|action)/')
# -w: warnings are the generators' business, and the headers ask for the macro
_COMPILE: Final = ("-O1", "-fPIC", "-w", "-DRCUTILS_ENABLE_FAULT_INJECTION=0")
_RUNTIME: Final = (
    *(_FAST, "rosidl_typesupport_fastrtps_cpp", _INTROSPECTION, _DISPATCH),
    *("rosidl_runtime_c", "rcutils", "rmw", "fastcdr"),
)
# the libraries of other packages that a package's code calls
_PARTS: Final = ("rosidl_generator_c", "rosidl_generator_py", _DISPATCH, _FAST, _INTROSPECTION)


class _Generator(NamedTuple):
    """A generator and the library that its code becomes part of."""

    name: str
    run: Callable[[str], Any]
    library: str


_GENERATORS: Final = (
    _Generator("rosidl_generator_c", generate_c, _FAST),
    _Generator(_FAST, generate_typesupport_fastrtps_c, _FAST),
    _Generator(_DISPATCH, lambda path: generate_dispatch(path, [_FAST, _INTROSPECTION]), _FAST),
    _Generator(_INTROSPECTION, generate_introspection, _INTROSPECTION),
    _Generator("rosidl_generator_py", lambda path: generate_py(path, [_DISPATCH]), _DISPATCH),
)


def build(package: str, source: Path, prefix: Path) -> None:
    """Build the package whose definitions lie in *source*. Add it to ``share`` and ``python``.

    Raises:
        subprocess.CalledProcessError: gcc refuses.
    """
    share = prefix / "share" / package
    target = prefix / "python" / package
    shutil.copytree(source, share)
    target.mkdir(parents=True)
    with tempfile.TemporaryDirectory() as scratch:
        trees = {g.library: Path(scratch) / g.library / package for g in _GENERATORS}
        _generate(package, share, trees)
        compiled = _compile(package, trees)
        others = _dependencies(package, trees)
        libraries: list[Path] = []
        for name in (_FAST, _INTROSPECTION):
            library = target / f"lib{package}__{name}.so"
            _link(library, [*compiled[name], *libraries], others)
            libraries.append(library)
        suffix = sysconfig.get_config_var("EXT_SUFFIX")
        extension = target / f"{package}_s__{_DISPATCH}{suffix}"
        _link(extension, [*compiled[_DISPATCH], *libraries], others)
        for path in trees[_DISPATCH].rglob("*.py"):
            copy = target / path.relative_to(trees[_DISPATCH])
            copy.parent.mkdir(exist_ok=True)
            shutil.copy(path, copy)
    (target / "__init__.py").touch()


def _generate(package: str, share: Path, trees: dict[str, Path]) -> None:
    """Write the code, and REP-2011 descriptions next to the definitions in *share*."""
    written = [path for kind in _KINDS for path in sorted(share.glob(f"{kind}/*.idl"))]
    converted = [path for kind in _KINDS for path in sorted(share.glob(f"{kind}/*.{kind}"))]
    found = [*written, *converted]
    idls = [path.relative_to(share).with_suffix(".idl") for path in found]
    for path in converted:
        convert_to_idl(share, package, path.relative_to(share), share)
    arguments = {
        "package_name": package,
        "idl_tuples": [f"{share}:{idl}" for idl in idls],
        "ros_interface_files": [str(path) for path in found],
        "ros_interface_dependencies": [],
        "target_dependencies": [],
        "include_paths": [f"{path.name}:{path}" for path in (_WHEELS / "share").iterdir()],
        "type_description_tuples": [f"{idl}:{share / idl.with_suffix('.json')}" for idl in idls],
    }

    def run(name: str, generate: Callable[[str], Any], output: Path) -> None:
        templates = _WHEELS / "share" / name / "resource"
        called = arguments | {"output_dir": str(output), "template_dir": str(templates)}
        with tempfile.NamedTemporaryFile("w", suffix=".json") as file:
            json.dump(called, file)
            file.flush()
            generate(file.name)
        visibility = templates / f"{name}__visibility_control.h.in"
        if visibility.is_file():
            text = visibility.read_text().replace("@PROJECT_NAME_UPPER@", package.upper())
            header = output / "msg" / visibility.stem
            header.write_text(text.replace("@PROJECT_NAME@", package))

    run("rosidl_generator_type_description", generate_type_hash, share)
    for generator in _GENERATORS:
        run(generator.name, generator.run, trees[generator.library])


def _compile(package: str, trees: dict[str, Path]) -> dict[str, list[Path]]:
    """Compile all sources, and return the object files of each library."""
    headers = [tree.parent for tree in trees.values()]
    headers += [_WHEELS / "include", *(_WHEELS / "include").iterdir()]
    headers += [Path(sysconfig.get_path("include")), Path(np.get_include())]
    flags = [*_COMPILE, f"-DROSIDL_GENERATOR_C_BUILDING_DLL_{package}"]
    flags += [f"-I{path}" for path in headers]

    def compile_one(source: Path) -> Path:
        compiled = source.with_suffix(f"{source.suffix}.o")
        gcc = ("gcc", "-std=gnu11") if source.suffix == ".c" else ("g++", "-std=c++17")
        _call(*gcc, *flags, "-c", source, "-o", compiled)
        return compiled

    with ThreadPoolExecutor() as workers:
        return {
            name: list(workers.map(compile_one, [*tree.rglob("*.c"), *tree.rglob("*.cpp")]))
            for name, tree in trees.items()
        }


def _dependencies(package: str, trees: dict[str, Path]) -> list[str]:
    """Name the libraries of the other packages whose types this one uses."""
    files = [path for tree in trees.values() for path in tree.rglob("*")]
    sources = [path.read_text() for path in files if path.suffix in {".c", ".cpp", ".h"}]
    packages = {found for text in sources for found in _INCLUDED.findall(text)} - {package}
    names = [f"{other}__{part}" for other in sorted(packages) for part in _PARTS]
    return [name for name in names if (_WHEELS / "lib" / f"lib{name}.so").is_file()]


def _link(target: Path, files: Sequence[Path], libraries: Sequence[str]) -> None:
    """Link a library that finds its neighbours next to it."""
    names = [f"-l{name}" for name in (*libraries, *_RUNTIME)]
    beside = f"-Wl,-soname,{target.name},-rpath,$ORIGIN,--no-as-needed"
    _call("g++", "-shared", beside, "-o", target, *files, f"-L{_WHEELS / 'lib'}", *names)


def _call(*command: str | Path) -> None:
    subprocess.run(command, check=True)
