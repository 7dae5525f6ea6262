# SPDX-License-Identifier: Apache-2.0
"""A build has the messages that its code refers to: no catalogue refers to others."""

import re
import subprocess
from pathlib import Path

import pytest

from schemas.generate.catalogue import Catalogue
from schemas.generate.csharp_text import ClassNames, namespace
from schemas.installed import InstalledDefinitions
from schemas.table import Table
from tests.unity import mono, package
from tests.unity.mono import Binary
from tests.unity.package import STANDALONE

pytestmark = pytest.mark.skipif(bool(mono.missing()), reason=mono.missing())

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
        MessageCatalogue.Create("geometry_msgs/msg/Wrench");
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
    paths = (path for one in package.PACKAGES for path in (one / "Runtime").rglob("*.cs"))
    sources = [path for path in paths if path.parent.name != "Generated"]
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
    typed = mono.compile_assembly("Typed", [source], references=list(core.closure()))
    its_own = {"GeometryMsgs.TwistMsg", "GeometryMsgs.Vector3Msg", "StdSrvs.SetBoolResponse"}
    # the answer of `lookup_transform`
    the_clients = {
        "GeometryMsgs.TransformStampedMsg",
        "StdMsgs.HeaderMsg",
        "GeometryMsgs.TransformMsg",
        "GeometryMsgs.QuaternionMsg",
        "BuiltinInterfaces.TimeMsg",
    }
    assert reached(typed) == its_own | the_clients


def test_a_scene_of_topics_refers_to_the_clients_own_messages_alone():
    found = reached(package.compiled("Ros2Gateway.Unity", STANDALONE))
    assert "GeometryMsgs.TransformMsg" in found
    assert "SensorMsgs.CompressedImageMsg" in found  # the form of images
    assert len(found) < 10


@pytest.mark.parametrize("name", ["Thesis", "Displays", "Robots"])
def test_each_part_refers_to_the_messages_that_its_code_mentions(name, catalogue):
    found = reached(package.compiled(f"Ros2Gateway.{name}", STANDALONE))
    used = mentioned(catalogue)
    assert {"GeometryMsgs.TwistMsg" if name == "Thesis" else "StdMsgs.HeaderMsg"} <= found
    assert found <= used
    assert len(used) < len(catalogue.messages()) / 2


def test_components_make_every_class_known_that_they_cast_a_message_to():
    by_subscriber = {"PictureMsg", "CompressedImageMsg"}  # the forms in which images come
    for path in package.HOME.glob("*/Runtime/Unity/**/*.cs"):
        source = path.read_text("utf-8")
        known = {*re.findall(r"(?:Register|Display)<(\w+Msg)>", source), *by_subscriber}
        assert set(re.findall(r"message as (\w+Msg)\b", source)) <= known, path.name
