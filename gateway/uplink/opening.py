# SPDX-License-Identifier: Apache-2.0
"""The sessions of an uplink with its router. Only a thread opens and closes them."""

import asyncio
import threading
from collections.abc import Callable
from typing import Any, Final, NamedTuple, TypeVar

from gateway.config.zenoh import UplinkConfig
from gateway.sources.zenoh.access import link_settings
from gateway.sources.zenoh.options import ZenohOptions
from gateway.sources.zenoh.session import open_session

# Relays look for it: this robot is there.
ALIVE: Final = "alive"
# Each uplink of this robot's name has one, with the id of its session behind it.
ROBOT: Final = "robot"
LOOK_S: Final = 2.0

_REMEDY: Final = "start the router, and check uplink.endpoint and the firewall"

_Result = TypeVar("_Result")


class NameTakenError(Exception):
    """Raised if another robot that is connected has this robot's name."""


class Opened(NamedTuple):
    """Two sessions: what the first one sends, the second one gets back from the router."""

    zenoh: Any
    echo: Any
    kept: list[Any]  # tokens and subscribers, which hold as long as they exist

    def close(self) -> None:
        """End both. A router that hangs keeps this for 10 s."""
        self.zenoh.close()
        self.echo.close()


def options_of(config: UplinkConfig, robot: str) -> ZenohOptions:
    """Return how to connect.

    Raises:
        ConfigError: a file cannot be read, or settings contradict each other.
    """
    return ZenohOptions(
        config.endpoint or "",
        overrides=config.settings,
        settings=link_settings(config, "uplink"),
        namespace=f"gw/{robot}",
        section="uplink",
        given_by="uplink.endpoint or uplink.settings",
        remedy=_REMEDY,
    )


def open_sessions(options: ZenohOptions) -> Opened:
    """Connect, and take the name. This blocks.

    Raises:
        NameTakenError: another robot has it.
        RosStartError: the router cannot be reached.
    """
    zenoh = open_session(options)
    try:
        liveliness = zenoh.liveliness()
        own = f"{ROBOT}/{zenoh.info.zid()}"
        tokens = [liveliness.declare_token(own)]
        # after that: of two that come at the same time, both leave, and try again
        _check_alone(liveliness, own)
        tokens.append(liveliness.declare_token(ALIVE))
        return Opened(zenoh, open_session(options), tokens)
    except BaseException:
        zenoh.close()
        raise


async def in_thread(call: Callable[[], _Result]) -> _Result:
    """Return what a call returns that may block for long. At a shutdown, nobody waits for it."""
    loop = asyncio.get_running_loop()
    future: asyncio.Future[_Result] = loop.create_future()

    def settle(set_it: Callable[[], None]) -> None:
        if not future.done():
            set_it()

    def run() -> None:
        try:
            result = call()
        except BaseException as error:  # noqa: BLE001  # whoever awaits it gets it
            failure = error
            tell(lambda: future.set_exception(failure))
        else:
            tell(lambda: future.set_result(result))

    def tell(set_it: Callable[[], None]) -> None:
        if not loop.is_closed():
            loop.call_soon_threadsafe(settle, set_it)

    threading.Thread(target=run, name="uplink", daemon=True).start()
    return await future


def _check_alone(liveliness: Any, own: str) -> None:
    found = liveliness.get(f"{ROBOT}/*", timeout=LOOK_S)
    if any(str(each.ok.key_expr) != own for each in found if each.ok is not None):
        raise NameTakenError
