# SPDX-License-Identifier: Apache-2.0
"""The uplink of a gateway: it connects to a router, for as long as the gateway serves."""

import asyncio
import contextlib
import logging
import re
import socket
from collections.abc import AsyncIterator, Sequence
from typing import Final

from gateway.access.permissions import Identity, Policy
from gateway.codec.types import Types
from gateway.config.model import Config
from gateway.core.router import Router
from gateway.errors import RosStartError
from gateway.faults import Fault
from gateway.sources.zenoh.options import ZenohOptions
from gateway.uplink.link import UplinkLink
from gateway.uplink.offer import MAX_ENTITIES, Offering
from gateway.uplink.opening import NameTakenError, Opened, in_thread, open_sessions, options_of
from gateway.uplink.session import NAME

RETRY_S: Final = 2.0
MAX_ROBOT_NAME: Final = 32

_CONNECTING: Final = "the uplink is connecting to its Zenoh router"
_TAKEN: Final = (
    "another robot is connected to the Zenoh router of the uplink by this robot's name: give one of"
    " them another name with uplink.robot_name"
)
_REFUSED: Final = (
    "the Zenoh router of the uplink passes nothing on: use the credentials of this robot's name, or"
    " allow them the keys of this name in the router's access control"
)

_FAILED: Final = "the uplink has failed and tries again: look at the log of the gateway"

logger = logging.getLogger(__name__)


@contextlib.asynccontextmanager
async def uplinked(
    core: Router, types: Types, config: Config, policy: Policy
) -> AsyncIterator["Uplink"]:
    """Offer the robot through the router of the configuration.

    Raises:
        ConfigError: a file of the configuration cannot be read.
    """
    uplink = Uplink(core, types, config, policy)
    task = asyncio.create_task(uplink.run())
    try:
        yield uplink
    finally:
        task.cancel()
        await asyncio.wait([task])


class Uplink:
    """Connects, and connects again whenever the connection is lost."""

    def __init__(self, core: Router, types: Types, config: Config, policy: Policy) -> None:
        self._core, self._types, self._config = core, types, config
        self.robot = config.uplink.robot_name or own_name(socket.gethostname())
        self._options: ZenohOptions = options_of(config.uplink, self.robot)
        self._identity = Identity(NAME, policy.of(config.uplink.role))
        self._offering = Offering(types, config.control.topics)
        self._link: UplinkLink | None = None
        self._why = _CONNECTING
        self._lost = asyncio.Event()

    @property
    def link(self) -> UplinkLink | None:
        """The connection, while there is one."""
        return self._link

    async def run(self) -> None:
        """Serve until this is cancelled."""
        while True:
            try:
                await self._serve_once()
            except NameTakenError:
                self._note(_TAKEN)
            except RosStartError as error:
                self._note(str(error))
            except Exception:  # a fault of ours or of Zenoh: the robot goes on, and this as well
                logger.exception("the uplink has failed")
                self._note(_FAILED)
            await asyncio.sleep(RETRY_S)

    async def _serve_once(self) -> None:
        await self._offering.prepare(self._core.ros.graph())
        await self._serve(await in_thread(lambda: open_sessions(self._options)))

    def reload(self, policy: Policy) -> None:
        """Give viewers other rights. If these are others, the connection begins again."""
        permissions = policy.of(self._config.uplink.role)
        has_changed = permissions.rules != self._identity.permissions.rules
        self._identity = Identity(NAME, permissions)
        if has_changed:
            self._lost.set()

    def faults(self) -> Sequence[Fault]:
        """Return what is wrong with the uplink."""
        if self._why:
            return (Fault("degraded", self._why),)
        link = self._link
        faults = []
        if link is not None and link.offer.left_out:
            text = f"the robot has more than {MAX_ENTITIES} nodes and endpoints, and the uplink"
            text = f"{text} leaves the others out: give uplink.role a role that sees less"
            faults.append(Fault("degraded", text))
        return faults

    async def _serve(self, opened: Opened) -> None:
        self._lost.clear()
        link = UplinkLink(
            self._core,
            self._types,
            self._config,
            self._identity,
            opened,
            self._offering,
            self._lost.set,
        )
        self._link = link
        try:
            proving = asyncio.create_task(self._prove(link))
            try:
                await self._lost.wait()
            finally:
                proving.cancel()
            self._note(_CONNECTING if link.is_proved else _REFUSED)
        finally:
            self._link = None
            link.close()

    async def _prove(self, link: UplinkLink) -> None:
        await link.pace.proved.wait()
        self._why = ""
        logger.info("the robot is offered as %s", self.robot)

    def _note(self, why: str) -> None:
        if why not in {self._why, _CONNECTING}:
            logger.warning("%s", why)
        self._why = why


def own_name(host: str) -> str:
    """Return the name of a machine as that of a robot."""
    name = re.sub("[^a-z0-9_-]+", "-", host.partition(".")[0].lower())
    return name[:MAX_ROBOT_NAME] or "robot"
