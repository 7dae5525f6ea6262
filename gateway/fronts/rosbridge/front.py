# SPDX-License-Identifier: Apache-2.0
"""rosbridge's protocol: messages of clients become requests of the core."""

import time
from functools import partial
from typing import Final, cast

from typing_extensions import assert_never

from gateway.access.credentials import SUBPROTOCOL
from gateway.core.errors import StatusCode
from gateway.core.peer import Peer
from gateway.core.router import Router
from gateway.core.tasks import FAILURES, refuse
from gateway.fronts.rosbridge import messages
from gateway.fronts.rosbridge.help import DOCS, frames_to_try
from gateway.fronts.rosbridge.large_messages import LARGE_MESSAGE_BYTES, LargeMessages
from gateway.fronts.rosbridge.operations import OPERATIONS, ClientOperation
from gateway.fronts.rosbridge.own_requests import (
    AuthRequest,
    FrontRequest,
    HelpRequest,
    LogRequest,
    OwnRequest,
    SetLevelRequest,
)
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

    def open(self, peer: Peer) -> RosbridgeSession:
        """Open a session. See `gateway.transport.front.Front`."""
        session = RosbridgeSession(self.core, peer)
        self.core.enter(session)
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
        try:
            if isinstance(request, FrontRequest):
                self._carry_out_own(session, request)
                return
            work = self._republisher.work(session, operation)
        except FAILURES as error:
            refuse(session, request, error)
            return
        if work is None:
            self.core.carry_out(session, request)
        else:
            self.core.permit(session, request, work)

    def _carry_out_own(self, session: RosbridgeSession, request: OwnRequest) -> None:
        match request:
            case AuthRequest():  # before that, a client may do nothing
                session.peer.authenticate(request.token, request)
            case SetLevelRequest():
                self.core.permit(session, request, partial(session.set_level, request.level))
            case LogRequest():
                work = partial(self.core.introspection.log, session, request)
                self.core.permit(session, request, work)
            case HelpRequest():
                self.core.permit(session, request, partial(self._help, session, request))
            case _:
                assert_never(request)

    def _help(self, session: RosbridgeSession, request: HelpRequest) -> None:
        """Answer with frames that can be pasted as they are."""
        frames = frames_to_try(self.core.graph_seen_by(session), session.may)
        text, operations = "send one of these lines as it is", list(OPERATIONS)
        session.send(
            messages.help_answer(request.id, text, frames, docs=DOCS, operations=operations)
        )
