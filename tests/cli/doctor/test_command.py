# SPDX-License-Identifier: Apache-2.0
"""The command `doctor`: all checks end, and every finding says what to do."""

import ast
import json
import socket
import threading
from collections.abc import Iterator
from pathlib import Path

from gateway.cli import doctor as doctor_package
from gateway.cli.doctor import command, machine_checks, multicast, ports
from gateway.cli.doctor.finding import Finding, Note, Results
from gateway.cli.doctor.local_checks import CHECKS
from gateway.sources.rclpy import probe
from tests.cli.test_main import ros2_gateway

FILES = sorted(Path(doctor_package.__file__).parent.glob("*.py"))
VERBS = {
    *(
        "Add",
        "Allow",
        "Check",
        "Choose",
        "Correct",
        "End",
        "Free",
        "Install",
        "Make",
        "Mount",
        "Move",
    ),
    *("Move", "Name", "Read", "Remove", "Report", "Run", "Set", "Start", "Synchronize", "Try"),
    *("Unset", "Use", "Wait"),
}


def leading_text(value: ast.expr, tree: ast.Module) -> list[str]:
    """Return the literal beginnings that an expression may have, also by the name of a variable."""
    match value:
        case ast.Constant(str(text)):
            return [text]
        case ast.JoinedStr([first, *_]):
            return leading_text(first, tree)
        case ast.Name(name):
            return [
                text
                for node in ast.walk(tree)
                if isinstance(node, ast.Assign | ast.AnnAssign) and node.value is not None
                for target in (node.targets if isinstance(node, ast.Assign) else [node.target])
                if isinstance(target, ast.Name) and target.id == name
                for text in leading_text(node.value, tree)
            ]
    return [""]


def beginnings() -> Iterator[tuple[str, str]]:
    for file in FILES:
        tree = ast.parse(file.read_text(encoding="utf-8"))
        for node in ast.walk(tree):
            match node:
                case ast.Call(ast.Name("Finding"), [_, _, _, advice]):
                    for text in leading_text(advice, tree) or [""]:
                        yield f"{file.name}:{node.lineno}", text


def test_every_finding_has_an_advice_that_begins_with_a_verb():
    found = list(beginnings())
    assert len(found) > 30
    assert [(where, text) for where, text in found if text.partition(" ")[0] not in VERBS] == []
    calls = sum(file.read_text(encoding="utf-8").count(" Finding(") for file in FILES)
    assert len({where for where, _ in found}) >= calls


def test_a_check_that_is_stuck_or_fails_is_reported_and_holds_up_no_other():
    ended = threading.Event()

    def stuck() -> Results:
        ended.wait()
        yield Note("too late")

    def failing() -> Results:
        raise ZeroDivisionError("division by zero")
        yield

    checks = {"stuck": stuck, "failing": failing, "fine": lambda: iter([Note("fine")])}
    results = dict(command.run(checks, 0.5))
    ended.set()
    assert results["fine"] == [Note("fine")]
    assert results["stuck"][0].what == "this check did not end within 0.5 s"
    assert results["failing"][0].what == "this check failed (ZeroDivisionError: division by zero)"


def test_the_times_that_checks_take():
    assert (command.DEFAULT_TIMEOUT_S, command.GRACE_S) == (20, 1)
    assert (probe.PERIOD_S, probe.SETTLE_S) == (0.1, 0.5)
    assert (machine_checks.WATCHED_S, machine_checks.STEP_S) == (1, 0.05)
    assert (multicast._HEARD_S, ports._ANSWER_S) == (1, 2)


def test_a_long_text_goes_on_in_the_next_line():
    text = "word " * 30
    first, second = command._wrapped("disk", text).splitlines()
    assert first == f"disk            {' '.join(['word'] * 17)}"
    assert second == f"                     {' '.join(['word'] * 13)}"


def test_people_see_what_is_wrong_and_why_and_what_to_do():
    finding = Finding("error", "the disk is full\x1b[2J", "Logs need room", "Free disk space")
    lines = "".join(command._for_people([("disk", [finding]), ("ports", [Note("free")])]))
    assert lines.splitlines() == [
        "disk            ERROR: the disk is full [2J",
        "                why: Logs need room",
        "                do:  Free disk space",
        "ports           free",
        "found 1 error and 0 warnings",
    ]
    assert "".join(command._for_people([("ports", [Note("free")])])).endswith("nothing wrong\n")


def test_the_exit_code_and_the_json_tell_of_an_error(tmp_path: Path):
    with socket.create_server(("127.0.0.1", 0)) as taken:
        file = tmp_path / "gateway.toml"
        file.write_text(f"port = {taken.getsockname()[1]}\n")
        finished = ros2_gateway("doctor", "--json", "--config", str(file))
    found = json.loads(finished.stdout)
    assert (finished.returncode, finished.stderr, found["ok"]) == (1, "", False)
    (error,) = [each for each in found["findings"] if each["level"] == "error"]
    assert error["check"] == "ports"
    assert error.keys() == {"check", "level", "what", "why", "advice"}
    seen = {each["check"] for each in (*found["findings"], *found["notes"])}
    assert seen <= {"configuration", *CHECKS}
    assert {"check": "configuration", "text": f"reads {file}"} in found["notes"]


def test_warnings_alone_give_exit_code_0(tmp_path: Path):
    file = tmp_path / "gateway.toml"
    file.write_text("port = 0\n")
    finished = ros2_gateway("doctor", "--config", str(file))
    assert finished.returncode == 0, finished.stdout
    assert finished.stdout.splitlines()[-1].startswith("found 0 errors and ")
