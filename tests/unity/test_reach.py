# SPDX-License-Identifier: Apache-2.0
"""A build has the messages that its code refers to. All, only where types are named by text."""

import re
import subprocess
from dataclasses import replace
from pathlib import Path

import pytest

from schemas.generate.catalogue import Catalogue
from schemas.generate.csharp_text import ClassNames, namespace
from schemas.installed import InstalledDefinitions
from schemas.table import Table
from tests.unity import csharp, mono, package
from tests.unity.csharp import IN_EDITOR
from tests.unity.mono import Binary
from tests.unity.package import STANDALONE

pytestmark = pytest.mark.skipif(bool(mono.missing()), reason=mono.missing())

DEFINE = "ROS2GATEWAY_REGISTERED_MESSAGES"
REGISTERED = replace(STANDALONE, name="registered", defines=(*STANDALONE.defines, DEFINE))
REGISTERED_IN_EDITOR = replace(
    IN_EDITOR, name="editor-registered", defines=(*IN_EDITOR.defines, DEFINE)
)
TYPED = """\
using Ros2Gateway;
using Ros2Gateway.Messages;
using Ros2Gateway.Messages.GeometryMsgs;
using Ros2Gateway.Messages.StdSrvs;

public static class Typed
{
    public static void Use(GatewayClient client)
    {
        client.Subscribe<TwistMsg>("/cmd_vel", twist => { });
        client.CallService<SetBoolResponse>("/power", null, reply => { });
        MessageCatalogue.Register("own_msgs/msg/Thing", () => new DynamicMessage(""));
    }
}
"""
MESSAGES = "Ros2Gateway.Messages."


def reached(*roots: Binary) -> set[str]:
    """Return the classes of messages that the code of some assemblies refers to."""
    program = mono.compile_assembly("reach.exe", [Path(__file__).parent / "reach" / "Program.cs"])
    done = subprocess.run(
        mono.command(program, *(str(root.path) for root in roots)),
        env=mono.environment(program, *roots),
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return {line.removeprefix(MESSAGES) for line in done.stdout.splitlines()}


@pytest.fixture(scope="module")
def catalogue() -> Catalogue:
    return Catalogue.of(Table.load(), InstalledDefinitions())


def class_of(name: str) -> str:
    return f"{namespace(name.split('/')[0])}.{ClassNames.own(name)}"


def mentioned(catalogue: Catalogue) -> set[str]:
    """Return the classes that the package's own code mentions, and those that these nest."""
    runtime = package.PACKAGE / "Runtime"
    sources = [p for p in runtime.rglob("*.cs") if p.parent.name != "Generated"]
    words = set(re.findall(r"\w+", "".join(path.read_text("utf-8") for path in sources)))
    by_name = {one.name: one for one in catalogue.messages()}
    found: set[str] = set()
    waiting = [name for name in by_name if ClassNames.own(name) in words]
    while waiting:
        name = waiting.pop()
        if name not in found:
            found.add(name)
            waiting += by_name[name].nested()
    return {class_of(name) for name in found}


def test_a_program_with_types_refers_to_these_alone(tmp_path):
    source = tmp_path / "Typed.cs"
    source.write_text(TYPED)
    core = package.compiled("Ros2Gateway.Core", STANDALONE)
    typed = mono.compile_assembly("Typed", [source], references=[core])
    its_own = {"GeometryMsgs.TwistMsg", "GeometryMsgs.Vector3Msg", "StdSrvs.SetBoolResponse"}
    # the answer of `lookup_transform`
    the_clients = {
        "GeometryMsgs.TransformMsg",
        "GeometryMsgs.QuaternionMsg",
        "BuiltinInterfaces.TimeMsg",
    }
    assert reached(typed) == its_own | the_clients


def test_components_refer_to_all_messages_as_a_scene_may_name_any(catalogue):
    everything = {class_of(one.name) for one in catalogue.messages()}
    assert reached(package.compiled("Ros2Gateway.Unity", STANDALONE)) == everything


def test_with_registered_messages_alone_components_refer_to_what_the_package_uses(catalogue):
    found = reached(package.compiled("Ros2Gateway.Unity", REGISTERED))
    used = mentioned(catalogue)
    assert {"SensorMsgs.LaserScanMsg", "GeometryMsgs.TwistMsg", "StdMsgs.HeaderMsg"} <= found
    assert found <= used
    assert len(used) < len(catalogue.messages()) / 2


LIVE = [
    parameter
    for parameter in csharp.parameters("Ros2Gateway.Unity.Tests", REGISTERED_IN_EDITOR)
    if "LiveDisplays" in parameter.id or parameter.id == "compiles"
]


@pytest.mark.parametrize("tests", LIVE)
def test_displays_have_their_classes_then_too(tests, check_csharp):
    check_csharp(tests)
