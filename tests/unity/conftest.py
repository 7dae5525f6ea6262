# SPDX-License-Identifier: Apache-2.0
"""The common parts of the package's tests: a live gateway, a simulated robot, and C# under Mono."""

import contextlib
import os
import struct
from collections.abc import AsyncIterator, Callable, Iterator, Mapping, Sequence
from functools import partial
from urllib.parse import urlsplit

import pytest
from geometry_msgs.msg import Twist, TwistStamped

from gateway.sources.recording.options import DEMO
from gateway.transport.lan_discovery import FoundGateway, answering_questions
from tests.clients.robot import Robot
from tests.demonstration import demonstration
from tests.gateway_process import GatewayProcess, gateway_process
from tests.sources.outside import Outside
from tests.unity import csharp, mono
from tests.unity.background import in_background
from tests.unity.bases import CHANGING, STAMPED, Base
from tests.unity.csharp import CSharpTest
from tests.unity.rogue import RED_DAE, deaf, rogue


@pytest.fixture(scope="package")  # other tests in this domain want to be alone with their robot
def gateway(tmp_path_factory: pytest.TempPathFactory) -> Iterator[GatewayProcess]:
    """``ros2-gateway demo`` on a free port, whose machine has a package with two meshes more."""
    prefix = tmp_path_factory.mktemp("prefix")
    meshes = prefix / "share/gateway_tests/meshes"
    meshes.mkdir(parents=True)
    (meshes.parent / "package.xml").write_text("<package/>")
    (meshes / "strip.stl").write_bytes(_strip(2000))
    (meshes / "red.dae").write_text(RED_DAE)
    prefixes = os.pathsep.join(filter(None, [os.environ.get("AMENT_PREFIX_PATH"), str(prefix)]))
    # recordings are files of the user
    environment = ("env", f"AMENT_PREFIX_PATH={prefixes}", f"XDG_DATA_HOME={prefix}")
    patient = demonstration(module="tests.unity.patient_demo", before=environment)
    with in_background(patient) as process:
        yield process


def _strip(count: int) -> bytes:
    """Return a binary STL of *count* triangles, each of which begins one metre further along x."""
    triangles = (
        struct.pack("<12fH", *(0, 0, 1), *(x, 0, 0), *(x + 1, 0, 0), *(x, 1, 0), 0)
        for x in range(count)
    )
    return bytes(80) + struct.pack("<I", count) + b"".join(triangles)


@pytest.fixture(scope="package")
def recording() -> Iterator[GatewayProcess]:
    """A gateway that plays the recording of the simulated robot again and again."""
    with in_background(gateway_process("play", str(DEMO), "--loop")) as process:
        yield process


@pytest.fixture(scope="package")
def servers(gateway: GatewayProcess, recording: GatewayProcess) -> Iterator[dict[str, str]]:
    """The environment of a C# test: the addresses of the gateway and of misbehaving servers."""
    with (
        in_background(rogue(gateway.url)) as rogue_url,
        in_background(deaf()) as deaf_url,
        in_background(_findable(gateway.url)),
    ):
        outside = Outside("unity_tests")
        robot = Robot(outside)
        robot.provide_fibonacci("/fibonacci")
        other = Outside("unity_tests_other")
        Base(outside.node, STAMPED, TwistStamped).take()
        Base(outside.node, CHANGING, TwistStamped)
        Base(other.node, CHANGING, Twist)
        yield {
            "ROS2GATEWAY_TEST_URL": gateway.url,
            "ROS2GATEWAY_RECORDING_URL": recording.url,
            "ROS2GATEWAY_ROGUE_URL": rogue_url,
            "ROS2GATEWAY_DEAF_URL": deaf_url,
        }
        robot.close()
        other.close()
        outside.close()


@contextlib.asynccontextmanager
async def _findable(url: str) -> AsyncIterator[None]:
    """Let the gateway be found, which does not listen on all networks: tests stay on loopback."""
    port = urlsplit(url).port
    assert port is not None
    with answering_questions(
        FoundGateway("4f1d", "robot7", port, "/", False, None, needs_token=False, version="0.1.0")
    ):
        yield


@pytest.fixture(scope="session")
def mono_runner() -> Iterator[csharp.Runner]:
    """Runs C# tests as Unity's editor and desktop players do."""
    runner = csharp.Runner()
    yield runner
    runner.close()


@pytest.fixture(scope="session")
def ahead_of_time_runner() -> Iterator[csharp.Runner]:
    """Runs C# tests without a JIT compiler, as on Android."""
    if reason := mono.missing_ahead_of_time():
        pytest.skip(reason)
    runner = csharp.Runner(full_aot=True)
    yield runner
    runner.close()


@pytest.fixture
def check_csharp(
    request: pytest.FixtureRequest, mono_runner: csharp.Runner
) -> Callable[[Sequence[CSharpTest]], None]:
    """Run C# tests, with a live gateway those that need one."""
    return lambda tests: mono_runner.check_all(tests, partial(_environment, request))


@pytest.fixture
def check_ahead_of_time(
    request: pytest.FixtureRequest, ahead_of_time_runner: csharp.Runner
) -> Callable[[Sequence[CSharpTest]], None]:
    """Like `check_csharp`, for tests that are compiled ahead of time."""
    return lambda tests: ahead_of_time_runner.check_all(tests, partial(_environment, request))


def _environment(request: pytest.FixtureRequest, test: CSharpTest) -> Mapping[str, str]:
    if not test.needs_gateway:
        return {}
    servers: dict[str, str] = request.getfixturevalue("servers")
    return servers
