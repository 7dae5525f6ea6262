# SPDX-License-Identifier: Apache-2.0
"""The test whether this machine hears the multicast that it sends, as discovery needs."""

import contextlib
import socket
import struct
from typing import Final

from gateway.errors import system_reason

_GET_FLAGS: Final = 0x8913  # SIOCGIFFLAGS of netdevice(7)
_UP: Final = 0x1  # IFF_UP
_MULTICAST: Final = 0x1000  # IFF_MULTICAST
_GROUP: Final = "239.255.0.1"  # of DDSI-RTPS, 9.6.1.4.1
_HEARD_S: Final = 1  # within this machine it takes less than a millisecond


def multicast_fault() -> str | None:
    """Return why no interface can do multicast, ``None`` if one can."""
    names = [name for name in _able() if name != "lo"]
    if not names:
        return "no network interface that is up can do multicast"
    faults = [fault for name in names if (fault := _fault_of(name))]
    return ", ".join(faults) if len(faults) == len(names) else None


def _able() -> list[str]:
    import fcntl  # Windows has none

    found = []
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as any_socket:
        for _, name in socket.if_nameindex():
            asked = struct.pack("16sH22x", name.encode(), 0)  # ifreq
            with contextlib.suppress(OSError):  # it has gone
                _, flags = struct.unpack("16sH22x", fcntl.ioctl(any_socket, _GET_FLAGS, asked))
                if flags & _UP and flags & _MULTICAST:
                    found.append(name)
    return found


def _fault_of(interface: str) -> str | None:
    index = socket.if_nametoindex(interface)
    group = struct.pack("4s4si", socket.inet_aton(_GROUP), bytes(4), index)  # ip_mreqn
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.settimeout(_HEARD_S)
        try:
            probe.bind((_GROUP, 0))
            probe.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, group)
            probe.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, group)
            probe.sendto(b"ros2-gateway doctor", probe.getsockname())
            probe.recv(64)
        except TimeoutError:
            return f"{interface} does not hear it, perhaps because of a firewall"
        except OSError as error:
            return f"{interface} cannot send it, {system_reason(error)}"
    return None
