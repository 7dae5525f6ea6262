# SPDX-License-Identifier: Apache-2.0
"""The doctor looks at an uplink: its router, who signs in there, and the name of the robot."""

import contextlib
import os
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

pytest.importorskip("zenoh")

from gateway.cli.doctor.finding import Finding
from gateway.cli.doctor.local_checks import CHECKS
from gateway.cli.doctor.machine import Machine
from gateway.config.model import Config
from gateway.relay.router import routing
from gateway.relay.router_file import checked
from tests.cli.doctor.one_check import TIMEOUT_S
from tests.cli.doctor.test_command import VERBS
from tests.gateway_process import gateway_process
from tests.sources.zenoh.authority import Authority
from tests.sources.zenoh.outside import client, free_port

PASSWORDS = {"r1": "password-of-r1", "r2": "password-of-r2"}


class Robot:
    """A robot whose uplink the doctor looks at."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.authority = Authority(folder, "authority")
        self.address = f"tls/127.0.0.1:{free_port()}"
        self.port = free_port()

    @contextlib.contextmanager
    def router(self) -> Iterator[None]:
        cert, key = self.authority.sign("router", "127.0.0.1")
        given = {"listen": [self.address], "cert": cert, "key": key, "robots": PASSWORDS}
        with routing(checked(given, "test")):
            yield

    def flags(self, **changed: str) -> dict[str, str]:
        known = {"endpoint": self.address, "robot_name": "r1", "ca": self.authority.cert}
        return known | {"user": "r1", "user_file": self.password("r1")} | changed

    def password(self, name: str, text: str = "") -> str:
        file = self.folder / name
        file.write_text(text or PASSWORDS[name])
        return str(file)

    def results(self, **changed: str) -> list[str]:
        """Return what the check says: notes as they are, and findings with the advice."""
        settings = {"port": self.port, "uplink": self.flags(**changed)}
        machine = Machine(Config.model_validate(settings), os.environ, TIMEOUT_S)
        said = []
        for each in CHECKS["uplink"](machine):
            if isinstance(each, Finding):
                assert each.advice.partition(" ")[0] in VERBS
                said.append(f"{each.level}: {each.what}. {each.advice}")
            else:
                said.append(each.text)
        return said


@pytest.fixture
def robot(tmp_path: Path) -> Robot:
    return Robot(tmp_path)


def test_without_an_uplink_there_is_nothing_to_check():
    machine = Machine(Config(), os.environ, TIMEOUT_S)
    assert [each.text for each in CHECKS["uplink"](machine)] == ["there is no uplink"]


def test_an_uplink_that_works_has_no_finding(robot: Robot):
    with robot.router():
        said = robot.results()
    assert said == [f"the router {robot.address} takes this robot", "the name r1 is free"]


def test_each_fault_has_its_cause_and_what_to_do(robot: Robot):
    [said] = robot.results()
    assert re.search("error: .*cannot be reached, connection refused.*Correct the uplink: ", said)
    [said] = robot.results(ca="/nothing")
    assert "uplink.ca: /nothing: cannot be read" in said
    wrong = robot.password("wrong", "another-password")
    other = Authority(robot.folder, "other").cert
    with robot.router():
        [said] = robot.results(user_file=wrong)
        assert "refuses the name 'r1' or its password. Correct the uplink: compare" in said
        [said] = robot.results(ca=other)
        assert "has a certificate that is refused here" in said
        assert "set uplink.ca" in said
        [said] = robot.results(endpoint=robot.address.replace("tls", "tcp"))
        assert "needs TLS" in said
        [_, said] = robot.results(user="r2", user_file=robot.password("r2"))
        assert "passes on nothing of r1. Use the credentials of this robot's name" in said


def test_a_name_that_another_robot_has_is_found(robot: Robot):
    with robot.router():
        settings = {
            "transport/link/tls/root_ca_certificate": robot.authority.cert,
            "transport/auth/usrpwd/user": "r1",
            "transport/auth/usrpwd/password": PASSWORDS["r1"],
        }
        with contextlib.closing(client(robot.address, **settings)) as another:
            kept = another.liveliness().declare_token("gw/r1/robot/1")
            [_, said] = robot.results()
            assert "error: another robot is connected as r1. Set uplink.robot_name" in said
            kept.undeclare()


async def test_the_gateway_that_runs_here_is_no_other_robot(robot: Robot):
    with robot.router():
        flags = [
            part
            for name, each in robot.flags().items()
            for part in ("--set", f"uplink.{name}={each}")
        ]
        demo = ("demo", "--recorded", "--no-browser", *flags)
        async with gateway_process(*demo) as gateway:
            robot.port = int(gateway.url.rstrip("/").rpartition(":")[2])
            while "the name r1 is free" in (said := robot.results()):
                pass
    assert said[1] == "r1 is connected. Its health reports another robot of this name"
