# SPDX-License-Identifier: Apache-2.0
"""Each check of the doctor finds a fault that is made: a taken port, a full disk, a wrong file."""

import asyncio
import fcntl
import json
import os
import pwd
import shlex
import signal
import socket
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, HTTPServer
from pathlib import Path
from tempfile import TemporaryDirectory
from types import SimpleNamespace
from urllib.parse import urlsplit

import pytest
from rclpy.context import Context

from gateway.cli import service
from gateway.cli.doctor import machine_checks, ros_checks
from gateway.cli.doctor.finding import Finding, Note
from gateway.cli.doctor.local_checks import CHECKS, local_checks
from gateway.cli.doctor.machine import Machine, Probed
from gateway.cli.tokens import own_command
from gateway.config.files import Given
from gateway.config.settings import load
from tests.cli.doctor.one_check import TIMEOUT_S, found
from tests.cli.test_main import ros2_gateway
from tests.gateway_process import gateway_process
from tests.namespaces import needs_namespaces
from tests.sources.nodes import open_node

NOBODY = 65534
VETH = "ip link add net0 type veth peer name net1"
PROFILE = "FASTRTPS_DEFAULT_PROFILES_FILE"
needs_root = pytest.mark.skipif(os.geteuid() != 0, reason="needs root")


def machine(*given: Given, **environment: str) -> Machine:
    return Machine(load(given).config, os.environ | environment, TIMEOUT_S)


def findings(name: str, checked: Machine) -> list[str]:
    results = list(CHECKS[name](checked))
    return [f"{each.level}: {each.what}" for each in results if isinstance(each, Finding)]


def notes(name: str, checked: Machine) -> list[str]:
    return [each.text for each in CHECKS[name](checked) if isinstance(each, Note)]


def mounted(folder: Path | str, options: str) -> list[str]:
    """Return the start of a command for which an empty file system is mounted on a folder."""
    script = f'mount -t tmpfs -o {options} tmpfs {shlex.quote(str(folder))}; exec "$@"'
    return ["unshare", "--mount", "sh", "-ec", script, "sh"]


# configuration


def test_a_wrong_configuration_is_found_and_the_other_checks_go_on(tmp_path: Path):
    file = tmp_path / "gateway.toml"
    file.write_text("prt = 1\n")
    checks = local_checks(file, {}, TIMEOUT_S)
    (finding,) = checks["configuration"]()
    assert finding.what == f"{file}:1: unknown setting prt, did you mean port"
    file.write_text("lan = true\nhost = '127.0.0.1'\n")
    (finding,) = local_checks(file, {}, TIMEOUT_S)["configuration"]()
    assert finding.what.startswith(f"{file}:1: lan: got true, but host is 127.0.0.1")
    assert list(checks)[1:] == list(CHECKS)


# domain


def test_a_domain_that_does_not_exist_is_found():
    assert findings("domain", machine(ROS_DOMAIN_ID="500")) == ["error: ROS_DOMAIN_ID is '500'"]


def test_another_domain_in_the_configuration_than_in_the_shell_is_found():
    (finding,) = findings(
        "domain", machine(Given("ros.domain_id", "3", "--set"), ROS_DOMAIN_ID="4")
    )
    assert finding == "warning: ROS_DOMAIN_ID is 4, but ros.domain_id is 3"


def test_a_domain_whose_ports_any_program_may_have_is_found(tmp_path: Path, monkeypatch):
    ports = tmp_path / "ip_local_port_range"
    monkeypatch.setattr(ros_checks, "_EPHEMERAL", ports)
    ports.write_text("32768\t60999\n")  # as Linux has it
    is_found = [bool(findings("domain", machine(ROS_DOMAIN_ID=str(each)))) for each in range(233)]
    assert is_found == [101 <= each <= 214 for each in range(233)]


def test_a_service_with_another_domain_than_the_shell_is_found(tmp_path: Path, monkeypatch):
    unit = tmp_path / "ros2-gateway.service"
    monkeypatch.setattr(service, "UNIT", unit)
    variables = {"RMW_IMPLEMENTATION": "rmw_x"}
    unit.write_text(service.Unit("robot", [], [], variables).text)
    (finding,) = findings("domain", machine(ROS_DOMAIN_ID="7"))
    assert finding == "warning: the service has ROS_DOMAIN_ID=0, and this shell ROS_DOMAIN_ID=7"
    assert findings("domain", machine(ROS_DOMAIN_ID="")) == []
    (finding,) = findings("domain", machine(ROS_DOMAIN_ID="0", RMW_IMPLEMENTATION="rmw_y"))
    assert finding.startswith("warning: the service has RMW_IMPLEMENTATION=rmw_x, and this shell ")
    as_it = f"sudo -u robot XDG_CONFIG_HOME=/var/lib {shlex.join(own_command())} doctor"
    assert f"to check as it, run `{as_it}`" in notes("permissions", machine())[1]


def test_a_computer_that_is_too_busy_is_found():
    """The time of a check is over before Python has begun."""
    checked = Machine(load().config, os.environ, timeout_s=0.001)
    assert findings("middleware", checked) == ["error: ROS was not loaded within 0.001 s"]
    assert notes("numpy", checked) == ["not reached: see middleware"]
    assert notes("discovery", checked) == ["not reached: see middleware and numpy"]


# middleware, numpy, discovery: what a process with ROS finds


def test_middleware_that_is_missing_is_found():
    checked = machine(RMW_IMPLEMENTATION="rmw_nonsense")
    (finding,) = findings("middleware", checked)
    assert finding.startswith("error: ROS cannot be loaded with RMW_IMPLEMENTATION=rmw_nonsense (")
    assert notes("discovery", checked) == ["not reached: see middleware and numpy"]


def test_a_variable_that_ros_does_not_understand_is_found(monkeypatch):
    monkeypatch.setenv("ROS_LOCALHOST_ONLY", "yes")
    assert "error: ROS_LOCALHOST_ONLY: got 'yes'" in findings("middleware", machine())[0]


def stub(folder: Path, package: str, text: str) -> dict[str, str]:
    """Return the environment in which a package is another one."""
    (folder / package).mkdir()
    (folder / package / "__init__.py").write_text(text)
    return {"PYTHONPATH": str(folder)}


def test_ros_that_is_not_installed_is_found(tmp_path: Path):
    environment = stub(tmp_path, "rclpy", "raise ImportError(\"No module named 'rclpy'\")")
    (finding,) = findings("middleware", machine(**environment))
    assert finding.startswith("error: rclpy cannot be loaded (ImportError: No module named 'rclpy'")


@pytest.mark.parametrize(
    ("package", "text", "wanted"),
    [
        (
            "sensor_msgs",  # as NumPy 2 reports a package in C that is compiled for NumPy 1
            "raise ImportError('A module that was compiled using NumPy 1.x cannot be run in')",
            "error: the ROS messages do not work with NumPy 2",
        ),
        ("sensor_msgs", "", "error: the ROS messages cannot be loaded (ModuleNotFoundError: "),
        ("numpy", "raise ImportError('x')", "error: NumPy cannot be loaded (ImportError: x)"),
    ],
)
def test_numpy_and_messages_that_do_not_fit_are_found(tmp_path: Path, package, text, wanted):
    (finding,) = findings("numpy", machine(**stub(tmp_path, package, text)))
    assert finding.startswith(wanted)


def test_a_robot_that_is_not_there_is_found_and_one_that_is_there_is_named():
    (finding,) = findings("discovery", machine())
    domain = os.environ["ROS_DOMAIN_ID"]
    wanted = f"warning: no node of a robot answered within 3 s in domain {domain}"
    assert finding == wanted
    context = Context()
    context.init(domain_id=int(domain))
    nodes = [open_node(name, context) for name in ("wheels", "_ros2_gateway_guard")]
    wanted_notes = ["a gateway runs in this domain", "sees 1 node: /wheels"]
    for _ in range(20):  # a busy machine finds nodes late
        checked = machine()
        if notes("discovery", checked) == wanted_notes:
            break
    assert notes("discovery", checked) == wanted_notes
    assert notes("middleware", checked)[0].startswith("ROS uses rmw_")
    for node in nodes:
        node.destroy_node()
    context.try_shutdown()


@needs_namespaces
def test_ros_that_cannot_start_is_found():
    before = mounted("/dev/shm", "size=4k")  # noqa: S108
    wanted = ["error: ROS cannot be loaded (it was killed by SIGBUS)"]
    assert found("middleware", *before) == wanted


@pytest.mark.parametrize(("count", "shown"), [(5, "/n0, /n1, /n2, /n3, /n4"), (6, "/n4, ...")])
def test_of_many_nodes_some_are_named(count, shown):
    checked = machine()
    checked._probed = Probed({"nodes": [f"/n{number}" for number in range(count)]})
    (note,) = notes("discovery", checked)
    assert note.startswith(f"sees {count} nodes: /n0")
    assert note.endswith(shown)


def test_ros_that_refuses_a_variable_is_found():
    (finding,) = findings("discovery", machine(ROS_STATIC_PEERS="nobody.invalid"))
    assert finding.startswith("error: ROS cannot create a node (")


@pytest.mark.parametrize(
    ("variables", "limit"),
    [
        ({"ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}, "ROS_AUTOMATIC_DISCOVERY_RANGE"),
        ({"ROS_AUTOMATIC_DISCOVERY_RANGE": "OFF"}, "ROS_AUTOMATIC_DISCOVERY_RANGE"),
        ({"ROS_LOCALHOST_ONLY": "1"}, "ROS_LOCALHOST_ONLY"),
        ({"ROS_AUTOMATIC_DISCOVERY_RANGE": "SUBNET"}, ""),
    ],
)
def test_a_variable_that_hides_other_machines_is_the_reason(variables, limit):
    assert ros_checks._limit(variables) == limit


@needs_namespaces
def test_a_network_without_multicast_is_found():
    code = "from gateway.cli.doctor import multicast as m; print"
    able, down = (
        output(
            ["unshare", "--net", "sh", "-ec", f'{links} exec "$0" -c "$1"', sys.executable, tried]
        ).strip()
        for links, tried in (
            (f"{VETH}; ip link set net0 up; ip link set net1 up;", f"{code}(m.multicast_fault())"),
            (f"{VETH};", f"{code}(m._fault_of('net0'), m.multicast_fault())"),
        )
    )
    assert able == "None"
    assert down == (
        "net0 cannot send it, network is unreachable"
        " no network interface that is up can do multicast"
    )


def test_with_zenoh_the_router_is_named_in_place_of_dds():
    checked = machine(ROS_DOMAIN_ID="101", RMW_IMPLEMENTATION="rmw_zenoh_cpp", **{PROFILE: "/no"})
    checked._probed = Probed({"middleware": "rmw_zenoh_cpp", "nodes": []})
    for name in ("domain", "DDS profile", "shared memory"):  # whose ports, file and room are wrong
        assert findings(name, checked) == []
    (alone,) = CHECKS["discovery"](checked)
    assert isinstance(alone, Finding)
    assert "its router is not started" in alone.why
    assert alone.advice.startswith("Run `ros2 run rmw_zenoh_cpp rmw_zenohd` on the robot")
    (used,) = notes("middleware", checked)
    assert used == "ROS uses rmw_zenoh_cpp, with which only installed types are available"


# DDS profile


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        (None, "error: NAME: cannot read PATH, no such file or directory"),
        ("<dds>\n<oops></dds>", "error: NAME: PATH is not valid XML, mismatched tag: line 2"),
        ("<robot/>", "error: NAME: PATH begins with <robot>"),
        ('<dds xmlns="http://www.eprosima.com"/>', None),
    ],
)
@pytest.mark.parametrize("variable", [PROFILE, "FASTDDS_DEFAULT_PROFILES_FILE", "CYCLONEDDS_URI"])
def test_a_profile_that_dds_cannot_use_is_found(tmp_path: Path, variable, text, wanted):
    file = tmp_path / "profile.xml"
    if text is not None:
        file.write_text(text)
    value = f"file://{file}" if variable == "CYCLONEDDS_URI" else str(file)
    said = findings("DDS profile", machine(**{variable: value}))
    if wanted is None:
        assert said == []
    else:
        (finding,) = said
        assert finding.startswith(wanted.replace("NAME", variable).replace("PATH", str(file)))


def test_a_profile_in_the_variable_itself_is_not_a_file():
    assert findings("DDS profile", machine(CYCLONEDDS_URI="<CycloneDDS/>")) == []


# shared memory


@needs_namespaces
@pytest.mark.parametrize(
    ("options", "wanted"),
    [
        ("size=8k", ["error: /dev/shm has 8 KiB free"]),
        ("size=16k", ["warning: /dev/shm has 16 KiB free"]),
        ("size=63m", ["warning: /dev/shm has 63 MiB free"]),
        ("size=64m", []),
    ],
)
def test_shared_memory_without_room_is_found(options, wanted):
    assert found("shared memory", *mounted("/dev/shm", options)) == wanted  # noqa: S108


def test_a_system_without_shared_memory_is_found(tmp_path: Path, monkeypatch):
    monkeypatch.setattr(machine_checks, "FOLDER", tmp_path / "none")
    (finding,) = findings("shared memory", machine())
    assert finding == f"warning: {tmp_path}/none cannot be used, no such file or directory"


@needs_root
def test_segments_of_another_user_are_found_with_what_they_mean(tmp_path: Path, monkeypatch):
    monkeypatch.setattr(machine_checks, "FOLDER", tmp_path)
    locks = [tmp_path / f"fastrtps_{number:016x}_el" for number in range(3)]
    for lock in locks:
        lock.touch()
    for lock in locks[1:]:
        os.chown(lock, NOBODY, NOBODY)
    other = pwd.getpwuid(NOBODY).pw_name
    with locks[2].open() as held:
        fcntl.flock(held, fcntl.LOCK_EX)
        assert findings("shared memory", machine()) == [
            f"warning: 1 participant of user {other} in shared memory",
            f"warning: 1 segment of shared memory left by programs of user {other}",
        ]


# permissions


def as_nobody() -> list[str]:
    """Return the start of a command that another user executes."""
    command = ["setpriv", f"--reuid={NOBODY}", f"--regid={NOBODY}", "--clear-groups"]
    if os.geteuid() != 0:
        pytest.skip("needs root")
    try:
        output([*command, sys.executable, "-c", "import gateway.cli.main"])
    except AssertionError:
        pytest.skip("another user cannot read this source tree")
    return command


@pytest.fixture
def open_path() -> Iterator[Path]:
    """Return a directory whose parents every user may enter."""
    with TemporaryDirectory() as name:
        Path(name).chmod(0o755)
        yield Path(name)


def test_a_directory_that_is_not_writable_is_found(open_path: Path):
    tmp_path = open_path
    before = as_nobody()
    variables = {"XDG_CONFIG_HOME": str(tmp_path), "ROS_LOG_DIR": "/tmp", "HOME": "/"}  # noqa: S108
    name = pwd.getpwuid(NOBODY).pw_name
    wanted = [f"error: {tmp_path} is not writable for {name}"]
    assert found("permissions", *before, **variables) == wanted
    os.chown(tmp_path, NOBODY, NOBODY)
    assert found("permissions", *before, **variables) == []
    tokens = tmp_path / "ros2-gateway/tokens.json"
    tokens.parent.mkdir()
    tokens.touch(0o600)
    wanted = [
        f"error: {tokens.parent} is not writable for {name}",
        f"error: cannot read {tokens}, permission denied",
    ]
    assert found("permissions", *before, **variables) == wanted


@needs_namespaces
def test_shared_memory_that_is_not_writable_is_found():
    before = [*mounted("/dev/shm", "mode=0555,size=64m"), *as_nobody()]  # noqa: S108
    name = pwd.getpwuid(NOBODY).pw_name
    assert found("shared memory", *before) == [f"error: /dev/shm is not writable for {name}"]


@pytest.mark.parametrize(
    ("mode", "wanted"),
    [
        (0o600, []),
        (0o644, ["warning: FILE can be read by every user of this machine"]),
        (0o660, ["error: FILE can be changed by others"]),
    ],
)
def test_a_token_file_that_others_can_use_is_found(tmp_path: Path, monkeypatch, mode, wanted):
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    tokens = tmp_path / "ros2-gateway/tokens.json"
    tokens.parent.mkdir()
    tokens.write_text('{"version":1,"tokens":[]}')
    tokens.chmod(mode)
    said = [each.replace("FILE", str(tokens)) for each in wanted]
    assert findings("permissions", machine(ROS_LOG_DIR=str(tmp_path))) == said
    tokens.chmod(0o600)
    tokens.write_text("{}[")
    (finding,) = findings("permissions", machine(ROS_LOG_DIR=str(tmp_path)))
    assert finding.startswith(f"error: {tokens} is not a token file: ")


# ports


def on(port: int) -> Machine:
    return machine(Given("port", str(port), "--port"))


def test_a_port_that_another_program_has_is_found_with_the_program():
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        (finding,) = [each for each in CHECKS["ports"](on(port)) if isinstance(each, Finding)]
    assert finding.what == f"cannot listen on 127.0.0.1:{port}"
    assert finding.why.startswith(f"It is in use by process {os.getpid()} (")
    assert notes("ports", on(port)) == [f"port {port} is free"]


def test_an_address_that_this_machine_does_not_have_is_found():
    with answering({"live": True, "ready": True, "reasons": []}) as port:  # by another address
        host = Given("host", "192.0.2.1", "--host")  # RFC 5737
        checked = machine(host, Given("port", str(port), "--port"))
        assert findings("ports", checked) == [f"error: cannot listen on 192.0.2.1:{port}"]


@contextmanager
def answering(answer: object) -> Iterator[int]:
    class Health(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            self.send_response(200)
            self.end_headers()
            self.wfile.write(json.dumps(answer).encode())

        def log_message(self, *_: object) -> None:
            pass

    server = HTTPServer(("127.0.0.1", 0), Health)
    thread = threading.Thread(target=server.serve_forever)
    thread.start()
    try:
        yield server.server_port
    finally:
        server.shutdown()
        thread.join(TIMEOUT_S)
        server.server_close()


def test_a_gateway_may_have_the_port():
    with answering({"live": True, "ready": True, "reasons": []}) as port:
        assert notes("ports", on(port)) == [f"a gateway listens on port {port}"]
    with answering([]) as port:
        assert len(findings("ports", on(port))) == 1


async def test_a_gateway_with_tls_may_have_the_port(tmp_path: Path, monkeypatch):
    pytest.importorskip("cryptography")
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    ros2_gateway("cert")
    cert, key = (str(tmp_path / "ros2-gateway" / name) for name in ("cert.pem", "key.pem"))
    arguments = ("serve", "--tls-cert", cert, "--tls-key", key)
    async with gateway_process(*arguments, module="gateway") as gateway:
        port = urlsplit(gateway.url).port or 0
        told = await asyncio.to_thread(notes, "ports", on(port))
    assert told == [f"a gateway listens on port {port}"]


async def test_a_gateway_that_hangs_is_found():
    async with gateway_process(module="gateway") as gateway:
        gateway.process.send_signal(signal.SIGSTOP)
        try:
            port = urlsplit(gateway.url).port or 0
            results = await asyncio.to_thread(lambda: list(CHECKS["ports"](on(port))))
        finally:
            gateway.process.send_signal(signal.SIGCONT)
    (finding,) = [each for each in results if isinstance(each, Finding)]
    assert finding.what == f"the gateway on port {port} does not answer"
    assert finding.why.startswith(f"Process {gateway.process.pid} (")


# clock


@pytest.fixture
def exact_clock(monkeypatch: pytest.MonkeyPatch) -> Callable[[int], None]:
    """Let the kernel tell a state of the clock: this machine may be synchronized or not."""

    def tell(state: int) -> None:
        monkeypatch.setattr(machine_checks, "_clock_state", lambda: state)

    tell(0)
    return tell


def test_a_clock_that_is_not_synchronized_is_found(exact_clock):
    exact_clock(5)
    assert findings("clock", machine()) == ["warning: the clock is not synchronized"]
    exact_clock(-1)
    assert findings("clock", machine()) == []


def test_the_kernel_tells_the_state_of_the_clock():
    assert -1 <= machine_checks._clock_state() <= 5


def test_a_clock_that_is_behind_is_found_by_a_file_of_the_future(
    tmp_path: Path, monkeypatch, exact_clock
):
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    tokens = tmp_path / "ros2-gateway/tokens.json"
    tokens.parent.mkdir()
    tokens.touch()
    for ahead_s, wanted in ((40, []), (3 * 3600 + 60, ["3 h"]), (86400 * 400, ["400 days"])):
        os.utime(tokens, times=(time.time() + ahead_s,) * 2)
        said = [f"error: the clock is at least {each} behind" for each in wanted]
        assert findings("clock", machine()) == said


def test_files_may_be_a_minute_ahead_of_the_clock(tmp_path: Path, monkeypatch, exact_clock):
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    tokens = tmp_path / "ros2-gateway/tokens.json"
    tokens.parent.mkdir()
    tokens.touch()
    now_s = int(time.time()) + 1000
    clock = SimpleNamespace(time=lambda: now_s, monotonic=lambda: 0, sleep=lambda _: None)
    monkeypatch.setattr(machine_checks, "time", clock)
    checked = Machine(load().config, os.environ, TIMEOUT_S, began_s=now_s)
    for ahead_s in (60, 61):
        os.utime(tokens, times=(now_s + ahead_s,) * 2)
        assert len(findings("clock", checked)) == ahead_s - 60


def test_a_clock_that_was_just_set_is_found(exact_clock):
    checked = machine()
    checked.began_s -= 3600
    assert findings("clock", checked) == ["warning: the clock was just set by +3600.0 s"]


# disk


@needs_namespaces
@pytest.mark.parametrize(
    ("options", "wanted"),
    [
        ("size=1020k", ["error: 1020 KiB free for FOLDER"]),
        ("size=1024k", ["warning: 1 MiB free for FOLDER"]),
        ("size=199m", ["warning: 199 MiB free for FOLDER"]),
        ("size=200m", []),
        ("size=200m,nr_inodes=1", ["error: no inodes left for FOLDER"]),
    ],
)
def test_a_full_disk_is_found(tmp_path: Path, options, wanted):
    variables = {"XDG_CONFIG_HOME": str(tmp_path), "ROS_LOG_DIR": str(tmp_path)}
    said = [each.replace("FOLDER", str(tmp_path)) for each in wanted]
    assert found("disk", *mounted(tmp_path, options), **variables) == said


def output(command: list[str]) -> str:
    import subprocess

    finished = subprocess.run(
        command, capture_output=True, text=True, timeout=TIMEOUT_S, check=False
    )
    assert finished.returncode == 0, finished.stderr
    return finished.stdout


def test_each_check_has_a_fault_here():
    files = Path(__file__).parent.glob("test_*.py")
    text = "".join(each.read_text(encoding="utf-8") for each in files)
    for name in CHECKS:
        calls = (f'found("{name}"', f'findings("{name}"', f'CHECKS["{name}"](')
        assert any(call in text for call in calls), name
