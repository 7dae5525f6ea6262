# SPDX-License-Identifier: Apache-2.0
"""Each page's examples in C# compile against the packages that its reader has."""

import re
from pathlib import Path

import pytest

from tests.unity import mono, own_messages, package
from tests.unity.pages import PAGES, installed_for

PROGRAMS = "outside-unity"  # whose examples are programs: see test_dotnet.py
EXAMPLES = [
    pytest.param(page, example, id=f"{page.stem}-{number}")
    for page in PAGES
    if page.stem != PROGRAMS
    for number, example in enumerate(
        re.findall(r"^```csharp\n(.*?)^```$", page.read_text(), re.DOTALL | re.MULTILINE)
    )
]

pytestmark = pytest.mark.skipif(bool(mono.missing()), reason=mono.missing())


@pytest.mark.parametrize(("page", "example"), EXAMPLES)
def test_example_compiles(page: Path, example: str, tmp_path: Path) -> None:
    target = package.EDITOR.with_everything()
    references = [
        package.stub("UnityEngine"),
        *package.libraries(target, *installed_for(page)),
        own_messages.assembly(target),
    ]
    source = tmp_path / "Example.cs"
    source.write_text(example)
    mono.compile_assembly(
        "Example", [source], references=references, suppressed=["CS0219", "CS0649"]
    )


def test_every_link_leads_somewhere() -> None:
    for page in [*package.HOME.glob("*/README.md"), *PAGES]:
        for target in re.findall(r"\]\(([^)#]+)\)", page.read_text()):
            assert (page.parent / target).exists(), f"{page.name}: {target}"
