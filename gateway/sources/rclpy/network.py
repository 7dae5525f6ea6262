# SPDX-License-Identifier: Apache-2.0
"""A network that comes after ROS has started: Fast DDS uses only the addresses of its start."""

import logging
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Final

from gateway.faults import Fault
from gateway.sources.options import ZENOH_RMW

ROUTES: Final = Path("/proc/net/route")  # a line of titles, and one per route. `lo` has none

_logger = logging.getLogger(__name__)


class NetworkAtStart:
    """Reports a network that ROS does not use. Make it before ROS starts."""

    def __init__(self, environment: Mapping[str, str], routes: Path = ROUTES) -> None:
        self._routes = routes
        self.reach = environment.get("ROS_AUTOMATIC_DISCOVERY_RANGE") or "SUBNET"
        if environment.get("ROS_LOCALHOST_ONLY") == "1":
            self.reach = "LOCALHOST"
        if environment.get("RMW_IMPLEMENTATION") == ZENOH_RMW:
            self.reach = "ROUTER"  # Zenoh opens connections to it whenever there is a network
        is_far = self.reach not in {"LOCALHOST", "OFF", "ROUTER"}
        self._is_missing = is_far and not self._has_network()
        if self._is_missing:
            _logger.warning(
                "this computer has no network, so ROS finds only robots on it: connect the network"
                " and restart the gateway, if a robot is elsewhere"
            )

    def faults(self) -> Sequence[Fault]:
        """Return that the network has come too late, if it has."""
        if not self._is_missing or not self._has_network():
            return ()
        text = "the network came after the start, so ROS does not use it: restart the gateway"
        return (Fault("degraded", text),)

    def _has_network(self) -> bool:
        try:
            return len(self._routes.read_text().splitlines()) > 1
        except OSError:  # another system: nobody knows
            return True
