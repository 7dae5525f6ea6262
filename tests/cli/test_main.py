# SPDX-License-Identifier: Apache-2.0
"""The command line from outside: real processes, their words and their exit codes."""

import errno
import json
import os
import signal
import socket
import subprocess
import sys
import urllib.request
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path

import pytest

from gateway import app
from gateway.cli import demo, serving
from gateway.cli import main as cli
from gateway.cli.report import _REMEDIES
from gateway.config import files
from gateway.ending_signals import ENDING
from gateway.errors import _BIND_REASONS
from schemas.backports import tomllib

ROOT = Path(__file__).parents[2]
TIMEOUT_S = 180  # generous: other tests share the machine


def ros2_gateway(*arguments: str, **environment: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "gateway", *arguments],
        cwd=ROOT,
        env=os.environ | environment,
        capture_output=True,
        text=True,
        timeout=TIMEOUT_S,
        check=False,
    )


def refusal(*arguments: str, **environment: str) -> tuple[int, str]:
    """Return the exit code and the one sentence on standard error."""
    finished = ros2_gateway(*arguments, **environment)
    assert finished.stdout == ""
    (line,) = finished.stderr.splitlines()
    return finished.returncode, line.removeprefix("ros2-gateway: ")


@contextmanager
def running(*arguments: str, until: str) -> Iterator[tuple[subprocess.Popen[str], str]]:
    """Run a command, and yield it and what it printed up to the line that contains *until*."""
    process = subprocess.Popen(
        [sys.executable, "-m", "tests.patient_gateway", *arguments],
        cwd=ROOT,
        stdout=subprocess.PIPE,
        text=True,
    )
    assert process.stdout
    try:
        printed = ""
        for line in process.stdout:  # ends when the process does
            printed += line
            if until in line:
                break
        yield process, printed
    finally:
        process.send_signal(signal.SIGINT)
        try:
            process.communicate(timeout=TIMEOUT_S)
        finally:
            process.kill()


@pytest.mark.parametrize(
    "command",
    ["serve", "demo", "sim", "mock", "schema", "generate", "check-config", "token", "cert"],
)
def test_every_command_has_help_with_examples(command):
    finished = ros2_gateway(command, "--help")
    assert finished.returncode == 0
    assert f"ros2-gateway {command}" in finished.stdout.partition("examples:")[2]


def test_help_lists_the_commands_and_exit_codes():
    finished = ros2_gateway("--help")
    assert finished.returncode == 0
    assert "check-config" in finished.stdout
    assert "4  cannot listen" in finished.stdout


@pytest.mark.parametrize(
    "arguments",
    [
        ("--help",),
        ("serve", "--help"),
        ("token", "--help"),
        ("generate", "--help"),
        ("check-config",),
    ],
)
def test_nothing_heavy_is_imported_before_it_is_needed(arguments):
    heavy = ["rclpy", "cv2", "numpy", "websockets", "asyncio"]
    if "--help" in arguments:
        heavy.append("pydantic")
    finished = subprocess.run(
        [sys.executable, "-X", "importtime", "-m", "gateway", *arguments],
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=TIMEOUT_S,
        check=True,
    )
    imported = {line.rpartition("|")[2].strip() for line in finished.stderr.splitlines()}
    assert "argparse" in imported
    assert imported.isdisjoint(heavy)


def test_version_is_that_of_the_distribution():
    finished = ros2_gateway("--version")
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert finished.stdout == f"ros2-gateway {project['version']}\n"


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ("serv", "invalid choice: 'serv'"),
        ("serve --prot 1", "unknown arguments: --prot 1; did you mean --port? See ros2-gateway "),
        ("serve --port 70000", "--port: got '70000', expected an integer from 0 to 65535"),
        ("sim --domain-id 233", "--domain-id: got '233', expected an integer from 0 to 232"),
        ("mock --domain-id 233", "--domain-id: got '233', expected an integer from 0 to 232"),
        ("sim --seed -5", "seed -5 is below 0"),
        ("mock --type foo/Bar", "foo/msg/Bar is not installed: No module named 'foo'"),
        (
            "serve --set limits.max_cleints=3",
            "unknown setting limits.max_cleints, did you mean limits.max_clients",
        ),
        ("serve --set port", "--set: got 'port', expected KEY=VALUE"),
        ("serve --config /none.toml", "cannot read /none.toml, no such file or directory"),
        ("check-config /none.toml", "cannot read /none.toml, no such file or directory"),
        ("serve --set types.paths=/nowhere", "types.paths: /nowhere: no such file or directory"),
        (f"serve --set types.paths={__file__}", f"types.paths: {__file__}: not a directory"),
        ("serve --set types.paths=/", "types.paths: /: over 20000 folders below it"),
        *(
            (
                f"serve --path {path}",
                f"--path: got {path!r}, expected a path such as / or /ros, except",
            )
            for path in ("/healthz", "/healthz/ready", "/metrics", "/stream", "/snapshot")
        ),
        *(
            (f"schema {form}", f"no definition of {name} is installed, did you mean {close}")
            for form, name, close in (
                ("std_msgs/msg/Strng", "std_msgs/msg/Strng", "std_msgs/msg/String"),
                ("std_srvs/SetBol", "std_srvs/msg/SetBol", "std_srvs/srv/SetBool"),
                ("std_srvs/srv/SetBol", "std_srvs/srv/SetBol", "std_srvs/srv/SetBool"),
                ("nav_msgs/Odom", "nav_msgs/msg/Odom", "nav_msgs/msg/Odometry"),
                ("test_msgs/action/Fibo", "test_msgs/action/Fibo", "test_msgs/action/Fibonacci"),
            )
        ),
        ("schema twist", "'twist' is not a valid type: expected pkg/msg/Name, pkg/srv/Name, pkg/"),
        ("schema twist", ", did you mean geometry_msgs/msg/Twist"),
        ("schema std_srvs/srv/setbool", "is not a valid service type: expected pkg/srv/"),
        ("schema std_srvs/srv/setbool", ", did you mean std_srvs/srv/SetBool"),
        ("schema a/action/b", "'a/action/b' is not a valid action type: expected pkg/action/Name"),
        ("schema /odom", 'types of names: send it {"op":"describe","type":"/odom"}'),
    ],
)
def test_a_mistake_is_one_sentence(refused, arguments, sentence):
    code, said = refused(*arguments.split())
    assert code == 2
    assert sentence in said


@pytest.mark.parametrize("command", ["serve", "demo", "sim", "mock"])
@pytest.mark.parametrize("value", ["500", "abc", "-1"])
def test_a_domain_that_does_not_exist_is_one_sentence_with_its_variable(refused, command, value):
    assert refused(command, ROS_DOMAIN_ID=value) == (
        2,
        f"ROS_DOMAIN_ID: got {value!r}, expected an integer from 0 to 232",
    )


@pytest.mark.parametrize(
    ("arguments", "until"),
    [
        (("serve", "--port", "0"), "ws://"),
        (("demo", "--port", "0"), "ready at the origin"),  # the robot's, which inherits it
        (("mock", "--type", "0"), "1 type: "),
    ],
)
def test_a_flag_beats_a_domain_of_the_environment_that_does_not_exist(
    arguments, until, monkeypatch
):
    domain_id = os.environ["ROS_DOMAIN_ID"]
    monkeypatch.setenv("ROS_DOMAIN_ID", "500")
    process = subprocess.Popen(
        [sys.executable, "-m", "tests.patient_gateway", *arguments, "--domain-id", domain_id],
        cwd=ROOT,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    assert process.stdout
    for line in process.stdout:
        if until in line:
            break
    process.send_signal(signal.SIGINT)
    process.stdout.read()
    process.stdout.close()
    assert process.wait(TIMEOUT_S) == 0


def test_a_bad_value_is_one_sentence_with_its_variable(refused):
    said = "ROS2_GATEWAY_LIMITS__MAX_CLIENTS: got 'many', expected an integer of at least 1"
    assert refused("serve", ROS2_GATEWAY_LIMITS__MAX_CLIENTS="many") == (2, said)
    said = "cannot read /none.toml, no such file or directory"
    assert refused("serve", ROS2_GATEWAY_CONFIG="/none.toml") == (2, said)


def test_check_config_accepts_a_right_file(tmp_path):
    path = tmp_path / "gateway.toml"
    path.write_text("port = 1\n")
    finished = ros2_gateway("check-config", str(path))
    assert (finished.returncode, finished.stderr) == (0, "")
    assert finished.stdout.splitlines() == [
        f"read {path}",
        f"  port = 1  # {path}:1",
        "the configuration is right: 1 value given, the others have their defaults",
    ]


def test_check_config_reads_the_files_of_this_machine_and_names_what_it_ignores(tmp_path):
    key = tmp_path / "tokens.json"
    key.write_text('{"version":1,"tokens":[]}')
    key.chmod(0o644)
    folder = tmp_path / "config.d"
    folder.mkdir()
    (tmp_path / "config.toml").write_text(f"lan = true\naccess.token_file = '{key}'\n")
    (folder / "robot.toml").write_text("lan = false\n")
    (folder / "robot.toml.bak").touch()
    finished = ros2_gateway("check-config", ROS2_GATEWAY_CONFIG_DIR=str(tmp_path))
    assert finished.returncode == 0
    assert f"  lan = false  # {folder}/robot.toml:1\n" in finished.stdout
    exposed, ignored = finished.stderr.splitlines()
    assert exposed.endswith(f"run chmod o-rwx {key}")
    assert ignored.startswith(f"ros2-gateway: {folder}/robot.toml.bak is ignored: end its name ")


def test_check_config_prints_an_example_that_it_accepts(tmp_path):
    printed = ros2_gateway("check-config", "--example")
    (tmp_path / "config.toml").write_text(printed.stdout)
    finished = ros2_gateway("check-config", ROS2_GATEWAY_CONFIG_DIR=str(tmp_path))
    assert (finished.returncode, finished.stderr) == (0, "")
    assert "0 values given" in finished.stdout


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        (
            "port = 9443\ntls.port = 9443\n",
            "PATH:2: tls.port: 9443 is the plain port already: choose another",
        ),
        (
            "tls.cert = '/nowhere/cert.pem'\n",
            "PATH:1: tls.cert, tls.key: cannot read the files, no such file or directory",
        ),
        (
            "tls.port = 9443\ntls.key = 'k'\n",
            "PATH:2: tls.key: needs tls.cert, which is missing: set both",
        ),
        (
            "types.paths = ['/nowhere']\n",
            "PATH:1: types.paths: /nowhere: no such file or directory",
        ),
        ("log.level = 3\n", "PATH:1: log.level: got 3, expected debug, info, warning or error"),
    ],
)
def test_check_config_looks_at_what_a_file_names(refused, tmp_path, text, sentence):
    path = tmp_path / "gateway.toml"
    path.write_text(text)
    assert refused("check-config", str(path)) == (2, sentence.replace("PATH", str(path)))


def test_check_config_makes_nothing(tmp_path):
    path = tmp_path / "gateway.toml"
    path.write_text("lan = true\ntls.port = 9443\n")
    finished = ros2_gateway("check-config", str(path), XDG_CONFIG_HOME=str(tmp_path))
    assert finished.returncode == 0
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("command", ["serve", "demo"])
def test_print_config_tells_each_value_and_its_origin_without_serving(command):
    finished = ros2_gateway(
        command, "--print-config", "--port", "1", "--set", "limits.max_clients=7", "--use-sim-time"
    )
    assert finished.returncode == 0
    assert "port = 1  # --port\n" in finished.stdout
    assert "max_clients = 7  # --set limits.max_clients\n" in finished.stdout
    assert "use_sim_time = true  # --use-sim-time\n" in finished.stdout
    assert tomllib.loads(finished.stdout)["path"] == "/"


@pytest.mark.parametrize("command", [("serve",), ("demo",), ("demo", "--recorded")])
def test_a_demonstration_reads_no_settings_of_the_machine(
    command, tmp_path, monkeypatch, restored_signals, capsys
):
    (tmp_path / "config.toml").write_text("lan = true\n")
    monkeypatch.setattr(files, "FOLDER", tmp_path)
    assert cli.main([*command, "--print-config"]) == 0
    is_open = tomllib.loads(capsys.readouterr().out)["lan"]
    assert is_open == (command == ("serve",))


def test_schema_prints_a_json_schema_by_name_short_name_and_number():
    outputs = {
        ros2_gateway("schema", form).stdout
        for form in ("geometry_msgs/msg/Twist", "geometry_msgs/Twist", "1")
    }
    (output,) = outputs
    assert "linear" in json.loads(output)["properties"]


@pytest.mark.parametrize(
    ("forms", "parts"),
    [
        (("std_srvs/srv/SetBool", "std_srvs/SetBool"), ["request", "response"]),
        (
            ("test_msgs/action/Fibonacci", "test_msgs/Fibonacci"),
            ["goal", "result", "feedback"],
        ),
    ],
)
def test_schema_prints_that_of_a_service_and_of_an_action(forms, parts):
    (output,) = {ros2_gateway("schema", form).stdout for form in forms}
    schema = json.loads(output)
    assert schema["title"] == forms[0]
    assert list(schema["properties"]) == parts


def test_schema_prefers_the_message_where_a_service_has_its_name():
    titles = [
        json.loads(ros2_gateway("schema", form).stdout)["title"]
        for form in ("test_msgs/BasicTypes", "test_msgs/srv/BasicTypes")
    ]
    assert titles == ["test_msgs/msg/BasicTypes", "test_msgs/srv/BasicTypes"]


def test_schema_prints_the_definition():
    assert "float64 x" in ros2_gateway("schema", "geometry_msgs/Vector3", "--definition").stdout
    assert "\n---\n" in ros2_gateway("schema", "std_srvs/SetBool", "--definition").stdout
    shipped = ros2_gateway("schema", "nav2_msgs/action/NavigateToPose", "--definition").stdout
    assert "string behavior_tree\n---\n" in shipped


def test_schema_knows_the_folders_that_are_named(tmp_path):
    folder = tmp_path / "cargo_msgs" / "msg"
    folder.mkdir(parents=True)
    (folder.parent / "package.xml").write_text("<package><name>cargo_msgs</name></package>")
    (folder / "Crate.msg").write_text("float64 weight\n")
    config = tmp_path / "gateway.toml"
    config.write_text(f"types.paths = ['{tmp_path}']\n")
    for options in (("--types-path", str(tmp_path)), ("--config", str(config))):
        finished = ros2_gateway("schema", "cargo_msgs/Crate", *options)
        assert list(json.loads(finished.stdout)["properties"]) == ["weight"]


def test_a_reader_may_stop_reading():
    process = subprocess.Popen(
        [sys.executable, "-m", "gateway", "check-config", "--keys"],
        cwd=ROOT,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )
    assert process.stdout
    process.stdout.close()
    assert process.stderr
    assert process.stderr.read() == b""
    process.stderr.close()
    assert process.wait(TIMEOUT_S) == 0


@pytest.mark.usefixtures("restored_signals")
@pytest.mark.parametrize("flags", [("--port",), ("--port", "0", "--tls-port")])
def test_a_demonstration_whose_port_is_in_use_starts_no_second_robot(flags, monkeypatch, capsys):
    monkeypatch.setattr(demo, "run", lambda *_: pytest.fail("the robot has started"))
    with socket.create_server(("127.0.0.1", 0)) as listener:
        port = listener.getsockname()[1]
        assert cli.main(["demo", *flags, str(port)]) == 4
    assert f"cannot listen on 127.0.0.1:{port}" in capsys.readouterr().err


@pytest.mark.usefixtures("restored_signals")
def test_without_ros_a_service_that_is_shipped_is_known(monkeypatch, tmp_path, capsys):
    monkeypatch.delenv("AMENT_PREFIX_PATH", raising=False)
    monkeypatch.setattr(sys, "prefix", str(tmp_path))
    shipped = (ROOT / "schemas" / "json" / "std_srvs" / "srv" / "SetBool.json").read_text("utf-8")
    for form in ("std_srvs/srv/SetBool", "std_srvs/SetBool"):
        assert cli.main(["schema", form]) == 0
        known = json.loads(capsys.readouterr().out)["properties"]
        assert known.keys() == json.loads(shipped)["properties"].keys()
    assert cli.main(["schema", "own_srvs/Own", "--definition"]) == 2
    assert "name a folder with its definition by --types-path" in capsys.readouterr().err


@pytest.mark.usefixtures("restored_signals")
def test_a_bug_is_one_sentence_and_with_debug_a_traceback(monkeypatch, capsys):
    def fail(_: object) -> Sequence[object]:
        raise ZeroDivisionError("division by zero")

    monkeypatch.setattr(serving, "_given", fail)
    assert cli.main(["serve"]) == 1
    assert capsys.readouterr().err == (
        "ros2-gateway: internal error, ZeroDivisionError: division by zero"
        " (add --debug to see where)\n"
    )
    assert cli.main(["serve", "--debug"]) == 1
    assert "Traceback" in capsys.readouterr().err


@pytest.mark.usefixtures("restored_signals")
@pytest.mark.parametrize(
    ("error", "sentence"),
    [
        (
            OSError(errno.EMFILE, "Too many open files", "x.toml"),
            f"too many open files, at x.toml: {_REMEDIES[errno.EMFILE]}",
        ),
        (OSError(errno.EIO, "Input/output error"), "input/output error: add --debug to see where"),
    ],
)
def test_a_fault_of_the_machine_is_not_reported_as_a_bug(error, sentence, monkeypatch, capsys):
    def fail(_: object) -> Sequence[object]:
        raise error

    monkeypatch.setattr(serving, "_given", fail)
    assert cli.main(["serve"]) == 1
    assert capsys.readouterr().err == f"ros2-gateway: {sentence}\n"


@pytest.mark.parametrize(
    ("host", "sentence"),
    [
        ("127.0.0.1", f"cannot listen on 127.0.0.1:PORT, {_BIND_REASONS[errno.EADDRINUSE]}"),
        # RFC 5737: an address that no machine has
        ("192.0.2.1", f"cannot listen on 192.0.2.1:PORT, {_BIND_REASONS[errno.EADDRNOTAVAIL]}"),
        ("nobody.invalid", "choose one of this machine's with --host, or --lan"),
    ],
)
def test_an_address_on_which_nobody_can_listen_is_one_sentence_and_exit_code_4(host, sentence):
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = str(taken.getsockname()[1])
        finished = ros2_gateway("serve", "--host", host, "--port", port, "--log-level", "error")
    (line,) = finished.stderr.splitlines()
    assert finished.returncode == 4
    assert line.endswith(sentence.replace("PORT", port))


def test_each_reason_not_to_listen_comes_with_what_to_do():
    assert "--port" in _BIND_REASONS[errno.EADDRINUSE]
    assert "--port" in _BIND_REASONS[errno.EACCES]
    assert "--lan" in _BIND_REASONS[errno.EADDRNOTAVAIL]
    assert "--host" in _BIND_REASONS[errno.EAFNOSUPPORT]


@pytest.mark.parametrize("signal_number", ENDING)
def test_serve_announces_its_address_and_ends_with_0(signal_number):
    with running("serve", "--port", "0", until="ws://") as (process, printed):
        port = printed.rpartition(":")[2].strip().rstrip("/")
        with urllib.request.urlopen(f"http://127.0.0.1:{port}/healthz", timeout=TIMEOUT_S) as page:
            assert page.status == 200
        process.send_signal(signal_number)
        assert process.wait(TIMEOUT_S) == 0


@pytest.mark.parametrize("signal_number", [signal.SIGINT, signal.SIGUSR1])
def test_a_signal_during_the_start_ends_with_0(signal_number):
    process = subprocess.Popen(
        [sys.executable, "-X", "importtime", "-m", "gateway", "serve", "--port", "0"],
        cwd=ROOT,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert process.stderr
    for line in process.stderr:  # in the middle of the imports
        if line.split()[-1] == "gateway.config.settings":
            break
    process.send_signal(signal_number)
    process.stderr.read()
    process.stderr.close()
    assert process.wait(TIMEOUT_S) == 0


@pytest.mark.usefixtures("restored_signals")
def test_an_extension_module_that_hides_an_interrupt_behind_another_error_changes_nothing(
    monkeypatch, capsys
):
    def load(_: object) -> Sequence[object]:
        try:
            signal.raise_signal(signal.SIGTERM)
        except KeyboardInterrupt as error:
            raise ImportError("initialization failed") from error
        return []

    monkeypatch.setattr(serving, "_given", load)
    assert cli.main(["serve"]) == 0
    assert capsys.readouterr() == ("", "")


@pytest.mark.usefixtures("restored_signals")
def test_an_interrupt_that_an_import_has_lost_still_ends_the_start(monkeypatch):
    def load(_: object) -> Sequence[object]:
        with suppress(KeyboardInterrupt):
            signal.raise_signal(signal.SIGTERM)
        return []

    monkeypatch.setattr(serving, "_given", load)
    monkeypatch.setattr(serving, "use_ros", lambda _: None)
    monkeypatch.setattr(serving, "_begin_log", lambda _: None)
    monkeypatch.setattr(app, "open_security", lambda _: pytest.fail("started"))
    assert cli.main(["serve"]) == 0


def test_demo_shows_lines_to_paste_and_ctrl_c_ends_it_with_0():
    with running("demo", "--port", "0", until="Ctrl-C") as (process, printed):
        lines = [line.strip() for line in printed.splitlines() if line.strip().startswith("{")]
        assert [json.loads(line)["op"] for line in lines] == [
            "subscribe",
            "publish",
            "lookup_transform",
            "send_action_goal",
            "cancel_action_goal",
        ]
        process.send_signal(signal.SIGINT)
        assert process.wait(TIMEOUT_S) == 0


def test_a_simulated_robot_that_dies_ends_the_demo_with_1():
    with running("demo", "--port", "0", until="ws://") as (process, _):
        children = Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()
        # the other one is the guard, if it has been started by now
        (robot,) = (c for c in children if "\0sim\0" in Path(f"/proc/{c}/cmdline").read_text())
        os.kill(int(robot), signal.SIGKILL)
        assert process.wait(TIMEOUT_S) == 1


def test_sim_ends_with_0_on_sigterm():
    process = subprocess.Popen(
        [sys.executable, "-m", "gateway", "sim", "--no-camera"],
        cwd=ROOT,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert process.stderr
    for line in process.stderr:
        if "ready" in line:
            break
    process.terminate()
    process.stderr.read()
    process.stderr.close()
    assert process.wait(TIMEOUT_S) == 0
