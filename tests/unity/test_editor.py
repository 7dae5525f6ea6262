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
    names = ("Ros2Gateway.Core", "Ros2Gateway.Unity", "Ros2Gateway.Editor")
    return mono.compile_assembly(
        "EditorTests",
        sorted(_SOURCES.glob("*.cs")),
        references=[
            mono.nunit(),
            *map(package.stub, ("UnityEngine", "UnityEditor", "UnityEngine.TestRunner")),
            *(package.compiled(name, IN_EDITOR) for name in names),
        ],
    )


@pytest.mark.parametrize("tests", csharp.parameters("Ros2Gateway.Editor.Tests"))
def test_editor(tests, check_csharp):
    check_csharp(tests)


@pytest.mark.parametrize("tests", csharp.parameters_of_compiled("clicks", binary))
def test_clicks(tests, check_csharp):
    check_csharp(tests)
