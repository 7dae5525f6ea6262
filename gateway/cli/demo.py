# SPDX-License-Identifier: Apache-2.0
"""The demonstration: the gateway in this process, the simulated robot in a child process.

The child's standard input is a pipe whose other end this process holds. When it closes, the child
sends itself SIGINT. So the child ends however this process ends: orderly or by SIGKILL, when the
kernel closes the pipe. The child has a separate process group, so Ctrl-C reaches only the gateway,
which closes its clients while the robot still runs.
"""

import os
import signal
import socket
import subprocess
import sys
import threading
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Final

from gateway.errors import BindError, RobotDiedError

if TYPE_CHECKING:
    from gateway.config.model import Config

STOP_TIMEOUT_S: Final = 1.0  # with the gateway's own second, the 2 s of a shutdown

# NAMESPACE/ is before the names of a robot in a namespace, FRAMES/ before its frames
_HINT: Final = """\
in a browser, open  PAGE
in another terminal, connect with  WSCAT  and paste:
  {"op":"subscribe","topic":"NAMESPACE/odom","fields":["pose.pose.position"],"throttle_rate":1000}
  DRIVE
  {"op":"lookup_transform","target_frame":"FRAMES/map","source_frame":"FRAMES/base_scan","timeout":10}
  {"op":"send_action_goal","id":"go","action":"NAMESPACE/navigate_to_pose",\
"args":{"pose":{"pose":{"position":{"x":2.5,"y":1.5}}}},"feedback":true}
  {"op":"cancel_action_goal","id":"go","action":"NAMESPACE/navigate_to_pose"}
  help
Ctrl-C ends the gateway and the robot"""
_DRIVE: Final = """\
{"op":"publish","topic":"NAMESPACE/cmd_vel","type":"geometry_msgs/msg/Twist",\
"msg":{"linear":{"x":0.2}}}"""
_DRIVE_STAMPED: Final = """\
{"op":"publish","topic":"NAMESPACE/cmd_vel","type":"geometry_msgs/msg/TwistStamped",\
"msg":{"twist":{"linear":{"x":0.2}}}}"""


def with_robot(config: "Config") -> "Config":
    """Return a configuration that knows what moves the robot, which is in the gateway's namespace.

    Command topics that the operator names stay as they are.
    """
    namespace = _namespace(config)
    if not namespace or "topics" in config.control.model_fields_set:
        return config
    control = config.control.model_copy(update={"topics": (f"{namespace}/cmd_vel",)})
    return config.model_copy(update={"control": control})


def lines_to_paste(config: "Config", *, twist_stamped: bool = False) -> str:
    """Return lines that a newcomer can try. WSCAT and PAGE stand for how to connect."""
    namespace = _namespace(config)
    frames = f"{namespace.strip('/')}/" if namespace else ""
    lines = _HINT.replace("DRIVE", _DRIVE_STAMPED if twist_stamped else _DRIVE)
    return lines.replace("NAMESPACE", namespace).replace("FRAMES/", frames)


def robot_command(config: "Config", *, twist_stamped: bool = False) -> list[str]:
    """Return the command that runs the simulated robot for as long as we hold its stdin open."""
    command = [sys.executable, "-m", "gateway", "sim", "--until-stdin-closes"]
    if namespace := _namespace(config):
        command += ["--namespace", namespace]
    return [*command, "--twist-stamped"] if twist_stamped else command


def require_free_port(host: str, port: int) -> None:
    """Look for a gateway that runs already: a second robot would drive by the first one's topics.

    Raises:
        BindError: the port is in use.
    """
    try:
        family, _, _, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
        socket.create_server(address[:2], family=family).close()
    except OSError as error:
        raise BindError(host, port, error) from error


def run(serve: Callable[[], int], robot: Sequence[str]) -> int:
    """Serve while the command *robot* runs, and return the exit code of *serve*.

    *serve* blocks until SIGINT or SIGTERM. It gets a SIGINT if the robot ends first. Call it on
    the main thread.

    Raises:
        RobotDiedError: the robot ended before the gateway did.
    """
    child = subprocess.Popen(robot, stdin=subprocess.PIPE, start_new_session=True)
    serving, stopping = threading.Event(), threading.Event()

    def watch() -> None:
        serving.wait()  # an earlier interrupt would come before `try`
        child.wait()
        if not stopping.is_set():
            _interrupt_main_thread()

    watcher = threading.Thread(target=watch, name="robot", daemon=True)
    watcher.start()
    try:
        serving.set()
        return serve()
    finally:  # also if the end of the robot interrupted serve
        stopping.set()
        exit_code = child.poll()
        if child.stdin:
            child.stdin.close()
        watcher.join(STOP_TIMEOUT_S)
        child.kill()
        watcher.join()
        if exit_code is not None:
            raise RobotDiedError(exit_code)


def end_with_stdin() -> None:
    """End this process when its standard input closes: by SIGINT, or else at once."""

    def watch() -> None:
        while os.read(0, 4096):
            pass
        _interrupt_main_thread()
        # this thread is a daemon: it passes the wait only if the process does not end
        threading.Event().wait(STOP_TIMEOUT_S)
        os._exit(1)

    threading.Thread(target=watch, name="stdin", daemon=True).start()


def _namespace(config: "Config") -> str:
    """Return the namespace of the robot, empty if it is in none."""
    return config.ros.namespace.rstrip("/")


def _interrupt_main_thread() -> None:
    # Python's handlers run on the main thread. Sent there, the signal also ends its system call
    signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGINT)
