# SPDX-License-Identifier: Apache-2.0
"""The lines of the logs about one command topic."""

import logging
from collections import Counter
from collections.abc import Hashable

from gateway.access.audit import Audit, AuditValue
from gateway.core.names import TopicName
from gateway.core.session import Session
from gateway.drive.effects import Stopped
from gateway.drive.refusals import CAUSE_TEXTS

logger = logging.getLogger(__name__)


class DriveAudit:
    """Records who drives, and what stops the robot."""

    def __init__(self, audit: Audit, topic: TopicName) -> None:
        self._audit = audit
        self._topic = topic
        self._holder: Hashable | None = None
        self.stops: Counter[str] = Counter()  # by their cause

    def hold(self, holder: Hashable | None) -> None:
        """Record who has control, if that has changed."""
        if holder is not self._holder:
            self._holder = holder
            if holder is not None:
                self.record("control_taken", holder, clock_offset_ms=clock_offset_ms(holder))

    def stop(self, stopped: Stopped) -> None:
        """Record and count a stop."""
        self.stops[stopped.cause] += 1
        level = logging.WARNING if stopped.is_tripped else logging.DEBUG
        extra: dict[str, str] = {"topic": self._topic}
        if isinstance(stopped.client, Session):
            extra["client"] = stopped.client.client
        logger.log(level, "stopped: %s", CAUSE_TEXTS[stopped.cause], extra=extra)
        self.record("stop", stopped.client, cause=stopped.cause, tripped=stopped.is_tripped)

    def record(self, event: str, client: Hashable | None, **values: AuditValue) -> None:
        """Record an event, and whom it concerns."""
        name = client.client if isinstance(client, Session) else None
        if isinstance(client, Session) and client.identity is not None:
            values |= {"name": client.identity.name, "role": client.identity.role}
            values["address"] = client.address
        self._audit.record(event, client=name, topic=self._topic, **values)


def clock_offset_ms(client: Hashable | None) -> float | None:
    """Return what a client adds to its clock to get the gateway's, if it has told."""
    return client.clock_offset_ms if isinstance(client, Session) else None
