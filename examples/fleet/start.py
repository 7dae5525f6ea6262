# SPDX-License-Identifier: Apache-2.0
"""Start a fleet on this computer: robots, a Zenoh router, two relays, and HAProxy.

Run it in the directory of the repository: ``.venv/bin/python examples/fleet/start.py``.
Ctrl-C ends all.
"""

import argparse
import contextlib
import os
import secrets
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
import urllib.request
from collections.abc import Callable
from pathlib import Path

HERE = Path(__file__).parent
GATEWAY = (sys.executable, "-m", "gateway")
RELAYS = ("relay1", "relay2")
START_S = 120
DRAIN_S = 3  # longer than the two checks of HAProxy that a relay may fail


class Fleet:
    """The processes, and the directory with their passwords."""

    def __init__(self, stack: contextlib.ExitStack) -> None:
        self.directory = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        self._stack = stack
        self.processes: dict[str, subprocess.Popen[bytes]] = {}

    def start(self, name: str, *command: str, **environment: str) -> None:
        """Start a process that ends with the fleet."""
        process = subprocess.Popen(command, env={**os.environ, **environment})
        self.processes[name] = process
        self._stack.callback(_end, process)
        print(f"{name}: process {process.pid}", flush=True)

    def password(self, name: str) -> Path:
        """Make a password, and return the file that has it."""
        file = self.directory / name
        file.touch(mode=0o600)
        file.write_text(secrets.token_urlsafe(24))
        return file

    def sign_in(self, section: str, name: str) -> tuple[str, ...]:
        """Return the flags by which a robot or a relay signs in at the router."""
        file = self.directory / name
        return ("--set", f"{section}.user={name}", "--set", f"{section}.user_file={file}")

    def check(self) -> None:
        """Stop if a process has ended."""
        ended = [name for name, process in self.processes.items() if process.poll() is not None]
        for name in ended:
            if name not in RELAYS:  # the other one goes on
                sys.exit(f"{name} has ended: see its lines above")


def main() -> None:
    """Start all, and wait for Ctrl-C."""
    parser = argparse.ArgumentParser(description=__doc__, allow_abbrev=False)
    parser.add_argument("--host", default="127.0.0.1", help="address for viewers")
    parser.add_argument("--port", type=int, default=8080, help="port for viewers (default 8080)")
    parser.add_argument("--robots", type=int, default=1, help="number of robots (default 1)")
    parser.add_argument("--ros", action="store_true", help="simulate robots in ROS: you can drive")
    options = parser.parse_args()
    if shutil.which("haproxy") is None:
        sys.exit("haproxy is not installed: run  sudo apt install haproxy")
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(0))
    with contextlib.suppress(KeyboardInterrupt), contextlib.ExitStack() as stack:
        fleet = Fleet(stack)
        robots = [f"r{number}" for number in range(1, options.robots + 1)]
        address = start_router(fleet, robots)
        for number, robot in enumerate(robots):
            start_robot(fleet, robot, address, number if options.ros else None)
        ports = [start_relay(fleet, name, address) for name in RELAYS]
        for port in ports:
            wait_until_robots(fleet, f"http://127.0.0.1:{port}", robots)
        places = {"FLEET_HOST": options.host, "FLEET_PORT": str(options.port)}
        for name, port in zip(RELAYS, ports, strict=True):
            places[f"FLEET_{name.upper()}"] = str(port)
        fleet.start("haproxy", "haproxy", "-db", "-f", str(HERE / "haproxy.cfg"), **places)
        url = f"http://{options.host}:{options.port}"
        wait_until_robots(fleet, url, robots)
        print(f"ready: {url}/", flush=True)
        while True:
            fleet.check()
            time.sleep(1)


def start_router(fleet: Fleet, robots: list[str]) -> str:
    """Start the router, which knows the robots and relays. Return its address."""
    address = f"tcp/127.0.0.1:{free_port()}"
    lines = [f'listen = ["{address}"]']
    for table, names in (("robots", robots), ("relays", RELAYS)):
        lines.append(f"[{table}]")
        lines += [f'{name} = "{fleet.password(name).read_text()}"' for name in names]
    file = fleet.directory / "router.toml"
    file.touch(mode=0o600)
    file.write_text("\n".join(lines))
    fleet.start("router", *GATEWAY, "router", "--config", str(file))
    host, port = address.removeprefix("tcp/").split(":")
    until(fleet, lambda: socket.create_connection((host, int(port)), 1).close())
    return address


def start_robot(fleet: Fleet, name: str, router: str, domain: int | None) -> None:
    """Start a robot with an uplink: a recording of one, or with a domain a simulation in ROS."""
    simulated = ("--recorded",) if domain is None else ("--domain-id", str(50 + domain))
    uplink = ("--uplink", router, "--robot-name", name, *fleet.sign_in("uplink", name))
    command = (*GATEWAY, "demo", *simulated, "--no-browser", "--port", str(free_port()), *uplink)
    fleet.start(name, *command)


def start_relay(fleet: Fleet, name: str, router: str) -> int:
    """Start a relay. Return its port."""
    port = free_port()
    settings = {
        "relay.drain_s": DRAIN_S,
        "limits.max_clients": 2000,
        "limits.max_clients_per_address": 2000,
        "trusted_proxies": '["127.0.0.1"]',
    }
    flags = [part for key, value in settings.items() for part in ("--set", f"{key}={value}")]
    command = (*GATEWAY, "relay", router, "--port", str(port), *flags)
    fleet.start(name, *command, *fleet.sign_in("relay", name))
    return port


def wait_until_robots(fleet: Fleet, url: str, robots: list[str]) -> None:
    """Wait until a relay, or what is in front of it, is ready for all robots."""

    def ask() -> None:
        for robot in robots:
            urllib.request.urlopen(f"{url}/{robot}/healthz/ready", timeout=5).close()  # noqa: S310

    until(fleet, ask)


def until(fleet: Fleet, attempt: Callable[[], object]) -> None:
    """Try until it works."""
    end_s = time.monotonic() + START_S
    while True:
        fleet.check()
        try:
            attempt()
        except OSError as error:
            if time.monotonic() > end_s:
                sys.exit(f"not ready within {START_S} s: {error}")
            time.sleep(0.5)
        else:
            return


def free_port() -> int:
    """Return a port of this computer that nobody uses."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


def _end(process: "subprocess.Popen[bytes]") -> None:
    process.terminate()
    try:
        process.wait(DRAIN_S + 5)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()


if __name__ == "__main__":
    main()
