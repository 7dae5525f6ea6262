# SPDX-License-Identifier: Apache-2.0
"""Variables of ROS that are wrong, as the command line reports them."""

import resource
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from gateway.cli import ros_environment
from tests.cli.test_main import TIMEOUT_S, refusal, ros2_gateway, running
from tests.namespaces import needs_namespaces

NOT_LOADED = (
    "which ROS cannot load here, expected rmw_fastrtps_cpp: unset it for the default, or install"
    " that package"
)
PEERS = (
    "expected host names or addresses, separated by semicolons and without spaces, such as"
    " `'192.168.1.7;robot.lan'`"
)


@pytest.mark.parametrize("command", ["serve", "demo", "sim", "mock"])
def test_middleware_that_is_not_there_is_one_sentence_with_what_to_do(command):
    assert refusal(command, RMW_IMPLEMENTATION="rmw_nonsense") == (
        2,
        f"RMW_IMPLEMENTATION: got 'rmw_nonsense', {NOT_LOADED}",
    )


@pytest.mark.parametrize(
    ("variable", "value", "sentence"),
    [
        (
            "ROS_AUTOMATIC_DISCOVERY_RANGE",
            "localhost",
            (
                "'localhost', expected SUBNET, LOCALHOST, OFF or SYSTEM_DEFAULT,"
                " or unset it for SUBNET"
            ),
        ),
        (
            "ROS_LOCALHOST_ONLY",
            "true",
            (
                "'true', expected 0 or 1: better unset it,"
                " and use ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST"
            ),
        ),
        (
            "ROS_STATIC_PEERS",
            "192.168.1.7, 192.168.1.8",
            f"'192.168.1.7, 192.168.1.8', {PEERS}",
        ),
    ],
)
@pytest.mark.parametrize("command", ["serve", "sim"])
def test_a_variable_of_ros_that_it_would_not_understand_is_one_sentence(
    command, variable, value, sentence
):
    assert refusal(command, **{variable: value}) == (2, f"{variable}: got {sentence}")


def test_all_variables_of_ros_that_are_wrong_are_reported_at_once():
    finished = ros2_gateway("serve", ROS_DOMAIN_ID="x", ROS_LOCALHOST_ONLY="yes")
    assert finished.returncode == 2
    assert len(finished.stderr.splitlines()) == 2


@pytest.mark.parametrize("command", ["serve", "demo", "sim", "mock"])
def test_too_few_open_files_are_one_sentence_with_what_to_do(command):
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (47, hard))  # of the children
    try:
        found = refusal(command)
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard))
    code, sentence = found
    assert code == 2
    assert sentence.startswith("this process may open 47 files, but it needs 48, and one more for")
    assert sentence.endswith("allow more, for example by `ulimit -n 1024`")


def test_variables_of_ros_that_are_right_or_empty_let_it_start(monkeypatch):
    for variable, value in {
        "RMW_IMPLEMENTATION": "rmw_fastrtps_cpp",
        "ROS_LOCALHOST_ONLY": "",
        "ROS_STATIC_PEERS": "127.0.0.1;localhost;",
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
    }.items():
        monkeypatch.setenv(variable, value)
    with running("serve", "--port", "0", until="ws://") as (process, printed):
        assert "ws://" in printed
        process.send_signal(signal.SIGINT)
        assert process.wait(TIMEOUT_S) == 0


def test_a_peer_that_nobody_knows_is_one_sentence_with_what_to_do():
    # RFC 6761: a name that no machine has
    finished = ros2_gateway("serve", ROS_STATIC_PEERS="nobody.invalid")
    assert (finished.returncode, finished.stdout) == (1, "")  # another start may find it
    sentence = finished.stderr.splitlines()[-1]  # first, it may tidy up after killed programs
    assert sentence.endswith("nobody.invalid. Correct its name in ROS_STATIC_PEERS, or remove it")


@needs_namespaces
def test_a_default_middleware_that_is_missing_is_told_of_with_what_to_do(monkeypatch):
    monkeypatch.delenv("RMW_IMPLEMENTATION", raising=False)
    middleware = Path(sys.prefix) / "lib/librmw_fastrtps_cpp.so"
    if not middleware.exists():
        pytest.skip("rclpy is not from the wheels")
    script = 'mount --bind /dev/null "$0"; exec "$@"'
    gateway = [sys.executable, "-m", "gateway", "serve", "--port", "0"]
    command = ["unshare", "--mount", "sh", "-c", script, str(middleware), *gateway]
    finished = subprocess.run(command, capture_output=True, text=True, check=False)
    assert finished.returncode == 3
    # first, it may tidy up after killed programs
    assert f"ros2-gateway: rclpy cannot be imported ({middleware}" in finished.stderr
    assert "source /opt/ros/jazzy/setup.bash" in finished.stderr


def test_middleware_that_loads_for_a_minute_keeps_no_gateway_from_starting(monkeypatch):
    waits_s: list[float] = []

    def load(command: list[str], *, timeout: float, **_: object) -> None:
        waits_s.append(timeout)
        raise subprocess.TimeoutExpired(command, timeout)

    monkeypatch.setenv("RMW_IMPLEMENTATION", "rmw_slow_cpp")
    monkeypatch.setattr(subprocess, "run", load)
    assert list(ros_environment._missing_middleware()) == []
    assert waits_s == [60]
