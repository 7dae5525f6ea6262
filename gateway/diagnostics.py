# SPDX-License-Identifier: Apache-2.0
"""The gateway's own /diagnostics, for rqt_robot_monitor and other tools of ROS."""

import asyncio
import contextlib
import logging
from collections.abc import Callable, Iterator
from typing import Final

from gateway.codec.types import Types
from gateway.metrics.diagnosis import Diagnosis, diagnose
from gateway.metrics.state import Summary
from gateway.ports import Qos, Ros, RosError

TOPIC: Final = "/diagnostics"
TYPE: Final = "diagnostic_msgs/msg/DiagnosticArray"
PERIOD_S: Final = 1.0  # as diagnostic_updater does
QOS: Final = Qos("reliable", "volatile", "keep_last", 1)

logger = logging.getLogger(__name__)


@contextlib.contextmanager
def publishing(
    ros: Ros, types: Types, summarize: Callable[[], Summary], name: str
) -> Iterator[None]:
    """Publish a diagnosis each second inside the context; *name* begins those of its components."""
    task = asyncio.get_running_loop().create_task(_publish(ros, types, summarize, name))
    try:
        yield
    finally:
        task.cancel()


async def _publish(ros: Ros, types: Types, summarize: Callable[[], Summary], name: str) -> None:
    await asyncio.sleep(PERIOD_S)  # whoever starts the gateway waits for it to listen
    try:
        publisher = ros.advertise_own(TOPIC, TYPE, QOS)
    except RosError as error:  # diagnostic_msgs may not be installed
        logger.warning("%s is not published: %s", TOPIC, error)
        return
    message_type = types.get(TYPE)
    before = None
    while True:
        now = summarize()
        status = [_status(each, name) for each in diagnose(now, before)]
        before = now
        message = {"header": {"stamp": "now"}, "status": status}
        try:
            publisher.publish(message_type.encode(message, ros.now_ns))
        except RosError as error:
            logger.warning("%s: %s", TOPIC, error)
        await asyncio.sleep(PERIOD_S)


def _status(diagnosis: Diagnosis, name: str) -> dict[str, object]:
    return {
        "level": diagnosis.level,
        "name": f"{name}: {diagnosis.component}",
        "message": diagnosis.text,
        "hardware_id": name,
        "values": [{"key": k, "value": str(v)} for k, v in diagnosis.values.items()],
    }
