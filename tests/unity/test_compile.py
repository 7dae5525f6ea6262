# SPDX-License-Identifier: Apache-2.0
"""Every assembly compiles for every target, with and without the optional packages."""

from dataclasses import replace

import pytest

from tests.unity import mono, package
from tests.unity.package import EDITOR, TARGETS, AssemblyDefinition

pytestmark = pytest.mark.skipif(bool(mono.missing()), reason=mono.missing())

VARIANTS = [
    *(variant for target in TARGETS for variant in (target, target.with_everything())),
    replace(EDITOR.with_everything(), legacy_input=False, name="editor-input-system-only"),
    replace(EDITOR, legacy_input=False, name="editor-without-input"),
]


COMPILED = [
    pytest.param(name, target, id=f"{name}-{target}")
    for name, definition in package.assembly_definitions().items()
    for target in VARIANTS
    if definition.applies_to(target)
]


@pytest.mark.parametrize(("name", "target"), COMPILED)
def test_assembly_compiles(name, target):
    assert package.compiled(name, target).path.exists()


@pytest.mark.parametrize("name", ["Ros2Gateway.Core", "Ros2Gateway.Unity", "Ros2Gateway.Editor"])
def test_every_public_member_has_a_summary(name):
    assert package.undocumented(name) == ""


def test_core_sees_no_engine():
    assert not package.assembly_definitions()["Ros2Gateway.Core"].engine


@pytest.mark.parametrize("target", VARIANTS, ids=str)
def test_editor_code_is_for_the_editor_only(target):
    editor = package.assembly_definitions()["Ros2Gateway.Editor"]
    assert editor.applies_to(target) == (target.platform == "Editor")


def test_optional_packages_define_their_symbols():
    unity = package.assembly_definitions()["Ros2Gateway.Unity"]
    assert "ROS2GATEWAY_INPUT_SYSTEM" not in unity.defines(package.ANDROID)
    assert "ROS2GATEWAY_INPUT_SYSTEM" in unity.defines(package.ANDROID.with_everything())


def test_defines_are_those_of_the_target():
    defines = package.WEBGL.all_defines()
    assert {"UNITY_WEBGL", "ENABLE_IL2CPP", "UNITY_2021_3_OR_NEWER"} <= set(defines)
    assert {"UNITY_EDITOR", "ENABLE_MONO", "UNITY_6000_0_OR_NEWER"}.isdisjoint(defines)


def test_sources_of_a_nested_assembly_are_not_the_outer_ones(tmp_path):
    for folder in ("", "Inner", "Plain", "Hidden~"):
        (tmp_path / folder).mkdir(exist_ok=True)
        (tmp_path / folder / "A.cs").touch()
    for folder in ("", "Inner"):
        (tmp_path / folder / f"My{folder}.asmdef").write_text('{"name": "My"}')
    outer = AssemblyDefinition.read(tmp_path / "My.asmdef")
    assert outer.sources() == [tmp_path / "A.cs", tmp_path / "Plain" / "A.cs"]
