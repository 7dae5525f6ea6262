# SPDX-License-Identifier: Apache-2.0
"""The state of the gateway in words, for ROS tools."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final, Literal

from gateway.metrics.state import DriveState, Summary

Level = Literal[0, 1, 2]  # of diagnostic_msgs/msg/DiagnosticStatus
OK: Final = 0
WARN: Final = 1
ERROR: Final = 2

LATE_S: Final = 0.1  # people notice it in what they steer
TOO_LATE_S: Final = 0.5  # the command timeout: robots stop
CROWDED: Final = 0.8  # of the ROS entities, because the rest can be used up quickly
MAX_NAMED: Final = 8  # clients or nodes: more do not help, and the message is for people


@dataclass(frozen=True, slots=True)
class ComponentStatus:
    """The state of one component: a level, a sentence, and numbers."""

    component: str
    level: Level
    text: str
    values: Mapping[str, object]


def diagnose(now: Summary, before: Summary | None) -> list[ComponentStatus]:
    """Return the diagnosis of each component.

    *before* is the summary of a moment ago. A client that loses messages had lost fewer then.
    """
    return [
        _event_loop(now),
        _clients(now),
        _delivery(now, before),
        _ros_entities(now),
        _ros_graph(now),
        _guard(now),
        *map(_drive, now.control.drives),
    ]


def _event_loop(now: Summary) -> ComponentStatus:
    late_s = now.max_lag_s
    level: Level = ERROR if late_s >= TOO_LATE_S else WARN if late_s >= LATE_S else OK
    text = f"late by up to {late_s * 1000:.0f} ms" if level else "on time"
    values = {
        "max lag of 10 s (s)": f"{late_s:.4f}",
        "tasks": now.tasks,
        "uptime (s)": round(now.uptime_s),
        "version": now.version,
    }
    return ComponentStatus("event loop", level, text, values)


def _clients(now: Summary) -> ComponentStatus:
    count = len(now.clients)
    is_full = count >= now.max_clients
    text = f"{count} connected"
    if is_full:
        text += ", no room for another (limits.max_clients)"
    values = {
        "clients": count,
        "limit": now.max_clients,
        "without a token yet": now.unauthenticated,
        "operations": now.totals.operations,
        "operations refused": now.totals.refused,
        "reading pauses": now.pauses,
        "wrong or missing tokens": sum(now.authentication_failures.values()),
    }
    return ComponentStatus("clients", WARN if is_full else OK, text, values)


def _delivery(now: Summary, before: Summary | None) -> ComponentStatus:
    dropping = list(_dropping(now, before))
    text = "no queue overflows"
    if dropping:
        text = f"too slow for what they subscribe to: {_some(dropping)}"
    values = {
        "clients that lose messages": len(dropping),
        "frames sent": now.totals.frames,
        "dropped by full queues": now.totals.dropped_by_full_queue,
        "coalesced": now.totals.coalesced,
    }
    return ComponentStatus("delivery", WARN if dropping else OK, text, values)


def _dropping(now: Summary, before: Summary | None) -> Iterator[str]:
    if before is not None:
        known = {each.client: each.counts.dropped_by_full_queue for each in before.clients}
        for client in now.clients:
            if client.counts.dropped_by_full_queue > known.get(client.client, 0):
                yield client.client


def _some(names: Sequence[str]) -> str:
    more = f" and {len(names) - MAX_NAMED} more" if len(names) > MAX_NAMED else ""
    return ", ".join(names[:MAX_NAMED]) + more


def _ros_entities(now: Summary) -> ComponentStatus:
    count, limit = now.entities["ros_entities"], now.max_ros_entities
    level: Level = ERROR if count >= limit else WARN if count >= CROWDED * limit else OK
    text = f"{count} of {limit} (limits.max_ros_entities)"
    return ComponentStatus("ROS entities", level, text, now.entities)


def _ros_graph(now: Summary) -> ComponentStatus:
    shared = now.shared_names
    text = "each node has a unique name"
    if shared:
        text = f"several nodes are named {_some(shared)}"
    return ComponentStatus("ROS graph", WARN if shared else OK, text, {"shared names": len(shared)})


def _guard(now: Summary) -> ComponentStatus:
    control = now.control
    level: Level = OK
    text = "ready"
    if not control.guard_is_ready:
        level = ERROR if control.guard_losses else WARN
        state = "lost, another one starts" if control.guard_losses else "starting"
        text = f"{state}: commands that move the robot are refused"
    return ComponentStatus("guard", level, text, {"losses": control.guard_losses})


def _drive(drive: DriveState) -> ComponentStatus:
    text = drive.motion
    if drive.is_tripped:
        text = f"stopped, {drive.cause}: send a zero command to drive again"
    values = {
        "motion": drive.motion,
        "tripped": drive.is_tripped,
        "a client has control": drive.is_leased,
        "guarded": drive.is_guarded,
        **{f"stops: {cause}": count for cause, count in drive.stops.items()},
    }
    return ComponentStatus(f"drive {drive.topic}", WARN if drive.is_tripped else OK, text, values)
