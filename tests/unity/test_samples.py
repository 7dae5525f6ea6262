# SPDX-License-Identifier: Apache-2.0
"""The demonstrations run: their scenes build themselves, and drive the simulated robot."""

import json
from functools import cache
from pathlib import Path

import pytest

from tests.unity import csharp, mono, package
from tests.unity.csharp import IN_EDITOR
from tests.unity.mono import Binary

SAMPLES = ("Ros2Gateway.Samples.Teleoperation", "Ros2Gateway.Samples.XrTarget")

_SOURCES = Path(__file__).parent / "sample_tests"
_STUBS = ("UnityEngine", "UnityEngine.TestRunner", "Unity.InputSystem")


@cache
def binary() -> Binary:
    """Compile the samples' tests, which are not part of the package: samples are copied from it."""
    names = ("Ros2Gateway.Core", "Ros2Gateway.Unity", *SAMPLES)
    toolkit = package.stub("Unity.XR.Interaction.Toolkit")
    return mono.compile_assembly(
        "SampleTests",
        sorted(_SOURCES.glob("*.cs")),
        references=[
            mono.nunit(),
            *map(package.stub, _STUBS),
            toolkit,
            *(package.compiled(name, IN_EDITOR) for name in names),
        ],
    )


@pytest.mark.parametrize("tests", csharp.parameters_of_compiled("samples", binary))
def test_samples(tests, check_csharp):
    check_csharp(tests)


def test_every_sample_is_offered_by_the_package_and_says_how_to_start_it():
    offered = json.loads((package.PACKAGE / "package.json").read_text())["samples"]
    folders = sorted(path for path in (package.PACKAGE / "Samples~").iterdir() if path.is_dir())
    assert sorted(package.PACKAGE / sample["path"] for sample in offered) == folders
    assert all(sample["displayName"] and sample["description"] for sample in offered)
    assert all((folder / "README.md").exists() for folder in folders)
