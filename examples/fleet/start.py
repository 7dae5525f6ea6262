# SPDX-License-Identifier: Apache-2.0
"""Start a fleet on this computer: robots, a Zenoh router, two relays, and a load balancer.

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
BALANCERS = ("haproxy", "nginx")
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
    parser.add_argument("--domain-id", type=int, default=50, help="of the first one (default 50)")
    parser.add_argument("--balancer", choices=BALANCERS, default="haproxy", help="(haproxy)")
    options = parser.parse_args()
    if shutil.which(options.balancer) is None:
        sys.exit(f"{options.balancer} is not installed: run  sudo apt install {options.balancer}")
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(0))
    with contextlib.suppress(KeyboardInterrupt), contextlib.ExitStack() as stack:
        fleet = Fleet(stack)
        robots = [f"r{number}" for number in range(1, options.robots + 1)]
        address = start_router(fleet, robots)
        for number, robot in enumerate(robots):
            domain = options.domain_id + number if options.ros else None
            start_robot(fleet, robot, address, domain)
        ports = [start_relay(fleet, name, address) for name in RELAYS]
        for port in ports:
            wait_until_robots(fleet, f"http://127.0.0.1:{port}", robots)
        start_balancer = start_nginx if options.balancer == "nginx" else start_haproxy
        start_balancer(fleet, options.host, options.port, ports)
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
    simulated = ("--recorded",) if domain is None else ("--domain-id", str(domain))
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
    print(f"{name}: http://127.0.0.1:{port}/", flush=True)
    return port


def start_haproxy(fleet: Fleet, host: str, port: int, relays: list[int]) -> None:
    """Start HAProxy in front of the relays."""
    places = {"FLEET_HOST": host, "FLEET_PORT": str(port)}
    for name, relay in zip(RELAYS, relays, strict=True):
        places[f"FLEET_{name.upper()}"] = str(relay)
    fleet.start("haproxy", "haproxy", "-db", "-f", str(HERE / "haproxy.cfg"), **places)


def start_nginx(fleet: Fleet, host: str, port: int, relays: list[int]) -> None:
    """Start nginx in front of the relays, with the ports of this fleet in place of the usual."""
    text = (HERE / "nginx.conf").read_text().replace("listen 8080", f"listen {host}:{port}")
    for usual, relay in zip(("9091", "9092"), relays, strict=True):
        text = text.replace(f"127.0.0.1:{usual}", f"127.0.0.1:{relay}")
    ours = fleet.directory / "fleet.conf"
    ours.write_text(text)
    kept = ("client_body", "proxy", "fastcgi", "uwsgi", "scgi")
    http = [f"{each}_temp_path {fleet.directory}/{each};" for each in kept]
    main = fleet.directory / "nginx.conf"
    main.write_text(
        f"daemon off; error_log stderr; pid {fleet.directory}/nginx.pid;\n"
        f"events {{ worker_connections 4000; }}\n"
        f"http {{ access_log off; {' '.join(http)} include {ours}; }}\n"
    )
    fleet.start("nginx", "nginx", "-e", "stderr", "-c", str(main))
    print(f"nginx: {ours}", flush=True)


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
