# SPDX-License-Identifier: Apache-2.0

import os
import subprocess
import sys
from pathlib import Path

import pytest

from gateway.sources.rclpy import fast_dds
from gateway.sources.rclpy.distro import distro

NAMES = ("FASTRTPS_DEFAULT_PROFILES_FILE", "FASTDDS_DEFAULT_PROFILES_FILE")
OURS, OURS_OF_3 = Path("/ours.xml"), Path("/ours3.xml")


@pytest.fixture(autouse=True)
def environment(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in NAMES:
        monkeypatch.setenv(name, "")  # so that what follows is undone
        monkeypatch.delenv(name)


@pytest.mark.parametrize(
    ("is_second", "found"), [(True, ["/ours.xml", None]), (False, [None, "/ours3.xml"])]
)
def test_each_generation_of_fast_dds_finds_its_profile(is_second, found, monkeypatch):
    monkeypatch.setattr(fast_dds, "is_second", lambda: is_second)
    with fast_dds.profile(OURS, OURS_OF_3):
        assert [os.environ.get(name) for name in NAMES] == found


def test_the_generation_is_that_of_the_distribution():
    assert fast_dds.is_second() == (distro() == "jazzy")


SPOKEN = """
from rclpy.context import Context
from rclpy.node import Node
from std_msgs.msg import Header

from gateway.sources.rclpy import fast_dds
from gateway.sources.rclpy.errors import creation
from gateway.sources.rclpy.made_types.classes import MadeTypes
from schemas.installed import InstalledDefinitions

with fast_dds.profile():
    context = Context()
    context.init(args=[])
    node = Node("quiet", context=context)
definitions = InstalledDefinitions()
made = MadeTypes().get(definitions.get("std_msgs/msg/String"), definitions)
with creation("topic /made"):
    node.create_publisher(made, "/made", 10)
node.create_publisher(Header, "/real", 10)
"""


def test_neither_the_profile_nor_a_made_type_makes_ros_complain():
    command = [sys.executable, "-c", SPOKEN]
    ended = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (ended.returncode, ended.stdout + ended.stderr) == (0, "")


SILENT = """
import resource

from rclpy.context import Context
from rclpy.node import Node

from gateway.sources.rclpy.stand_alone import StandAlone

with StandAlone("quiet", "/", None):
    print("silent until here", flush=True)
context = Context()
context.init(args=[])
resource.setrlimit(resource.RLIMIT_FSIZE, (0, resource.RLIM_INFINITY))
Node("loud", context=context)
"""


def test_fast_dds_reports_errors_except_that_there_is_to_be_no_shared_memory():
    command = [sys.executable, "-c", SILENT]
    ended = subprocess.run(command, capture_output=True, text=True, check=True)
    reported = ended.stdout + ended.stderr
    assert reported.startswith("silent until here")
    assert "Failed to create segment" in reported


@pytest.mark.parametrize("name", NAMES)
def test_a_profile_that_the_environment_names_stays(name, monkeypatch):
    monkeypatch.setenv(name, "/theirs.xml")
    with fast_dds.profile(OURS, OURS_OF_3):
        assert [os.environ.get(each) for each in NAMES if each != name] == [None]
        assert os.environ[name] == "/theirs.xml"
    assert os.environ[name] == "/theirs.xml"


def test_the_environment_is_as_before_afterwards():
    before = dict(os.environ)
    with pytest.raises(KeyError), fast_dds.profile(OURS, OURS_OF_3):
        raise KeyError
    assert dict(os.environ) == before
