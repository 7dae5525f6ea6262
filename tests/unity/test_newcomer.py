# SPDX-License-Identifier: Apache-2.0
"""A new user follows the tutorial, in a project with what it names alone."""

import re
import tempfile
from functools import cache
from pathlib import Path

import pytest

from tests.unity import compiler, csharp, mono, package
from tests.unity.csharp import IN_EDITOR
from tests.unity.mono import Binary
from tests.unity.pages import TUTORIAL, installed_for

_SOURCES = Path(__file__).parent / "newcomer_tests"


@cache
def binary() -> Binary:
    """Compile the tutorial's script and the test that plays its scene."""
    scripts = re.findall(r"^```csharp\n(.*?)^```$", TUTORIAL.read_text(), re.DOTALL | re.MULTILINE)
    compiler.CACHE.mkdir(parents=True, exist_ok=True)
    script = compiler.CACHE / "Odometer.cs"
    with tempfile.TemporaryDirectory(dir=compiler.CACHE) as own:  # other workers may read it now
        written = Path(own) / script.name
        written.write_text(scripts[0])
        written.replace(script)
    installed = installed_for(TUTORIAL)
    editors = [
        package.compiled(name, IN_EDITOR)
        for name, one in package.assembly_definitions().items()
        if any(folder / "Editor" in one.path.parents for folder in installed)
    ]
    return mono.compile_assembly(
        "NewcomerTests",
        [script, *sorted(_SOURCES.glob("*.cs"))],
        references=[
            mono.nunit(),
            *map(package.stub, ("UnityEngine", "UnityEditor", "UnityEngine.TestRunner")),
            *package.libraries(IN_EDITOR, *installed),
            *editors,
        ],
    )


@pytest.mark.parametrize("tests", csharp.parameters_of_compiled("newcomer", binary))
def test_newcomer(tests, check_csharp):
    check_csharp(tests)


def test_the_tutorial_names_two_packages() -> None:
    assert installed_for(TUTORIAL) == {package.CLIENT, package.DISPLAYS}
