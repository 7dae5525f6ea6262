# SPDX-License-Identifier: Apache-2.0
"""The stage's own C# tests, which need none of the package."""

from functools import cache
from pathlib import Path
from typing import Any

import pytest

from tests.unity import csharp, mono, package
from tests.unity.csharp import CSharpTest
from tests.unity.mono import Binary

_SOURCES = Path(__file__).parent / "stage_tests"


@cache
def binary() -> Binary:
    """Compile them."""
    names = ("UnityEngine", "UnityEngine.TestRunner", "UnityEngine.UI")
    return mono.compile_assembly(
        "StageTests",
        sorted(_SOURCES.glob("*.cs")),
        references=[mono.nunit(), *map(package.stub, names)],
    )


def parameters() -> list[Any]:
    """Return those that must pass, as parameters for pytest."""
    if reason := mono.missing():
        return [pytest.param([], id="stage", marks=pytest.mark.skip(reason=reason))]
    return csharp.by_class(test for test in csharp.tests_of(binary()) if not test.categories)


def test(name: str) -> CSharpTest:
    """Return one by its name, also one that must fail."""
    return CSharpTest(name, binary())
