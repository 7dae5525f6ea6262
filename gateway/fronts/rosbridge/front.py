# SPDX-License-Identifier: Apache-2.0
"""rosbridge's protocol: messages of clients become requests of the core."""

import time
from collections.abc import Callable, Mapping
from functools import partial
from typing import Final, cast

from gateway.access.credentials import SUBPROTOCOL
from gateway.access.permissions import UNLIMITED, Identity
from gateway.core.errors import StatusCode
from gateway.core.router import Router
from gateway.core.tasks import FAILURES, refuse
from gateway.fronts.rosbridge import messages
from gateway.fronts.rosbridge.help import DOCS, frames_to_try
from gateway.fronts.rosbridge.large_messages import LARGE_MESSAGE_BYTES, LargeMessages
from gateway.fronts.rosbridge.operations import OPERATIONS, ClientOperation
from gateway.fronts.rosbridge.operations.gateway import Auth, Help, SetLevel
from gateway.fronts.rosbridge.session import RosbridgeSession
from gateway.fronts.rosbridge.tf2_web_republisher.republisher import TfRepublisher
from gateway.transport.front import ClientSession


class RosbridgeFront:
    """Reads what clients of rosbridge send, and has the core carry it out."""

    subprotocols: Final = (SUBPROTOCOL,)

    def __init__(self, core: Router) -> None:
        self.core = core
        self._large = LargeMessages(self._carry_out)
        self._republisher = TfRepublisher(core.ros, core.republications)
        core.join(self._republisher)

    def open(
        self,
        wake: Callable[[], None],
        address: str = "",
        identity: Identity | None = UNLIMITED,
    ) -> RosbridgeSession:
        """Open a session. See `gateway.transport.front.Front`."""
        session = RosbridgeSession(self.core.limits, wake, identity)
        self.core.enter(session, address)
        return session

    def rejection(self, code: StatusCode, reason: str) -> bytes:
        """Return a `status` for a client that is rejected."""
        return messages.status("error", reason, code=code)

    def receive(self, session: ClientSession, data: bytes) -> None:
        """Carry out one message of a client. Every error is answered."""
        assert isinstance(session, RosbridgeSession)  # noqa: S101  # it is one of ours
        operation = session.receive(data, time.monotonic_ns())
        if operation is None:
            return
        if session.read_bytes > LARGE_MESSAGE_BYTES:
            self._large.receive(session, operation)
        else:  # which is not read in slices
            self._carry_out(session, cast("ClientOperation", operation))

    def _carry_out(self, session: RosbridgeSession, operation: ClientOperation) -> None:
        request = operation.request()
        kind = type(operation)  # to match a class of pydantic takes 0.3 us
        try:
            if kind is Auth:  # before that, the core carries out nothing
                session.authenticate(cast("Auth", operation).token, request)
                return
            instead = (
                partial(_OWN[kind], self.core, session, operation)
                if kind in _OWN
                else self._republisher.work(session, operation)
            )
        except FAILURES as error:
            refuse(session, request, error)
            return
        self.core.carry_out(session, request, instead)


def _set_level(_: Router, session: RosbridgeSession, operation: SetLevel) -> None:
    session.set_level(operation.level)


def _help(core: Router, session: RosbridgeSession, operation: Help) -> None:
    """Answer with frames that can be pasted as they are."""
    frames = frames_to_try(core.graph_seen_by(session), session.may)
    text = "send one of these lines as it is"
    operations = list(OPERATIONS)
    session.send(messages.help_answer(operation.id, text, frames, docs=DOCS, operations=operations))


# the operations that the core does not know
_OWN: Final[Mapping[type, Callable[..., None]]] = {SetLevel: _set_level, Help: _help}
