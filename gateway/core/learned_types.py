# SPDX-License-Identifier: Apache-2.0
"""Types that are not installed here: the robot's nodes have their definitions.

A node has a service for that, ``~/get_type_description``, since Iron. Topics with such types are
looked at as the graph changes, so that their types are mostly known before a client asks for one.
"""

import asyncio
import logging
from collections.abc import Callable, Sequence
from itertools import chain
from typing import Final

from gateway.codec.types import Types
from gateway.core.deadline import Deadline
from gateway.core.errors import ProtocolError
from gateway.core.service_clients import ServiceClients
from gateway.sources.source import Ros, RosError, TypeHolder
from schemas.definition import DefinitionError
from schemas.described import described_definitions
from schemas.installed import UnknownTypeError, is_message_name
from schemas.learning import learn
from schemas.type_hash import type_hash

ASKED_AT_ONCE: Final = 4
ANSWER_S: Final = 5.0
ASKED_NODES: Final = 3  # of those with a type. Often a dozen have the same package
# A node that has not told a type is not asked for it again for so long. One without a service for
# that may be about to start it.
PAUSE_S: Final = 30.0
STARTING_S: Final = 2.0
MAX_SILENT: Final = 1024
# Between two looks at all topics: a robot that starts changes its graph for seconds, and a topic
# whose type is not installed takes 0.1 ms.
LOOK_S: Final = 1.0
_TOLD_S: Final = 0.02  # so that types that are learned together are followed once
_SERVICE: Final = "get_type_description"
_SERVICE_TYPE: Final = "type_description_interfaces/srv/GetTypeDescription"

_NO_ANSWER: Final = f"a node that has it has not answered within {ANSWER_S:g} s"
_MAX_REASON: Final = 200  # characters of what a node says
_ERRORS: Final = (ProtocolError, RosError, DefinitionError, UnknownTypeError)
_logger = logging.getLogger(__name__)


class LearnedTypes:
    """Asks nodes for definitions. *on_change* is called some time after one came, or did not."""

    def __init__(
        self,
        ros: Ros,
        types: Types,
        clients: ServiceClients,
        on_change: Callable[[], None],
        *,
        asks_nodes: bool = True,
    ) -> None:
        self._ros = ros
        self._definitions = types.definitions
        self._types = types
        self._clients = clients
        self._on_change = on_change
        self._asks_nodes = asks_nodes
        self._carried: set[str] = set()  # types whose definitions the source has given
        self._asking: dict[str, asyncio.Task[None]] = {}  # by type
        self._slots = asyncio.Semaphore(ASKED_AT_ONCE)
        self._silent: dict[TypeHolder, float] = {}  # and until when
        self._hashes: dict[str, str] = {}  # of types that are in use and not installed
        self._looking: asyncio.Task[None] | None = None
        self._has_changed = False
        self._telling: asyncio.TimerHandle | None = None
        self._again: asyncio.TimerHandle | None = None

    def close(self) -> None:
        """End what is under way. Nobody is asked, and *on_change* is not called, any more."""
        self._asks_nodes = False
        for task in (*self._asking.values(), *filter(None, [self._looking])):
            task.cancel()
        for timer in filter(None, (self._telling, self._again)):
            timer.cancel()

    def on_graph_change(self) -> None:
        """Look soon for types that are not known, or not as they are now."""
        self._has_changed = True
        if self._asks_nodes and self._looking is None:
            self._looking = asyncio.create_task(self._look())

    def ask(self, topic: str, type_name: str) -> bool:
        """Ask a node for the type of a topic, unless it is known. Return whether one is asked."""
        if type_name in self._asking:
            return True
        if type_name in self._carried or not self._may_ask(type_name):
            return False
        holders = self._ros.type_holders(topic, type_name)
        known = self._known_hash(type_name)
        if known is not None and (not holders or self._is_in_use(type_name, known, holders)):
            self._hashes[type_name] = known
            return False
        named = [each for each in holders if each.node]
        asked = [each for each in named if not self._is_left_alone(each)]
        if not asked:
            return len(named) < len(holders)  # one introduces itself, which changes the graph
        self._definitions.note_untold(type_name, "a node that has it is being asked")
        task = asyncio.create_task(self._ask(type_name, asked[:ASKED_NODES]))
        self._asking[type_name] = task
        return True

    async def _look(self) -> None:
        try:
            while self._has_changed:
                self._has_changed = False
                for topic, type_names in self._ros.topics().items():
                    for type_name in type_names:
                        if self._may_ask(type_name):
                            self.ask(topic, type_name)
                            await asyncio.sleep(0)  # other work has its turn
                await asyncio.sleep(LOOK_S)
        finally:
            self._looking = None

    def _is_in_use(self, type_name: str, known: str, holders: Sequence[TypeHolder]) -> bool:
        """Return whether a node has the definition that is known, on this topic or any other.

        The first of two that are in use stays: nodes with the other one are reported.
        """
        if known in {each.type_hash for each in holders}:
            return True
        return any(
            known in {each.type_hash for each in self._ros.type_holders(topic, type_name)}
            for topic, type_names in self._ros.topics().items()
            if type_name in type_names
        )

    def _is_left_alone(self, holder: TypeHolder) -> bool:
        now_s = asyncio.get_running_loop().time()
        return any(self._silent.get(each, 0.0) > now_s for each in (holder, _whole(holder)))

    def _may_ask(self, type_name: str) -> bool:
        is_message = self._asks_nodes and is_message_name(type_name)
        return is_message and not self._definitions.is_installed(type_name)

    def _known_hash(self, type_name: str) -> str | None:
        try:
            return type_hash(self._definitions.get(type_name), self._definitions)
        except (UnknownTypeError, DefinitionError):  # a node may have what a file has not
            return None

    async def _ask(self, type_name: str, holders: Sequence[TypeHolder]) -> None:
        try:
            async with self._slots:
                told = await self._ros.definitions(type_name)
                if told is not None:
                    self._definitions.tell(told)
                    self._carried.add(type_name)
                    return
                await self._ros.make_types()
                for holder in holders:
                    why = await self._learn(type_name, holder)
                    if why is None:
                        return
                    self._definitions.note_untold(type_name, why)
        finally:
            del self._asking[type_name]
            if self._telling is None and self._asks_nodes:
                loop = asyncio.get_running_loop()
                self._telling = loop.call_later(_TOLD_S, self._tell)

    async def _learn(self, type_name: str, holder: TypeHolder) -> str | None:
        """Learn a type of one node. Return in words why that failed."""
        if self._is_left_alone(holder):  # since this was begun
            return _NO_ANSWER
        service = f"{holder.node.rstrip('/')}/{_SERVICE}"
        if _SERVICE_TYPE not in self._ros.service_types(service):
            self._leave_alone(holder, STARTING_S)
            return f"a node that has it does not offer {_SERVICE}"
        try:
            await self._learn_by(service, type_name, holder)
        except _ERRORS as error:
            _logger.warning("%s is not learned from %s: %s", type_name, holder.node, error)
            is_late = isinstance(error, ProtocolError) and error.code == "timeout"
            self._leave_alone(_whole(holder) if is_late else holder, PAUSE_S)
            return _NO_ANSWER if is_late else f"a node that has it says: {error}"
        self._hashes[type_name] = holder.type_hash
        _logger.info("%s is learned from %s", type_name, holder.node)
        return None

    async def _learn_by(self, service: str, type_name: str, holder: TypeHolder) -> None:
        request = {
            "type_name": type_name,
            "type_hash": holder.type_hash,
            "include_type_sources": True,
        }
        service_type = self._types.service(_SERVICE_TYPE)
        deadline = Deadline.within(ANSWER_S)
        answer = await self._clients.call(service, service_type, request, deadline)
        if not answer["successful"]:
            raise ProtocolError("not_found", str(answer["failure_reason"])[:_MAX_REASON])
        told = described_definitions(answer)
        present = set(chain.from_iterable(self._ros.topics().values()))
        in_use = {name: known for name, known in self._hashes.items() if name in present}
        learn(self._definitions, type_name, told, holder.type_hash, in_use)

    def _leave_alone(self, holder: TypeHolder, pause_s: float) -> None:
        loop = asyncio.get_running_loop()
        if len(self._silent) >= MAX_SILENT:
            del self._silent[next(iter(self._silent))]
        self._silent[holder] = loop.time() + pause_s
        if self._again is not None:
            self._again.cancel()
        self._again = loop.call_at(min(self._silent.values()), self._look_again)

    def _look_again(self) -> None:
        loop = asyncio.get_running_loop()
        now_s = loop.time()
        self._silent = {each: until for each, until in self._silent.items() if until > now_s}
        next_s = min(self._silent.values(), default=None)
        self._again = None if next_s is None else loop.call_at(next_s, self._look_again)
        self.on_graph_change()

    def _tell(self) -> None:
        self._telling = None
        self._on_change()


def _whole(holder: TypeHolder) -> TypeHolder:
    """Return what stands for all types of a node: one that hangs answers for none."""
    return TypeHolder(holder.node, "")
