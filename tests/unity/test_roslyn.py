# SPDX-License-Identifier: Apache-2.0
"""Unity's own compiler takes the package, as C# 9, and has no warning."""

from pathlib import Path

import pytest

from tests.unity import roslyn
from tests.unity.package import ANDROID, EDITOR, WEBGL, Target
from tests.unity.roslyn import Assembly

pytestmark = [
    pytest.mark.skipif(bool(roslyn.missing()), reason=roslyn.missing()),
    pytest.mark.timeout(roslyn.TIMEOUT_S),
]

CSHARP_9 = Path(__file__).parent / "csharp9"


@pytest.mark.long
@pytest.mark.parametrize("target", [EDITOR.with_everything(), ANDROID, WEBGL], ids=str)
def test_the_package_has_no_warning(target: Target) -> None:
    assert roslyn.diagnostics(roslyn.described(target)) == []


def test_feedback_of_a_goal_is_for_await_foreach() -> None:
    core = next(a for a in roslyn.described(ANDROID) if a.name == "Ros2Gateway.Core")
    sample = Assembly("Sample", (CSHARP_9 / "AwaitForeach.cs",), references=(core.name,))
    assert roslyn.diagnostics([core, sample]) == []


def test_a_warning_is_told(tmp_path: Path) -> None:
    source = tmp_path / "Unused.cs"
    source.write_text("class Unused { void Method() { int value; } record Of9(int Value); }")
    told = roslyn.diagnostics([Assembly("Unused", (source,))])
    assert [line.split("error ")[1].split(":")[0] for line in told] == ["CS0518", "CS0168"]
