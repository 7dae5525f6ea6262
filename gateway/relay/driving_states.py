# SPDX-License-Identifier: Apache-2.0
"""The states of a robot's command topics at a relay, and the clients that follow them.

The robot sends them once to each relay, and the relay passes them on to any number of clients.
"""

import asyncio
import time
from collections.abc import Callable, Iterable
from functools import partial
from typing import Any, Final

from gateway.core.commands.clients import Watchers
from gateway.core.commands.rules import named_topic
from gateway.core.errors import ProtocolError
from gateway.core.names import TopicName
from gateway.core.requests import AcquireControl, Control, ReleaseControl
from gateway.core.session import Session
from gateway.core.tasks import FAILURES, refuse
from gateway.sources.zenoh.driving_wire import TopicControl

# The robot sends its states once a second.
STATE_S: Final = 3.0
MAX_QUESTIONS: Final = 4096  # that wait for a state

SILENT: Final = "the robot's gateway does not answer: check its network, and try again"

Question = AcquireControl | ReleaseControl | Control


class RobotStates:
    """The newest states.

    The robot has the *usual* command topics until it says otherwise. A client has the name at the
    robot that *name_of* returns. Whenever `is_needed` may have changed, *on_need* is called.
    """

    def __init__(
        self,
        usual: Iterable[str],
        name_of: Callable[[Session], str | None],
        on_need: Callable[[], None],
    ) -> None:
        self._usual = tuple(map(TopicName, usual))
        self._name_of, self._on_need = name_of, on_need
        self._states: dict[TopicName, TopicControl] = {}
        self._noted_s: float | None = None
        self._watchers: dict[TopicName, Watchers] = {}
        self._questions: list[tuple[Session, Question]] = []
        self._timer: asyncio.TimerHandle | None = None

    @property
    def names(self) -> tuple[TopicName, ...]:
        """The command topics of the robot."""
        return tuple(self._states) or self._usual

    @property
    def is_needed(self) -> bool:
        """True while a client follows a state, or waits for one."""
        return bool(self._questions) or any(map(len, self._watchers.values()))

    def of(self, topic: str) -> TopicControl | None:
        """Return the state of a topic, once the robot has sent it."""
        return self._states.get(TopicName(topic))

    def is_held_by(self, name: str) -> bool:
        """Return whether a client has control of a topic, by its name at the robot."""
        return any(state.holder == name for state in self._states.values())

    def note(self, topics: Iterable[TopicControl]) -> None:
        """Take the states that the robot has sent, and pass on those that have changed."""
        states = {TopicName(state.topic): state for state in topics}
        changed = [name for name in states if states[name] != self._states.get(name)]
        self._states, self._noted_s = states, time.monotonic()
        for name in changed:
            if name in self._watchers:
                self._watchers[name].notify()
        questions, self._questions = self._questions, []
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None
        for session, request in questions:
            try:
                self.answer(session, request, named_topic(session, request.topic, self.names))
            except FAILURES as error:
                refuse(session, request, error)
        self._on_need()

    def answer(self, session: Session, request: Question, name: TopicName) -> None:
        """Answer with the state of a topic, now or once the robot has sent it.

        Raises:
            ProtocolError: too many wait for it.
        """
        is_new = self._noted_s is not None and time.monotonic() - self._noted_s < STATE_S
        if name in self._states and is_new:
            session.answer(request.kind, request.id, **self._state(session, name))
            return
        if len(self._questions) >= MAX_QUESTIONS:
            raise ProtocolError("timeout", SILENT)
        self._questions.append((session, request))
        self._on_need()
        if self._timer is None:
            self._timer = asyncio.get_running_loop().call_later(STATE_S, self._give_up)

    def watch(self, session: Session, name: TopicName) -> None:
        """Send a client the changes of a topic."""
        watchers = self._watchers.get(name)
        if watchers is None:
            watchers = self._watchers[name] = Watchers(partial(self._send, name))
        watchers.add(session)
        self._on_need()

    def unwatch(self, session: Session, name: TopicName) -> None:
        """Send a client no changes of a topic any more."""
        if name in self._watchers:
            self._watchers[name].discard(session)
            self._on_need()

    def leave(self, session: Session) -> None:
        """Forget a client."""
        for watchers in self._watchers.values():
            watchers.discard(session)
        self._questions = [each for each in self._questions if each[0] is not session]

    def close(self) -> None:
        """Forget all clients."""
        for watchers in self._watchers.values():
            watchers.close()
        self._questions.clear()
        if self._timer is not None:
            self._timer.cancel()

    def _state(self, session: Session, name: TopicName) -> dict[str, Any]:
        state, own = self._states[name], self._name_of(session)
        holder = state.holder and ("you" if state.holder == own else "other")
        return {"topic": name, **state.members, "holder": holder}

    def _send(self, name: TopicName, session: Session) -> None:
        if name in self._states:
            session.answer("control", None, **self._state(session, name))

    def _give_up(self) -> None:
        self._timer = None
        questions, self._questions = self._questions, []
        for session, request in questions:
            session.refuse(ProtocolError("timeout", SILENT), request)
        self._on_need()
