# SPDX-License-Identifier: Apache-2.0
"""Messages that the package has not, generated into a project, compiled there, and in use."""

from functools import cache
from pathlib import Path

import pytest

from tests.unity import csharp, mono, package
from tests.unity.csharp import IN_EDITOR
from tests.unity.mono import Binary
from tests.unity.own_messages import assembly

_SOURCES = sorted((Path(__file__).parent / "own_messages_tests").glob("*.cs"))


@cache
def binary() -> Binary:
    """Compile the tests that use it."""
    scene = package.CLIENT / "Tests/Unity/DisplayScene.cs"
    return mono.compile_assembly(
        "OwnMessagesTests",
        [*_SOURCES, scene],
        references=[
            mono.nunit(),
            *map(package.stub, ("UnityEngine", "UnityEngine.TestRunner")),
            *package.libraries(IN_EDITOR),
            assembly(IN_EDITOR),
        ],
    )


@pytest.mark.skipif(bool(mono.missing()), reason=mono.missing())
@pytest.mark.parametrize("target", package.TARGETS, ids=str)
def test_the_assembly_compiles_for_every_target(target):
    assert assembly(target).path.exists()


@pytest.mark.parametrize("tests", csharp.parameters_of_compiled("own messages", binary))
def test_own_messages(tests, check_csharp):
    check_csharp(tests)
