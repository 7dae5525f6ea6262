# SPDX-License-Identifier: Apache-2.0
"""The C# tests of the packages, run as Unity's editor runs them, and compiled ahead of time."""

from typing import Any

import pytest

from tests.unity import csharp
from tests.unity.package import Target

pytestmark = pytest.mark.timeout(1800)  # the first test waits for the translation

CORE = ("Core", "Displays.Core", "Robots.Core")
UNITY = ("Unity", "Displays", "Robots")


def of(assemblies: tuple[str, ...], target: Target = csharp.IN_EDITOR) -> list[Any]:
    """Return the tests of some assemblies."""
    return [
        p for name in assemblies for p in csharp.parameters(f"Ros2Gateway.{name}.Tests", target)
    ]


@pytest.mark.parametrize("tests", of(CORE))
def test_core(tests, check_csharp):
    check_csharp(tests)


@pytest.mark.parametrize("tests", of(UNITY))
def test_components(tests, check_csharp):
    check_csharp(tests)


@pytest.mark.long
@pytest.mark.parametrize("tests", of(CORE, csharp.AHEAD_OF_TIME))
def test_core_ahead_of_time(tests, check_ahead_of_time):
    check_ahead_of_time(tests)


@pytest.mark.long
@pytest.mark.parametrize("tests", of(UNITY, csharp.AHEAD_OF_TIME))
def test_components_ahead_of_time(tests, check_ahead_of_time):
    check_ahead_of_time(tests)
