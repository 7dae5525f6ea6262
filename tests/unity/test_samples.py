# SPDX-License-Identifier: Apache-2.0
"""The demonstrations run: their scenes build themselves, and drive the simulated robot."""

import json
from functools import cache
from pathlib import Path

import pytest

from tests.unity import csharp, mono, package
from tests.unity.csharp import IN_EDITOR
from tests.unity.mono import Binary

SAMPLES = [
    f"Ros2Gateway.Samples.{name}" for name in ("Topics", "Teleoperation", "XrTarget", "Robot")
]

_SOURCES = Path(__file__).parent / "sample_tests"
_STUBS = ("UnityEngine", "UnityEngine.TestRunner", "Unity.InputSystem")


@cache
def binary() -> Binary:
    """Compile the samples' tests, which are not part of the package: samples are copied from it."""
    toolkit = package.stub("Unity.XR.Interaction.Toolkit")
    return mono.compile_assembly(
        "SampleTests",
        sorted(_SOURCES.glob("*.cs")),
        references=[
            mono.nunit(),
            *map(package.stub, _STUBS),
            toolkit,
            *package.libraries(IN_EDITOR),
            *(package.compiled(name, IN_EDITOR) for name in SAMPLES),
        ],
    )


@pytest.mark.parametrize("tests", csharp.parameters_of_compiled("samples", binary))
def test_samples(tests, check_csharp):
    check_csharp(tests)


def test_every_sample_is_offered_by_its_package_and_says_how_to_start_it():
    offers = [
        (one, sample)
        for one in package.PACKAGES
        for sample in json.loads((one / "package.json").read_text()).get("samples", [])
    ]
    folders = sorted(path for path in package.HOME.glob("*/Samples~/*") if path.is_dir())
    assert sorted(one / sample["path"] for one, sample in offers) == folders
    assert all(sample["displayName"] and sample["description"] for _, sample in offers)
    assert all((folder / "README.md").exists() for folder in folders)
