# SPDX-License-Identifier: Apache-2.0
"""The uplink of a configuration. Without one, nothing of Zenoh is needed."""

import contextlib
from collections.abc import AsyncIterator, Sequence
from typing import TYPE_CHECKING

from gateway.access.permissions import Policy
from gateway.codec.types import Types
from gateway.config.model import Config
from gateway.core.router import Router
from gateway.errors import HOW_TO_GET_ZENOH, ConfigError
from gateway.faults import Fault

if TYPE_CHECKING:
    from gateway.uplink.uplink import Uplink


class ConfiguredUplink:
    """The uplink, if there is one."""

    def __init__(self, uplink: "Uplink | None" = None) -> None:
        self._uplink = uplink

    def reload(self, policy: Policy) -> None:
        """Give viewers other rights."""
        if self._uplink is not None:
            self._uplink.reload(policy)

    def faults(self) -> Sequence[Fault]:
        """Return what is wrong with it."""
        return () if self._uplink is None else self._uplink.faults()


@contextlib.asynccontextmanager
async def uplink_of(core: Router, types: Types, config: Config) -> AsyncIterator[ConfiguredUplink]:
    """Offer the robot, if the configuration says so. A router that is not there is a fault.

    Raises:
        ConfigError: the packages that speak Zenoh are missing, or a file cannot be read.
    """
    if config.uplink.endpoint is None:
        yield ConfiguredUplink()
        return
    try:
        from gateway.uplink.uplink import uplinked
    except ModuleNotFoundError as error:
        package = str(error.name).partition(".")[0]
        raise ConfigError(f"uplink.endpoint: {package} is missing: {HOW_TO_GET_ZENOH}") from error
    async with uplinked(core, types, config, Policy(config.access)) as uplink:
        yield ConfiguredUplink(uplink)
