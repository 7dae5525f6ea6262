# SPDX-License-Identifier: Apache-2.0
"""The package's pages and the tutorial: every example in C# compiles against the package."""

import re
from pathlib import Path

import pytest

from tests.unity import mono, own_messages, package

TUTORIAL = package.PACKAGE.parent / "docs/tutorials/unity.md"
PAGES = [*sorted((package.PACKAGE / "Documentation~").glob("*.md")), TUTORIAL]
EXAMPLES = [
    pytest.param(example, id=f"{page.stem}-{number}")
    for page in PAGES
    for number, example in enumerate(
        re.findall(r"^```csharp\n(.*?)^```$", page.read_text(), re.DOTALL | re.MULTILINE)
    )
]

pytestmark = pytest.mark.skipif(bool(mono.missing()), reason=mono.missing())


@pytest.mark.parametrize("example", EXAMPLES)
def test_example_compiles(example: str, tmp_path: Path) -> None:
    target = package.EDITOR.with_everything()
    references = [
        package.stub("UnityEngine"),
        package.compiled("Ros2Gateway.Core", target),
        package.compiled("Ros2Gateway.Unity", target),
        own_messages.assembly(target),
    ]
    source = tmp_path / "Example.cs"
    source.write_text(example)
    mono.compile_assembly("Example", [source], references=references, options=["-nowarn:0219,0649"])


def test_every_link_leads_somewhere() -> None:
    for page in [package.PACKAGE / "README.md", *PAGES]:
        for target in re.findall(r"\]\(([^)#]+)\)", page.read_text()):
            assert (page.parent / target).exists(), f"{page.name}: {target}"
