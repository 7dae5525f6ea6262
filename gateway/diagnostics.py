# SPDX-License-Identifier: Apache-2.0
"""The gateway's own /diagnostics, for rqt_robot_monitor and other ROS tools."""

import asyncio
import contextlib
import logging
from collections.abc import Callable, Iterator
from typing import Final

from gateway.codec.types import Types
from gateway.metrics.diagnosis import ComponentStatus, diagnose
from gateway.metrics.state import Summary
from gateway.sources.source import Publisher, Publishing, Qos, RosError
from schemas.json_forms import Clock

TOPIC: Final = "/diagnostics"
TYPE: Final = "diagnostic_msgs/msg/DiagnosticArray"
PERIOD_S: Final = 1.0  # as diagnostic_updater does
QOS: Final = Qos("reliable", "volatile", "keep_last", 1)

logger = logging.getLogger(__name__)


@contextlib.contextmanager
def publishing(
    part: Publishing,
    now_ns: Clock,
    types: Types,
    summarize: Callable[[], Summary],
    name: str,
) -> Iterator[None]:
    """Publish a diagnosis each second in the context. Component names begin with *name*."""
    reports = _Reports(part, now_ns, types, summarize, name)
    task = asyncio.get_running_loop().create_task(_report(reports))
    try:
        yield
    finally:
        task.cancel()


async def _report(reports: "_Reports") -> None:
    while True:
        await asyncio.sleep(PERIOD_S)  # sleeps first, because users wait for the gateway to listen
        reports.publish()


class _Reports:
    def __init__(
        self,
        part: Publishing,
        now_ns: Clock,
        types: Types,
        summarize: Callable[[], Summary],
        name: str,
    ) -> None:
        self._part = part
        self._now_ns = now_ns
        self._types = types
        self._summarize = summarize
        self._name = name
        self._publisher: Publisher | None = None
        self._before: Summary | None = None
        self._trouble = ""  # the last one in the log

    def publish(self) -> None:
        """Publish one diagnosis. Log each new error once, because the next one may succeed."""
        try:
            self._publish()
        except (RosError, OSError) as error:  # no diagnostic_msgs, or no descriptors
            if self._is_new(error):
                logger.warning("%s is not published: %s", TOPIC, error)
        except Exception as error:  # our fault must not end the diagnoses that may show it
            if self._is_new(error):
                logger.exception("%s is not published", TOPIC)

    def _publish(self) -> None:
        if self._publisher is None:  # until then clients may have the topic with another type
            self._publisher = self._part.advertise_own(TOPIC, TYPE, QOS)
        before, self._before = self._before, self._summarize()
        status = [_status(each, self._name) for each in diagnose(self._before, before)]
        message = {"header": {"stamp": "now"}, "status": status}
        self._publisher.publish(self._types.get(TYPE).encode(message, self._now_ns))

    def _is_new(self, error: Exception) -> bool:
        before, self._trouble = self._trouble, repr(error)
        return self._trouble != before


def _status(diagnosis: ComponentStatus, name: str) -> dict[str, object]:
    return {
        "level": diagnosis.level,
        "name": f"{name}: {diagnosis.component}",
        "message": diagnosis.text,
        "hardware_id": name,
        "values": [{"key": k, "value": str(v)} for k, v in diagnosis.values.items()],
    }
