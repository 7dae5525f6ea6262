# SPDX-License-Identifier: Apache-2.0
"""The guard process. The gateway starts it, see `gateway.guard`."""

import contextlib
import os
import pkgutil
import select
import signal
import sys
import time
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, Final

import orjson

from gateway.drive.stop import LIFESPAN_NS
from gateway.drive.twist_cdr import encode
from gateway.drive.velocity import ZERO
from gateway.ending_signals import ENDING
from gateway.guard import DISCOVERY_S, HEARD_S, MAX_LINE_BYTES, PROOF_S
from gateway.guard.watch import CommandWatch
from gateway.sources.guard import GuardNode, GuardPublisher
from gateway.sources.source import RosError

DISCOVERY_PERIOD_NS: Final = 20_000_000
PROOF_PERIOD_NS: Final = 5_000_000  # a reader takes as long to acknowledge (heartbeatResponseDelay)
# A lost zero is sent again after this time. One whose lifespan ends would count as acknowledged.
PROOF_ZERO_NS: Final = 100_000_000
ACKNOWLEDGED_S: Final = 0.5  # a reader that has not got the last zero by then has gone as well


@dataclass(slots=True)
class _Output:
    """A publisher, and what its messages need in addition to six zeros."""

    type_name: str
    publisher: GuardPublisher
    opened_ns: int
    number: int  # of the `open`
    missing: set[str]  # subscriptions that the gateway knows, but this process has not discovered
    is_told: bool = False  # that it is open
    proof_ns: int | None = None  # when the proof that zeros arrive began
    proof_zero_ns: int = 0  # when the last zero of the proof went out
    stamp_offset_ns: int = 0
    frame_id: str = ""

    def note_header(self, stamp_offset_ns: int, frame_id: str) -> None:
        """Take what the header of a TwistStamped needs."""
        self.stamp_offset_ns, self.frame_id = stamp_offset_ns, frame_id

    def begin_proof(self, now_ns: int) -> None:
        """Begin to prove that zeros arrive, unless that is under way."""
        if self.proof_ns is None:
            self.proof_ns, self.proof_zero_ns = now_ns, 0


class GuardLoop:
    """The loop of the process. Everything happens on its one thread."""

    def __init__(self, ros: GuardNode, silence_ns: int, answers: int) -> None:
        """*answers* is the descriptor on which the gateway listens."""
        self._ros = ros
        self._answers = answers
        self._watch = CommandWatch(silence_ns)
        self._outputs: dict[str, _Output] = {}
        self._heard_ns = 0
        self._rest = b""

    def run(self) -> None:
        """Watch until the gateway's end of the pipe is closed and everything stands."""
        self._say("ready")
        poll = select.poll()
        poll.register(0, select.POLLIN)
        is_open = True
        while is_open or self._watch.is_stopping:
            timeout_ms = self._timeout_ms()
            if is_open and poll.poll(timeout_ms):
                data = os.read(0, 65536)
                is_open = bool(data)
                self._take(data)
            elif not is_open:
                time.sleep((timeout_ms or 0) / 1000)
            if self._ros.is_cut_off:
                self._leave()
                return
            now_ns = time.monotonic_ns()
            if not is_open:
                self._watch.lost(now_ns)
            else:
                for topic in self._watch.silent(now_ns):
                    self._say("stopped", topic)
            self._tell_opened(now_ns)
            self._prove()
            self._send(self._watch.zeros(now_ns, self._is_heard))
        self._ros.flush(ACKNOWLEDGED_S)

    def _leave(self) -> None:
        """Send a zero to what moves: perhaps the gateway hangs, and not the link.

        It comes first, because a gateway that hears of the end kills this process.
        """
        now_ns = time.monotonic_ns()
        self._watch.lost(now_ns)
        self._send(self._watch.zeros(now_ns, self._is_heard))
        self._say("cut off")

    def _timeout_ms(self) -> float | None:
        due_ns = self._watch.due_ns
        now_ns = time.monotonic_ns()
        for output in self._outputs.values():
            if output.proof_ns is not None:
                due_ns = min(due_ns or now_ns + PROOF_PERIOD_NS, now_ns + PROOF_PERIOD_NS)
            elif not output.is_told:
                due_ns = min(due_ns or now_ns + DISCOVERY_PERIOD_NS, now_ns + DISCOVERY_PERIOD_NS)
        if due_ns is None:
            return None
        # rounded up: a poll that returns too early would turn for nothing
        return max(0, (due_ns - now_ns) // 1_000_000 + 1)

    def _take(self, data: bytes) -> None:
        *lines, self._rest = (self._rest + data).split(b"\n")
        now_ns = time.monotonic_ns()
        for line in lines:
            self._obey(orjson.loads(line), now_ns)
        if len(self._rest) > MAX_LINE_BYTES:
            raise SystemExit("the guard's input is not a line")
        if lines and now_ns - self._heard_ns >= HEARD_S * 1e9:
            self._heard_ns = now_ns
            self._say("heard")

    def _obey(self, message: list[Any], now_ns: int) -> None:
        match message:
            case ["moving", topic, int(offset_ns), frame_id]:
                self._watch.moving(topic, now_ns)
                self._ros.moves(topic)
                if topic in self._outputs:
                    self._outputs[topic].note_header(offset_ns, frame_id)
            case ["rest", topic]:
                self._watch.rest(topic)
            case ["open", topic, type_name, int(number), *readers]:
                self._open(topic, type_name, number, set(readers))
            case ["prove", topic, int(offset_ns), frame_id] if topic in self._outputs:
                self._outputs[topic].note_header(offset_ns, frame_id)
                self._outputs[topic].begin_proof(now_ns)
            case ["close", str(topic)]:
                self._watch.close(topic)
                output = self._outputs.pop(topic, None)
                if output is not None:
                    output.publisher.close()

    def _open(self, topic: str, type_name: str, number: int, readers: set[str]) -> None:
        known = self._outputs.get(topic)
        if known is not None:
            known.number, known.missing, known.opened_ns = number, readers, time.monotonic_ns()
            known.is_told, known.proof_ns = False, None
            return
        try:
            publisher = self._ros.advertise(topic, type_name, LIFESPAN_NS)
        except RosError as error:
            self._say("failed", topic, str(error)[:200])
            return
        opened_ns = time.monotonic_ns()
        self._outputs[topic] = _Output(type_name, publisher, opened_ns, number, readers)
        self._watch.open(topic)

    def _tell_opened(self, now_ns: int) -> None:
        """Report the topics that have their readers, or have waited for long enough."""
        for topic, output in self._outputs.items():
            is_due = now_ns - output.opened_ns >= DISCOVERY_S * 1e9
            if not output.is_told and (self._has_discovered(topic) or is_due):
                output.is_told = True
                self._say("opened", topic, output.number)

    def _has_discovered(self, topic: str) -> bool:
        """Return whether none of the subscriptions that the gateway knows is missing here."""
        missing = self._outputs[topic].missing
        if missing:  # one that was there once may have gone
            missing -= self._ros.readers(topic)
        return not missing

    def _prove(self) -> None:
        """Publish zeros on topics that need a proof, and report the topics that have it."""
        for topic, output in self._outputs.items():
            if output.proof_ns is None:
                continue
            is_acknowledged = output.proof_zero_ns > 0 and output.publisher.is_acknowledged
            now_ns = time.monotonic_ns()
            since_ns = now_ns - output.proof_zero_ns
            is_over = now_ns - output.proof_ns >= PROOF_S * 1e9
            if is_over or (is_acknowledged and since_ns < LIFESPAN_NS):
                output.proof_ns = None
                self._say("proved", topic, output.number)
            elif since_ns >= PROOF_ZERO_NS:
                output.proof_zero_ns = now_ns
                self._send([topic])

    def _is_heard(self, topic: str) -> bool:
        """Return whether every robot that moves gets what is published now, and has got the last.

        A robot that has joined late may be discovered, and may not have discovered the guard yet.
        """
        return self._has_discovered(topic) and self._outputs[topic].publisher.is_acknowledged

    def _say(self, *message: str | int) -> None:
        with contextlib.suppress(OSError):  # the gateway is gone, as the end of the input says
            os.write(self._answers, orjson.dumps(message) + b"\n")

    def _send(self, topics: Iterable[str]) -> None:
        for topic in topics:
            output = self._outputs[topic]
            stamp_ns = max(0, time.monotonic_ns() + output.stamp_offset_ns)
            with contextlib.suppress(RosError):  # the next one may pass
                output.publisher.publish(encode(output.type_name, ZERO, stamp_ns, output.frame_id))


def _own_answers() -> int:
    """Keep the pipe to the gateway for answers, and send all that is printed to the log.

    DDS prints, for example, that there is no room for shared memory.
    """
    answers = os.dup(1)
    os.dup2(2, 1)
    return answers


def main() -> None:
    """Run with ``{"class", "node", "silence_ns"}`` as the only argument.

    The class is a `gateway.sources.guard.GuardNode`, which is made with *node*.
    """
    # Ctrl-C, the stop of a service and its watchdog reach the whole group. The guard ends after the
    # gateway.
    for number in (*ENDING, signal.SIGHUP, signal.SIGPIPE, signal.SIGABRT):
        signal.signal(number, signal.SIG_IGN)
    answers = _own_answers()
    options = orjson.loads(sys.argv[1])
    opened: GuardNode = pkgutil.resolve_name(options["class"])(**options["node"])
    with opened as ros:
        GuardLoop(ros, options["silence_ns"], answers).run()


if __name__ == "__main__":
    main()
    # The robot stands and the graph knows. Fast DDS would take 0.3 s more to unload, for which a
    # service manager waits before it starts the next gateway.
    os._exit(0)
