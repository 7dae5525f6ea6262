# SPDX-License-Identifier: Apache-2.0
"""The C# tests of the package, run as Unity's editor runs them, and compiled ahead of time."""

import pytest

from tests.unity import csharp

pytestmark = pytest.mark.timeout(1800)  # the first test waits for the translation


@pytest.mark.parametrize("tests", csharp.parameters("Ros2Gateway.Core.Tests"))
def test_core(tests, check_csharp):
    check_csharp(tests)


@pytest.mark.parametrize("tests", csharp.parameters("Ros2Gateway.Unity.Tests"))
def test_components(tests, check_csharp):
    check_csharp(tests)


@pytest.mark.long
@pytest.mark.parametrize("tests", csharp.parameters("Ros2Gateway.Core.Tests", csharp.AHEAD_OF_TIME))
def test_core_ahead_of_time(tests, check_ahead_of_time):
    check_ahead_of_time(tests)


@pytest.mark.long
@pytest.mark.parametrize(
    "tests", csharp.parameters("Ros2Gateway.Unity.Tests", csharp.AHEAD_OF_TIME)
)
def test_components_ahead_of_time(tests, check_ahead_of_time):
    check_ahead_of_time(tests)
