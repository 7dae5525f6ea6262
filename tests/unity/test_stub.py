# SPDX-License-Identifier: Apache-2.0
"""The stub of Unity's assemblies offers what members.txt lists, and nothing that Unity has not."""

import subprocess

import pytest

from tests.unity import mono, package

MEMBERS = package.STUB / "members.txt"

pytestmark = pytest.mark.skipif(bool(mono.missing()), reason=mono.missing())


def listed() -> list[str]:
    lines = MEMBERS.read_text().splitlines()
    return [line.removesuffix(" ?") for line in lines if line and not line.startswith("#")]


def surface(*binaries: mono.Binary) -> list[str]:
    program = mono.compile_assembly("surface.exe", sorted(package.SURFACE.glob("*.cs")))
    done = subprocess.run(
        mono.command(program, *(str(binary.path) for binary in binaries)),
        env=mono.environment(program, *binaries),
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.splitlines()


def test_stub_offers_what_is_listed_and_nothing_else():
    offered = surface(*package.stubs())
    assert sorted(set(offered) - set(listed())) == [], "compare with Unity's, then list it"
    assert sorted(set(listed()) - set(offered)) == [], "not in the stub any more"


def test_an_invented_member_is_noticed(tmp_path):
    source = tmp_path / "Invented.cs"
    source.write_text(
        "namespace UnityEngine { public class Invented { public int Magic(float f) { return 1; } }}"
    )
    offered = surface(mono.compile_assembly("Invented", [source]))
    assert "UnityEngine.Invented { int Magic(float) }" in offered
    assert not set(offered) & set(listed())


def test_list_is_sorted_and_each_member_is_listed_once():
    assert listed() == sorted(set(listed()))
