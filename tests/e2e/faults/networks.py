# SPDX-License-Identifier: Apache-2.0
"""Four machines in a row, as network namespaces: viewer, relay, router, robot.

Neighbours have a link, which can be cut: then nothing arrives, in both directions, and no end is
told. The namespaces end with their holders, which are processes.
"""

import contextlib
import itertools
import json
import subprocess
from collections.abc import Iterator
from dataclasses import dataclass

MACHINES = ("viewer", "relay", "router", "robot")
NOWHERE = "02:00:00:00:00:99"  # a MAC address that nobody has


def run(*command: str) -> str:
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(f"{' '.join(command)}: {done.stderr.strip()}")
    return done.stdout


def reason_against() -> str | None:
    """Return why there can be none here, or None."""
    try:
        run("unshare", "--net", "ip", "link", "add", "x", "type", "veth", "peer", "name", "y")
    except (FileNotFoundError, RuntimeError) as error:
        return f"network namespaces need root and iproute2: {error}"
    return None


@dataclass(frozen=True)
class End:
    """One end of a link."""

    enter: tuple[str, ...]
    device: str
    address: str
    mac: str


class Cable:
    """The link between two machines."""

    def __init__(self, ends: tuple[End, End]) -> None:
        self.ends = ends

    def cut(self, is_cut: bool) -> None:
        """Let nothing arrive, or mend it."""
        for end, other in itertools.permutations(self.ends):
            mac = NOWHERE if is_cut else other.mac
            run(
                *(*end.enter, "ip", "neigh", "replace", other.address),
                *("lladdr", mac, "dev", end.device, "nud", "permanent"),
            )


class Machines:
    """The namespaces, by the names of the machines."""

    def __init__(self, pids: dict[str, int]) -> None:
        self.enter = {
            name: ("nsenter", "--net", "--target", str(pid)) for name, pid in pids.items()
        }
        self.cables: dict[tuple[str, str], Cable] = {}
        for number, pair in enumerate(itertools.pairwise(MACHINES)):
            self.cables[pair] = self._connect(number, pids, pair)

    def address(self, of: str, towards: str) -> str:
        """Return the address of a machine on its link to a neighbour."""
        pair = (of, towards) if (of, towards) in self.cables else (towards, of)
        return self.cables[pair].ends[pair.index(of)].address

    def _connect(self, number: int, pids: dict[str, int], pair: tuple[str, str]) -> Cable:
        devices = (f"to_{pair[1]}", f"to_{pair[0]}")
        run(
            *(*self.enter[pair[0]], "ip", "link", "add", devices[0], "type", "veth"),
            *("peer", "name", devices[1], "netns", str(pids[pair[1]])),
        )
        ends = []
        for side, (name, device) in enumerate(zip(pair, devices, strict=True)):
            enter, address = self.enter[name], f"10.79.{number}.{side + 1}"
            run(*enter, "ip", "address", "add", f"{address}/24", "dev", device)
            run(*enter, "ip", "link", "set", device, "up")
            [link] = json.loads(run(*enter, "ip", "-json", "link", "show", device))
            ends.append(End(enter, device, address, link["address"]))
        return Cable((ends[0], ends[1]))


@contextlib.contextmanager
def machines() -> Iterator[Machines]:
    with contextlib.ExitStack() as stack:
        pids = {}
        for name in MACHINES:
            # a process that keeps the network alive, and names it
            command = ("unshare", "--net", "sh", "-c", "ip link set lo up && echo up && exec cat")
            holder = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
            stack.enter_context(holder)
            stack.callback(holder.kill)
            assert holder.stdout is not None
            assert holder.stdout.readline() == b"up\n"
            pids[name] = holder.pid
        yield Machines(pids)
