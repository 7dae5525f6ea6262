# SPDX-License-Identifier: Apache-2.0
"""The answers to commands that do not go out: each says what to do about it."""

from typing import Final

from gateway.drive.effects import Cause, Command, GuardState, Refused, Rules
from gateway.drive.freshness import Age
from gateway.drive.waiting import WaitingEvent

CAUSE_TEXTS: Final[dict[Cause, str]] = {
    "zero": "it was commanded to stop",
    "stop": "another client asked for a stop",
    "release": "control was released",
    "deadline": "commands stopped arriving",
    "disconnect": "the client that drove disconnected",
    "takeover": "another client took control",
    "lease": "control was not renewed",
    "permission": "the permission to drive ended",
    "invalid_value": "a command was invalid",
    "backlog": "many commands arrived together after a pause, so they are old",
    "guard": "the gateway's guard process ended or hung",
    "reader": "another node began to listen, which may be a robot that starts",
    "shutdown": "the gateway is shutting down",
    "start": "this gateway needs a zero command before the first command to move",
}

_LATE_TEXTS: Final[dict[Age, str]] = {
    "stale": "by its monotonic_ms the command came over 250 ms later than others of this connection"
    ": send each command when you make it",
    "behind": "the command waited for over 250 ms, because this connection has used up its share of"
    " the gateway's time (limits.client_time_share): send less",
    "waited": "the command waited for over 250 ms, because the gateway was busy: send it again",
    "delayed": "the way between the relay and the robot took over 300 ms: check that network, and"
    " send a new command",
}
_NOT_READY: Final = "is starting: send the command again in about a second"
_GUARD_TEXTS: Final[dict[GuardState, str]] = {
    "starting": _NOT_READY,
    "prepared": _NOT_READY,
    "ready": _NOT_READY,  # too late
    "lost": "ended or hung, and another starts in a second, or in up to 30 s after repeated"
    " losses: then send a zero command, and drive on",
}


def not_holder(command: Command, topic: str, rules: Rules) -> Refused:
    """Refuse a client while another one drives."""
    reason = (
        f"another client drives {topic}: let go and wait until it has been silent for"
        f" {rules.lease_ns / 1e9:g} s, take control with"
        f' {{"op":"acquire_control","topic":"{topic}"}}, or stop the robot with {{"op":"stop"}}'
    )
    return Refused(command, "not_lease_holder", reason)


def still_pushes(command: Command, topic: str, rules: Rules) -> Refused:
    """Refuse a client whose commands began while another one drove."""
    reason = (
        f"topic {topic}: your commands began while another client drove: first send a zero command"
        f' ("msg":{{}}), or nothing for {rules.deadline_ns / 1e9:g} s'
    )
    return Refused(command, "not_lease_holder", reason)


def stale(command: Command, topic: str) -> Refused:
    """Refuse a command that is old."""
    return Refused(command, "stale_command", f"topic {topic}: {_LATE_TEXTS[command.age]}")


def overtaken(command: Command, topic: str) -> Refused:
    """Refuse a command that a client has sent before a stop, because the stop goes first."""
    reason = (
        f"topic {topic}: you sent this command before a stop, and the stop overtook it: send a new"
        " command to drive on"
    )
    return Refused(command, "stale_command", reason)


def tripped(command: Command, topic: str, cause: Cause | None, guard: GuardState) -> Refused:
    """Refuse a command to move, because the guard process was lost or the latch is set."""
    if guard == "lost" or cause is None:
        return unguarded(command, topic, guard)
    reason = (
        f"topic {topic} is stopped because {CAUSE_TEXTS[cause]}: send a zero command"
        ' ("msg":{}), then nothing that moves for 250 ms, then drive on'
    )
    return Refused(command, "tripped", reason)


def unguarded(command: Command, topic: str, guard: GuardState) -> Refused:
    """Refuse a command to move, because the guard process is not ready."""
    reason = f"topic {topic}: the guard process, without which nothing moves, {_GUARD_TEXTS[guard]}"
    return Refused(command, "tripped", reason)


def stood_still(command: Command, topic: str) -> Refused:
    """Refuse a command that waited, and would go out too late."""
    reason = f"topic {topic}: the gateway hung while the command waited: send it again"
    return Refused(command, "tripped", reason)


def taken_over(command: Command, topic: str) -> Refused:
    """Refuse a command that waited, because another client has control now."""
    reason = f"topic {topic}: another client took control while the command waited: let go"
    return Refused(command, "not_lease_holder", reason)


def waited(
    event: WaitingEvent, command: Command, topic: str, cause: Cause | None, guard: GuardState
) -> Refused:
    """Refuse a command that waited, for an event that ends its time."""
    match event:
        case "due" | "due_unready":
            return unguarded(command, topic, guard)
        case "late":
            return stood_still(command, topic)
        case "hand_over":
            return taken_over(command, topic)
        case _:
            return tripped(command, topic, cause, guard)


def shutting_down(command: Command, topic: str) -> Refused:
    """Refuse a command to move at the end."""
    return Refused(command, "tripped", f"topic {topic}: the gateway is shutting down")
