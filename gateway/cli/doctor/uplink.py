# SPDX-License-Identifier: Apache-2.0
"""The check of the uplink: its router, who signs in there, and the name of the robot."""

import contextlib
import socket
import threading
from typing import TYPE_CHECKING, Any, Final

from gateway.cli.doctor.finding import Finding, Note, Results
from gateway.cli.doctor.machine import Machine
from gateway.cli.doctor.ports import gateway_runs
from gateway.errors import ConfigError, RosStartError

if TYPE_CHECKING:
    from gateway.sources.zenoh.options import ZenohOptions

PASSES_S: Final = 2.0  # the router of a healthy network takes milliseconds
_AGAIN_S: Final = 0.1
_PROBE: Final = "doctor"  # the robot may publish and subscribe below its own name
_UNSEEN: Final = "Relays do not see this robot, so viewers cannot reach it"


def uplink(machine: Machine) -> Results:
    """Check that the router takes this robot by its name, and passes on what it sends."""
    config = machine.config.uplink
    if config.endpoint is None:
        yield Note("there is no uplink")
        return
    try:
        from gateway.sources.zenoh.session import RouterError, open_session
        from gateway.uplink.opening import ROBOT, options_of
        from gateway.uplink.uplink import own_name
    except ModuleNotFoundError as error:
        what = f"the package {error.name} is missing, which the uplink needs"
        advice = "Install the extra `zenoh`, with pip install '.[zenoh]' in the source tree"
        yield Finding("error", what, _UNSEEN, advice)
        return
    robot = config.robot_name or own_name(socket.gethostname())
    with contextlib.ExitStack() as stack:
        try:
            options = options_of(config, robot)
            first = stack.enter_context(contextlib.closing(open_session(options)))
        except RouterError as error:
            yield Finding("error", error.what, _UNSEEN, f"Correct the uplink: {error.remedy}")
            return
        except (ConfigError, RosStartError) as error:
            yield Finding("error", str(error), _UNSEEN, "Correct the section uplink")
            return
        yield Note(f"the router {options.router} takes this robot")
        if not _passes(first, options):
            what = f"the router {options.router} passes on nothing of {robot}"
            why = "Its access control knows these credentials by another name, or not at all"
            yield Finding("error", what, why, "Use the credentials of this robot's name")
            return
        found = first.liveliness().get(f"{ROBOT}/*", timeout=PASSES_S)
        if not any(each.ok is not None for each in found):
            yield Note(f"the name {robot} is free")
        elif gateway_runs(machine):
            yield Note(f"{robot} is connected. Its health reports another robot of this name")
        else:
            what = f"another robot is connected as {robot}"
            why = "Of two robots with one name, the router keeps the first one"
            yield Finding("error", what, why, "Set uplink.robot_name to another name")


def _passes(first: Any, options: "ZenohOptions") -> bool:
    """Return whether another session gets what the first one puts."""
    from gateway.sources.zenoh.session import open_session

    has_come = threading.Event()
    with (
        contextlib.closing(open_session(options)) as second,
        second.declare_subscriber(_PROBE, lambda _: has_come.set()),
    ):
        for _ in range(round(PASSES_S / _AGAIN_S)):
            first.put(_PROBE, b"")
            if has_come.wait(_AGAIN_S):
                return True
    return False
