# SPDX-License-Identifier: Apache-2.0
"""Unity's compiler takes every assembly for every target, as C# 9, without a warning."""

import re
from dataclasses import replace
from pathlib import Path

import pytest

from tests.unity import mono, package
from tests.unity.compiler import CompileError
from tests.unity.package import ANDROID, EDITOR, TARGETS, WEBGL, AssemblyDefinition

pytestmark = pytest.mark.skipif(bool(mono.missing()), reason=mono.missing())

VARIANTS = [
    *(variant for target in TARGETS for variant in (target, target.with_everything())),
    replace(EDITOR.with_everything(), legacy_input=False, name="editor-input-system-only"),
    replace(EDITOR, legacy_input=False, name="editor-without-input"),
]
WITH_NET = [one.with_net() for one in (EDITOR.with_everything(), ANDROID, WEBGL)]
CSHARP_9 = Path(__file__).parent / "csharp9"


def is_public(name):
    return not name.endswith(".Tests") and "Samples" not in name


COMPILED = [
    pytest.param(name, target, id=f"{name}-{target}", marks=[pytest.mark.long] * target.net)
    for name, definition in package.assembly_definitions().items()
    for target in (*VARIANTS, *WITH_NET)
    if definition.applies_to(target)
]


@pytest.mark.parametrize(("name", "target"), COMPILED)
def test_assembly_compiles(name, target):
    assert package.compiled(name, target).path.exists()


@pytest.mark.parametrize("name", [n for n in package.assembly_definitions() if is_public(n)])
def test_every_public_member_has_a_summary(name):
    assert package.complaints(name, documented=True) == ""


@pytest.mark.parametrize("name", package.assembly_definitions())
def test_sources_follow_the_editorconfig(name):
    assert package.complaints(name, documented=False) == ""


def test_a_warning_and_each_rule_of_style_is_told(tmp_path):
    source = tmp_path / "Old.cs"
    source.write_text((CSHARP_9 / "Old.cs").read_text())
    style = tmp_path / ".editorconfig"
    style.write_text(package.STYLE.read_text())
    with pytest.raises(CompileError) as told:
        mono.compile_assembly("Old", [source], style=style)
    expected = re.findall(r"// (\w+)$", source.read_text(), re.MULTILINE)
    assert sorted(re.findall(r"(?:error|hidden) (\w+):", str(told.value))) == sorted(expected)
    rules = re.findall(r"dotnet_diagnostic\.(\w+)\.", package.STYLE.read_text())
    assert set(rules) < set(expected)


def test_feedback_of_a_goal_is_for_await_foreach():
    target = ANDROID.with_net()
    client = package.compiled("Ros2Gateway.Core", target).closure()
    source = [CSHARP_9 / "AwaitForeach.cs"]
    framework = target.framework()
    assert mono.compile_assembly("Sample", source, references=[*client], framework=framework)


def test_assemblies_for_programs_outside_unity_see_no_engine():
    engine = {name for name, one in package.assembly_definitions().items() if one.engine}
    plain = {"Json", "Core", "Displays.Core", "Robots.Core"}
    assert engine.isdisjoint({f"Ros2Gateway.{name}" for name in plain})


def test_a_package_gets_nothing_beyond_its_declared_dependencies():
    definition = package.assembly_definitions()["Ros2Gateway.Core"]
    greedy = replace(definition, references=("Ros2Gateway.Displays",))
    with pytest.raises(ValueError, match="Displays is not of a declared dependency"):
        package.referenced(greedy, EDITOR)
    assert package.installed_with(package.CLIENT) == {package.CLIENT}
    assert package.installed_with(package.DISPLAYS) == {package.CLIENT, package.DISPLAYS}


@pytest.mark.parametrize("target", VARIANTS, ids=str)
def test_editor_code_is_for_the_editor_only(target):
    for name in ("Editor", "Displays.Editor", "Robots.Editor"):
        editor = package.assembly_definitions()[f"Ros2Gateway.{name}"]
        assert editor.applies_to(target) == (target.platform == "Editor")


def test_optional_packages_define_their_symbols():
    unity = package.assembly_definitions()["Ros2Gateway.Displays"]
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
