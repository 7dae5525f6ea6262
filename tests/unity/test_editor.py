# SPDX-License-Identifier: Apache-2.0
"""The Unity editor: tests of the package, and someone who clicks in the inspectors."""

from functools import cache
from pathlib import Path

import pytest

from tests.unity import csharp, mono, package
from tests.unity.csharp import IN_EDITOR
from tests.unity.mono import Binary

_SOURCES = Path(__file__).parent / "editor_tests"


@cache
def binary() -> Binary:
    """Compile the tests that need the stage's own inspector, which Unity has not."""
    return mono.compile_assembly(
        "EditorTests",
        sorted(_SOURCES.glob("*.cs")),
        references=[
            mono.nunit(),
            *map(package.stub, ("UnityEngine", "UnityEditor", "UnityEngine.TestRunner")),
            *package.libraries(IN_EDITOR),
            package.compiled("Ros2Gateway.Editor", IN_EDITOR),
        ],
    )


EDITOR_TESTS = [
    parameter
    for part in ("", "Displays.", "Robots.")
    for parameter in csharp.parameters(f"Ros2Gateway.{part}Editor.Tests")
]


@pytest.mark.parametrize("tests", EDITOR_TESTS)
def test_editor(tests, check_csharp):
    check_csharp(tests)


@pytest.mark.parametrize("tests", csharp.parameters_of_compiled("clicks", binary))
def test_clicks(tests, check_csharp):
    check_csharp(tests)
