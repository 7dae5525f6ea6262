# SPDX-License-Identifier: Apache-2.0
"""The demonstration's two processes: who ends whom, in which order. Robots here are stand-ins."""

import os
import signal
import subprocess
import sys
import textwrap
import threading
import time
from collections.abc import Sequence
from pathlib import Path

import pytest

from gateway.cli import demo
from gateway.config.control import ControlConfig
from gateway.config.model import Config, RosConfig
from gateway.errors import RobotDiedError

ROOT = Path(__file__).parents[2]
TIMEOUT_S = 120  # generous: other tests share the machine


def python(source: str) -> list[str]:
    return [sys.executable, "-c", textwrap.dedent(source)]


def in_namespace(namespace: str, **control: object) -> Config:
    return Config(ros=RosConfig(namespace=namespace), control=ControlConfig(**control))  # type: ignore[arg-type]  # of any


def test_the_robot_is_in_the_namespace_of_the_gateway_and_its_command_topic_is_known():
    config = in_namespace("/a/b")
    assert demo.robot_command(config)[-2:] == ["--namespace", "/a/b"]
    assert demo.with_robot(config).control.topics == ("/a/b/cmd_vel",)
    lines = demo.lines_to_paste(config)
    assert '"target_frame":"a/b/map","source_frame":"a/b/base_scan"' in lines
    assert '"topic":"/a/b/cmd_vel"' in lines
    named = in_namespace("/a", topics=("/wheels",))
    assert demo.with_robot(named) is named


def test_without_a_namespace_the_robot_has_the_names_of_the_readme():
    config = in_namespace("/")
    assert "--namespace" not in demo.robot_command(config)
    assert demo.with_robot(config) is config
    assert '"target_frame":"map","source_frame":"base_scan"' in demo.lines_to_paste(config)


# A robot that says when it runs and how it was ended.
OBEDIENT = """
    import pathlib, signal, threading
    from gateway.cli.demo import end_with_stdin
    stop = threading.Event()
    signal.signal(signal.SIGINT, lambda *_: stop.set())
    end_with_stdin()
    pathlib.Path({started!r}).touch()
    stop.wait()
    pathlib.Path({stopped!r}).touch()
"""


def wait_for(path: Path) -> None:
    waiting = threading.Event()
    for _ in range(TIMEOUT_S * 50):
        if path.exists():
            return
        waiting.wait(0.02)
    pytest.fail(f"{path.name} did not appear")


def wait_until_gone(pid: int) -> None:
    waiting = threading.Event()
    for _ in range(TIMEOUT_S * 50):
        stat = Path(f"/proc/{pid}/stat")
        # an orphan that ended may stay a zombie where no init reaps it
        if not stat.exists() or stat.read_text().rpartition(")")[2].split()[0] == "Z":
            return
        waiting.wait(0.02)
    pytest.fail(f"process {pid} is still there")


@pytest.fixture
def obedient(tmp_path) -> list[str]:
    started, stopped = str(tmp_path / "started"), str(tmp_path / "stopped")
    return python(OBEDIENT.format(started=started, stopped=stopped))


def test_the_robot_is_stopped_by_sigint_after_the_gateway_is_done(tmp_path, obedient):
    def serve() -> int:
        wait_for(tmp_path / "started")
        assert not (tmp_path / "stopped").exists()
        return 0

    assert demo.run(serve, obedient) == 0
    assert (tmp_path / "stopped").exists()


def test_the_robot_is_stopped_when_the_gateway_fails(tmp_path, obedient):
    def serve() -> int:
        wait_for(tmp_path / "started")
        raise OSError("no port")

    with pytest.raises(OSError, match="no port"):
        demo.run(serve, obedient)
    assert (tmp_path / "stopped").exists()


def test_a_robot_that_ends_by_itself_ends_the_gateway_and_is_named():
    interrupted = threading.Event()

    def serve() -> int:
        try:
            threading.Event().wait(TIMEOUT_S)
        except KeyboardInterrupt:
            interrupted.set()
        return 0

    with pytest.raises(RobotDiedError, match="ended by itself with exit code 7"):
        demo.run(serve, python("raise SystemExit(7)"))
    assert interrupted.is_set()


def test_a_robot_that_ends_while_the_gateway_starts_is_named_and_not_what_it_broke():
    def serve() -> int:
        try:
            threading.Event().wait(TIMEOUT_S)
        except KeyboardInterrupt as error:
            raise ImportError("initialization failed") from error
        return 0

    with pytest.raises(RobotDiedError, match="exit code 7"):
        demo.run(serve, python("raise SystemExit(7)"))


def test_a_robot_that_ends_before_the_gateway_starts_is_named(tmp_path, monkeypatch):
    robot = python(f"import pathlib; pathlib.Path({str(tmp_path / 'ended')!r}).touch()")
    start = threading.Thread.start

    def start_slowly(thread: threading.Thread) -> None:
        start(thread)
        wait_for(tmp_path / "ended")
        time.sleep(0.5)  # the process ends in this time, and nothing may interrupt us

    monkeypatch.setattr(threading.Thread, "start", start_slowly)
    with pytest.raises(RobotDiedError, match="exit code 0"):
        demo.run(lambda: threading.Event().wait(TIMEOUT_S), robot)


def test_the_gateway_and_then_the_robot_end_within_two_seconds():
    assert demo.STOP_TIMEOUT_S + Config().limits.close_timeout_s <= 2


def test_a_robot_that_does_not_end_is_killed(tmp_path):
    pid_file = tmp_path / "pid"
    stubborn = python(f"""
        import os, pathlib, threading
        pathlib.Path({str(pid_file)!r} + "~").write_text(str(os.getpid()))
        os.rename({str(pid_file)!r} + "~", {str(pid_file)!r})
        threading.Event().wait()
    """)

    def serve() -> int:
        wait_for(pid_file)
        return 0

    assert demo.run(serve, stubborn) == 0
    assert not Path(f"/proc/{pid_file.read_text()}").exists()


def test_a_robot_that_has_hardly_started_is_stopped_without_a_word(capfd):
    robot = python("""
        from gateway.cli.main import main
        raise SystemExit(main(["sim", "--until-stdin-closes"]))
    """)
    assert demo.run(lambda: 0, robot) == 0
    assert capfd.readouterr().err == ""


def test_ctrl_c_reaches_the_gateway_alone(tmp_path, obedient):
    """A terminal sends SIGINT to a whole process group: the robot is in another."""
    others = children()  # of other tests

    def serve() -> int:
        wait_for(tmp_path / "started")
        robots = [child for child in children() if child not in others]
        assert robots
        assert [os.getpgid(robot) for robot in robots] == robots
        return 0

    assert demo.run(serve, obedient) == 0


def children() -> list[int]:
    return [int(pid) for pid in Path("/proc/thread-self/children").read_text().split()]


@pytest.mark.parametrize("signal_number", [signal.SIGKILL, signal.SIGTERM])
def test_the_robot_ends_however_the_demonstration_ends(tmp_path, signal_number):
    pid_file = tmp_path / "pid"
    robot: Sequence[str] = python(f"""
        import os, pathlib, threading
        from gateway.cli.demo import end_with_stdin
        end_with_stdin()
        pathlib.Path({str(pid_file)!r} + "~").write_text(str(os.getpid()))
        os.rename({str(pid_file)!r} + "~", {str(pid_file)!r})
        threading.Event().wait()
    """)
    demonstration = subprocess.Popen(
        python(f"""
            import threading
            from gateway.cli import demo
            demo.run(lambda: threading.Event().wait(), {robot!r})
        """),
        cwd=ROOT,
        stderr=subprocess.DEVNULL,
    )
    try:
        wait_for(pid_file)
        demonstration.send_signal(signal_number)
        demonstration.wait(TIMEOUT_S)
    finally:
        demonstration.kill()
        demonstration.wait()
    wait_until_gone(int(pid_file.read_text()))


def test_a_process_that_does_not_heed_its_sigint_ends_with_stdin_all_the_same():
    stubborn = subprocess.Popen(
        python("""
            import signal, threading
            from gateway.cli.demo import end_with_stdin
            signal.signal(signal.SIGINT, signal.SIG_IGN)
            end_with_stdin()
            threading.Event().wait()
        """),
        cwd=ROOT,
        stdin=subprocess.PIPE,
    )
    try:
        stubborn.communicate(timeout=TIMEOUT_S)
    finally:
        stubborn.kill()
    assert stubborn.returncode == 1
