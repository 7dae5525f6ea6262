# SPDX-License-Identifier: Apache-2.0
"""Play after Play in an editor that reloads nothing in between, and scripts reloaded in Play."""

from functools import cache
from pathlib import Path

import pytest

from tests.unity import csharp, mono, package
from tests.unity.csharp import IN_EDITOR
from tests.unity.mono import Binary

_SOURCES = Path(__file__).parent / "play_tests"


@cache
def binary() -> Binary:
    """Compile the tests that begin and end a Play, which none within Unity can."""
    return mono.compile_assembly(
        "PlayTests",
        sorted(_SOURCES.glob("*.cs")),
        references=[
            mono.nunit(),
            *map(package.stub, ("UnityEngine", "UnityEngine.TestRunner")),
            *package.libraries(IN_EDITOR),
        ],
    )


@pytest.mark.parametrize("tests", csharp.parameters_of_compiled("play", binary))
def test_play(tests, check_csharp):
    check_csharp(tests)
