# SPDX-License-Identifier: Apache-2.0
"""Two networks of this machine, and a bad link between them: namespaces and ``tc tbf``.

Robot and server run in the near one, clients in the far one. They take root, and end with the
benchmark.
"""

import contextlib
import json
import os
import shutil
import subprocess
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from benchmarks.errors import BenchmarkError

_NEAR_ADDRESS: Final = "10.78.0.1"
_FAR_ADDRESS: Final = "10.78.0.2"
_NOWHERE: Final = "02:00:00:00:00:99"  # a MAC address that nobody has
# The queue of a router before a slow link: longer than anybody wants to wait.
_ROUTERS_QUEUE_MS: Final = 1000
_START_S: Final = 30.0
_MIN_BURST_BYTES: Final = 3000  # two packets. ``tbf`` needs one, and 10 ms of the rate


@dataclass(frozen=True)
class TwoNetworks:
    """The commands that run a program in either, and the link."""

    near: tuple[str, ...]
    far: tuple[str, ...]
    near_mac: str
    far_mac: str
    url_host: str = _NEAR_ADDRESS

    def shape(self, bits_per_s: int) -> None:
        """Let so many bits per second pass, in each direction."""
        burst = max(_MIN_BURST_BYTES, bits_per_s // 800)
        shape = ("rate", str(bits_per_s), "burst", str(burst), "latency", f"{_ROUTERS_QUEUE_MS}ms")
        for side, device in ((self.near, "near"), (self.far, "far")):
            _run(*side, "tc", "qdisc", "replace", "dev", device, "root", "tbf", *shape)

    def lose(self, percent: int) -> bool:
        """Lose so many packets, in each direction. Return whether this machine can."""
        if shutil.which("nft") is None:
            return False
        for side in (self.near, self.far):
            rule = f"tcp dport != 0 numgen random mod 100 < {percent} drop"
            _run(*side, "nft", "flush", "ruleset")
            _run(*side, "nft", "add", "table", "inet", "loss")
            hook = "{ type filter hook input priority 0 ; }"
            _run(*side, "nft", "add", "chain", "inet", "loss", "input", hook)
            _run(*side, "nft", "add", "rule", "inet", "loss", "input", f"iifname != lo {rule}")
        return True

    def cut(self, *, is_cut: bool) -> None:
        """Let nothing arrive, or let everything arrive again. The interfaces stay."""
        for side, device, address, mac in (
            (self.near, "near", _FAR_ADDRESS, self.far_mac),
            (self.far, "far", _NEAR_ADDRESS, self.near_mac),
        ):
            lladdr = ("lladdr", _NOWHERE if is_cut else mac, "dev", device, "nud", "permanent")
            _run(*side, "ip", "neigh", "replace", address, *lladdr)


def reason_against() -> str | None:
    """Return why there can be no such networks here, or ``None``."""
    for tool in ("unshare", "nsenter", "ip", "tc"):
        if shutil.which(tool) is None:
            return f"{tool} is not installed"
    tried = subprocess.run(["unshare", "--net", "true"], capture_output=True, check=False)
    return None if tried.returncode == 0 else "network namespaces need root"


@contextlib.contextmanager
def two_networks() -> Iterator[TwoNetworks]:
    """Have them until the end."""
    with _network() as near, _network() as far:
        peer = ("peer", "name", "far", "netns", far[-1])
        _run(*near, "ip", "link", "add", "near", "type", "veth", *peer)
        for side, device, address in (
            (near, "near", _NEAR_ADDRESS),
            (far, "far", _FAR_ADDRESS),
        ):
            _run(*side, "ip", "address", "add", f"{address}/24", "dev", device)
            _run(*side, "ip", "link", "set", device, "up")
        yield TwoNetworks(near, far, _mac(near, "near"), _mac(far, "far"))


@contextlib.contextmanager
def _network() -> Iterator[tuple[str, ...]]:
    """Make a network with a loopback interface. Yield the command that enters it."""
    with subprocess.Popen(["unshare", "--net", "cat"], stdin=subprocess.PIPE) as holder:
        try:
            deadline_s = time.monotonic() + _START_S
            while _namespace(holder.pid) == _namespace(os.getpid()):
                if time.monotonic() > deadline_s:
                    raise BenchmarkError(f"no network namespace within {_START_S:g} s")
                time.sleep(0.01)
            enter = ("nsenter", "--net", "--target", str(holder.pid))
            _run(*enter, "ip", "link", "set", "lo", "up")
            yield enter
        finally:
            holder.kill()


def _namespace(pid: int) -> Path:
    return Path(f"/proc/{pid}/ns/net").readlink()


def _mac(enter: tuple[str, ...], device: str) -> str:
    return str(json.loads(_run(*enter, "ip", "-json", "link", "show", device))[0]["address"])


def _run(*command: str) -> str:
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        raise BenchmarkError(f"{' '.join(command)}: {done.stderr.strip()}")
    return done.stdout
