# SPDX-License-Identifier: Apache-2.0
"""The requests of clients about recordings, and what the clients are told."""

import asyncio
import contextlib
import os
from collections.abc import Iterator
from typing import Any, Final

from gateway.access.audit import Audit
from gateway.codec.types import Types
from gateway.config.recording import RecordingConfig
from gateway.core.errors import ProtocolError
from gateway.core.permission_checks import check_record, may_record
from gateway.core.requests import Record
from gateway.core.router import Router
from gateway.core.session import Session
from gateway.recording.active_recording import Mark, RecordingPlan
from gateway.recording.recorder import Recorder, recordings_directory

# Of the 1.8 s of a shutdown. The next start completes a file that takes longer.
COMPLETE_S: Final = 0.5
PROGRESS_S: Final = 1.0  # between two reports to those who watch a recording


@contextlib.contextmanager
def recording(
    router: Router, types: Types, config: RecordingConfig, audit: Audit
) -> Iterator[Recorder]:
    """Let clients record. At the end, complete the file, for a limited time."""
    directory = recordings_directory(config, os.environ)
    recorder = Recorder(router, types, directory, config, audit)
    RecordRequests(router, recorder)
    try:
        yield recorder
    finally:
        recorder.close(COMPLETE_S)


class RecordRequests:
    """Carries out `record`, and reports every change to the clients that watch.

    A recording goes on when the client that started it leaves.
    """

    def __init__(self, router: Router, recorder: Recorder) -> None:
        self._recorder = recorder
        self._waiting: dict[Session, list[Record]] = {}  # for a start, or an end
        self._watching: dict[Session, Record] = {}
        self._starter: tuple[Session, Record] | None = None
        self._timer: asyncio.TimerHandle | None = None
        recorder.watch(self._on_change)
        router.join_recorder(self)

    def carry_out(self, session: Session, request: Record) -> None:
        """Carry out a request.

        Raises:
            ProtocolError: it is refused.
        """
        if request.action != "status":
            check_record(session)
        identity = session.identity
        assert identity is not None  # noqa: S101  # it may do this
        match request.action:
            case "start":
                plan = RecordingPlan(
                    topics=request.topics or (),
                    images=request.images,
                    task=request.task or "",
                    operator=request.operator or "",
                    identity=identity,
                )
                self._recorder.start(plan)
                self._starter = session, request
                self._waiting.setdefault(session, []).append(request)
            case "stop":
                self._recorder.stop(identity, success=request.success)
                self._starter = None
                self._waiting.setdefault(session, []).append(request)
            case "mark":
                mark = Mark(
                    text=request.text or "",
                    episode=request.episode,
                    task=request.task,
                    success=request.success,
                )
                self._recorder.mark(mark, identity)
                self._answer(session, request)
            case "status":
                self._watch(session, request)
                self._answer(session, request)

    def leave(self, session: Session) -> None:
        """Send nothing more to a client. Its recording goes on."""
        self._waiting.pop(session, None)
        self._watching.pop(session, None)
        if self._starter is not None and self._starter[0] is session:
            self._starter = None

    def _watch(self, session: Session, request: Record) -> None:
        if request.watch:
            self._watching[session] = request
            self._continue()
        elif request.watch is False:
            self._watching.pop(session, None)

    def _on_change(self) -> None:
        status = self._recorder.status()
        waited_for = {"recording": {"start"}, "stopped": {"start", "stop"}}.get(status.state, set())
        failed = status.state == "stopped" and bool(status.why)
        error = ProtocolError("internal", f"the recording has ended: {status.why}")
        for session, requests in list(self._waiting.items()):
            for request in [each for each in requests if each.action in waited_for]:
                requests.remove(request)
                if failed and request.action == "start":
                    session.refuse(error, request)
                    self._starter = None
                else:
                    self._answer(session, request)
        if failed and self._starter is not None:
            self._starter[0].refuse(error, self._starter[1])
            self._starter = None
        self._report()

    def _report(self) -> None:
        self._timer = None
        for session, request in self._watching.items():
            self._answer(session, request)
        self._continue()

    def _continue(self) -> None:
        """Report again soon while there is progress, if a client watches."""
        if self._timer is None and self._watching and self._recorder.is_recording:
            self._timer = asyncio.get_running_loop().call_later(PROGRESS_S, self._report)

    def _answer(self, session: Session, request: Record) -> None:
        members = {"may_record": may_record(session), **self._members()}
        session.answer("record", request.id, action=request.action, **members)

    def _members(self) -> dict[str, Any]:
        status = self._recorder.status()
        members: dict[str, Any] = {"state": status.state}
        if status.path is None:
            return members
        members |= {
            "recording": status.path.name,
            "topics": status.topics,
            "messages": status.messages,
            "bytes": status.size,
            "duration_s": round(status.duration_s, 1),
            "dropped": status.dropped,
            "lost": status.lost,
            "episode": status.episode,
        }
        return members | ({"why": status.why} if status.why else {})
