# SPDX-License-Identifier: Apache-2.0
"""One connection of an uplink, from its beginning until it is lost. Then everything begins again.

Zenoh connects again by itself, but it does not say what the router has forgotten. So nothing is
kept.
"""

import asyncio
import contextlib
import struct
import threading
from collections.abc import Callable, Mapping
from typing import Any, Final

import zenoh

from gateway.access.permissions import Identity
from gateway.codec.types import Types
from gateway.config.model import Config
from gateway.core.router import Router
from gateway.sources.zenoh.inbox import LoopWaker
from gateway.sources.zenoh.outgoing import Mailbox, Outgoing
from gateway.sources.zenoh.token_changes import TokenChanges
from gateway.sources.zenoh.token_graph import TokenGraph
from gateway.sources.zenoh.tokens import PREFIX
from gateway.uplink.calls import UplinkCalls
from gateway.uplink.driving_edge import DrivingEdge
from gateway.uplink.inputs import UplinkInputs
from gateway.uplink.mirror import Mirror
from gateway.uplink.offer import DOMAIN, Offer, Offering
from gateway.uplink.opening import ROBOT, Opened
from gateway.uplink.pace import UplinkPace
from gateway.uplink.session import UplinkSession, Ways
from gateway.uplink.topics import UplinkTopics

ECHO: Final = "echo"
# Between a change of the graph and its way to relays. A robot that starts changes it all the time.
FOLLOW_S: Final = 0.25
_NUMBER: Final = struct.Struct("<q")


class UplinkLink:
    """Offers the robot through an open connection. *on_lost* is called when that has ended.

    Lives on the event loop's thread. Calls that may wait for the router go through `outgoing`.
    """

    def __init__(
        self,
        core: Router,
        types: Types,
        config: Config,
        identity: Identity,
        opened: Opened,
        offering: Offering,
        on_lost: Callable[[], None],
    ) -> None:
        loop = asyncio.get_running_loop()
        self.core, self.types, self.opened = core, types, opened
        self._on_lost = on_lost
        self._newest_mark = 0
        with contextlib.ExitStack() as undo:
            undo.callback(self._close_sessions)
            self.id = str(opened.zenoh.info.zid())
            self.mailbox, self.outgoing = Mailbox(loop), Outgoing()
            undo.callback(self.mailbox.close)
            undo.callback(self.outgoing.close)
            self.graph = TokenGraph(self.id)
            self._changes = TokenChanges(loop, self._on_tokens)
            undo.callback(self._changes.close)
            self._marks = LoopWaker(loop, self._on_mark)
            undo.callback(self._marks.close)
            self._lost = LoopWaker(loop, self._on_token_lost)
            undo.callback(self._lost.close)
            self.pace = UplinkPace(
                self._send_mark,
                on_room=self._drain,
                on_rate=lambda rate: self.session.outbox.drains(rate),
                on_lost=on_lost,
            )
            undo.callback(self.pace.close)
            ways = Ways(
                lambda *sample: self.topics.send(*sample),
                lambda *message: self.inputs.takes_back(*message),
            )
            self.session = UplinkSession(core, identity, self._drain, ways)
            self.mirror = Mirror(self.id, opened.zenoh.liveliness(), self.outgoing.finish)
            self.offering = offering
            self.offer = Offer()
            self.topics = UplinkTopics(self, config.uplink)
            undo.callback(self.topics.close)
            self.calls = UplinkCalls(self)
            undo.callback(self.calls.close)
            self.inputs = UplinkInputs(self)
            undo.callback(self.inputs.close)
            core.enter(self.session)
            undo.callback(core.leave, self.session)
            self._following: asyncio.TimerHandle | None = None
            undo.callback(self._stop_following)
            watch = core.ros.watch_graph(self._on_graph_change)
            undo.callback(watch.close)
            self.outgoing.finish(self._listen)
            self._on_graph()
            # of the second session: what this robot shows never delays a command
            self.driving = DrivingEdge(core, identity, opened.echo)
            undo.callback(self.driving.close)
            self._undo = undo.pop_all()

    @property
    def is_proved(self) -> bool:
        """True once something has come back from the router."""
        return self.pace.proved.is_set()

    @property
    def tokens_left_out(self) -> int:
        """The tokens of others that are too many."""
        return self._changes.left_out

    def close(self) -> None:
        """End everything: the router sees no robot."""
        self._undo.close()

    def _listen(self) -> None:  # on the thread
        liveliness = self.opened.zenoh.liveliness()
        of_echo = self.opened.echo.liveliness()
        self._changes.watch(
            lambda on_token: liveliness.declare_subscriber(
                f"{PREFIX}/{DOMAIN}/**", _token_listener(on_token), history=True
            )
        )
        kept = [
            self.opened.echo.declare_subscriber(ECHO, self._arrive),
            of_echo.declare_subscriber(f"{ROBOT}/{self.id}", self._see_itself, history=True),
        ]
        self.opened.kept.extend(kept)

    def _arrive(self, sample: Any) -> None:  # on a thread of Zenoh
        mark = sample.payload.to_bytes()
        if len(mark) == _NUMBER.size:
            self._newest_mark = _NUMBER.unpack(mark)[0]
            self._marks.wake()

    def _see_itself(self, sample: Any) -> None:  # on a thread of Zenoh
        if sample.kind == zenoh.SampleKind.DELETE:
            self._lost.wake()

    def _on_token_lost(self) -> None:
        self._on_lost()

    def _send_mark(self, number: int) -> None:
        mark = _NUMBER.pack(number)
        self.outgoing.finish(lambda: self.opened.zenoh.put(ECHO, mark))

    def _on_mark(self) -> None:
        self.pace.returned(self._newest_mark)

    def _drain(self) -> None:
        """Send what there is room for. A frame is sent as it is taken."""
        outbox = self.session.outbox
        while (room := self.pace.room_bytes) > 0 and outbox.take(room):
            pass
        self.pace.mark()

    def _on_graph_change(self) -> None:
        """Follow the graph soon: that of a large robot takes 30 ms of the loop."""
        if self._following is None:
            self._following = asyncio.get_running_loop().call_later(FOLLOW_S, self._on_graph)

    def _stop_following(self) -> None:
        if self._following is not None:
            self._following.cancel()

    def _on_graph(self) -> None:
        self._following = None
        self.offer = self.offering.of(self.core.ros.graph(), self.session.sees)
        self.mirror.show(self.offer.entities)
        self.topics.follow(self.offer.topics)
        self.inputs.follow(self.offer.inputs)
        self.calls.actions.follow(self.offer.actions)

    def _on_tokens(self, changes: Mapping[str, bool]) -> None:
        self.graph.apply(changes)
        self.topics.follow(self.offer.topics)
        self.inputs.follow(self.offer.inputs)

    def _close_sessions(self) -> None:
        threading.Thread(target=self.opened.close, name="uplink_close", daemon=True).start()


def _token_listener(on_token: Callable[[str, bool], None]) -> Callable[[Any], None]:
    def arrive(sample: Any) -> None:  # on a thread of Zenoh
        on_token(str(sample.key_expr), sample.kind == zenoh.SampleKind.PUT)

    return arrive
