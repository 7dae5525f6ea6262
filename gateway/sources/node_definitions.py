# SPDX-License-Identifier: Apache-2.0
"""Definitions of types that are not installed here: the nodes that have them are asked.

A node has a service for that, ``~/get_type_description``, since Iron.
"""

import asyncio
import logging
from collections.abc import Awaitable, Callable, Mapping, Sequence
from itertools import chain
from typing import Any, Final, NamedTuple

from gateway.backports import timeout
from gateway.codec.error_text import CodecError
from gateway.codec.types import Types
from gateway.sources.client_cache import ClientCache
from gateway.sources.services import ServiceClient
from gateway.sources.source import Ros, RosError
from schemas.definition import Definition, DefinitionError
from schemas.described import described_definitions
from schemas.installed import InstalledDefinitions, UnknownTypeError
from schemas.learning import believed
from schemas.type_hash import type_hash

ASKED_AT_ONCE: Final = 4
ANSWER_S: Final = 5.0
ASKED_NODES: Final = 3  # of those with a type. Often a dozen have the same package
# A node that has not told a type is not asked for it again for so long. One without a service for
# that may be about to start it.
PAUSE_S: Final = 30.0
STARTING_S: Final = 2.0
MAX_SILENT: Final = 1024
_SERVICE: Final = "get_type_description"
_SERVICE_TYPE: Final = "type_description_interfaces/srv/GetTypeDescription"

_NO_ANSWER: Final = f"a node that has it has not answered within {ANSWER_S:g} s"
_MAX_REASON: Final = 200  # characters of what a node says
_ERRORS: Final = (CodecError, RosError, DefinitionError, UnknownTypeError)
_logger = logging.getLogger(__name__)


class TypeHolder(NamedTuple):
    """A node that has a type, and the hash of its definition (REP-2011)."""

    node: str  # empty for some milliseconds, until it has introduced itself
    type_hash: str


class _Silence(NamedTuple):
    """For how long a node is not asked, and why."""

    until_s: float  # loop time
    why: str


class NodeDefinitions:
    """Asks nodes for definitions. *on_change* is called when a node may be asked again.

    *holders* returns the other nodes that publish a type on a topic, then those that subscribe to
    it, without nodes that do not show a hash. Topics of types that are not installed can be used
    once *make_types* has ended.
    """

    def __init__(
        self,
        ros: Ros,
        definitions: InstalledDefinitions,
        on_change: Callable[[], None],
        *,
        holders: Callable[[str, str], Sequence[TypeHolder]],
        make_types: Callable[[], Awaitable[None]],
    ) -> None:
        self._ros = ros
        self._holders_on = holders
        self._make_types = make_types
        self._definitions = definitions
        self._types = Types(definitions)
        self._on_change = on_change
        self._clients: ClientCache[ServiceClient] = ClientCache()
        self._slots = asyncio.Semaphore(ASKED_AT_ONCE)
        self._graph_change = asyncio.Event()  # set for an instant
        self._silent: dict[TypeHolder, _Silence] = {}
        self._hashes: dict[str, str] = {}  # of types that are in use and not installed
        self._again: asyncio.TimerHandle | None = None

    def close(self) -> None:
        """Close what is open. *on_change* is not called any more."""
        self._clients.close()
        if self._again is not None:
            self._again.cancel()

    def on_graph_change(self) -> None:
        """Look again at nodes that have not introduced themselves."""
        self._graph_change.set()
        self._graph_change.clear()

    async def of(self, type_name: str) -> Mapping[str, Definition] | None:
        """Return the definition of a type, as `gateway.sources.source.Source.definitions` does.

        The caller uses it at once: it fits what is known when this returns.
        """
        known = self._known_hash(type_name)
        holders = await self._introduced(type_name, known)
        if not holders:
            if known is not None:
                self._hashes[type_name] = known
            return None
        reasons = [self._why_left_alone(each) for each in holders]
        asked = [each for each, why in zip(holders, reasons, strict=True) if why is None]
        why = next(filter(None, reasons), "")
        async with self._slots:
            if asked:
                await self._make_types()
            for holder in asked[:ASKED_NODES]:
                try:
                    return await self._ask(type_name, holder)
                except RosError as error:
                    why = str(error)
        raise RosError("not_found", why)

    async def _introduced(self, type_name: str, known: str | None) -> Sequence[TypeHolder]:
        """Wait until a node that may be asked has introduced itself. See `_holders`."""
        named: Sequence[TypeHolder] = ()
        try:
            async with timeout(ANSWER_S):
                while True:
                    holders = await self._holders(type_name, known)
                    named = [each for each in holders if each.node]
                    if len(named) == len(holders) or not all(map(self._why_left_alone, named)):
                        return named
                    await self._graph_change.wait()
        except TimeoutError:
            return named

    async def _holders(self, type_name: str, known: str | None) -> Sequence[TypeHolder]:
        """Return the nodes with a type, none if one of them has the definition that is known.

        The first of two that are in use stays: nodes with the other one are reported.
        """
        found: dict[TypeHolder, None] = {}
        for topic, type_names in self._ros.topics().items():
            if type_name in type_names:
                holders = self._holders_on(topic, type_name)
                if known in {each.type_hash for each in holders}:
                    return ()
                found |= dict.fromkeys(holders)
                await asyncio.sleep(0)  # other work has its turn: a topic takes 0.1 ms
        return tuple(found)

    def _known_hash(self, type_name: str) -> str | None:
        try:
            return type_hash(self._definitions.get(type_name), self._definitions)
        except (UnknownTypeError, DefinitionError):  # a node may have what a file has not
            return None

    async def _ask(self, type_name: str, holder: TypeHolder) -> Mapping[str, Definition]:
        """Ask one node for a type.

        Raises:
            RosError: that failed, and why.
        """
        silence = self._why_left_alone(holder)
        if silence is not None:  # since this was begun
            raise RosError("not_found", silence)
        service = f"{holder.node.rstrip('/')}/{_SERVICE}"
        if _SERVICE_TYPE not in self._ros.service_types(service):
            why = f"a node that has it does not offer {_SERVICE}"
            raise self._left_alone(holder, why, STARTING_S)
        try:
            async with timeout(ANSWER_S):
                answer = await self._call(service, type_name, holder)
            new = self._believed(type_name, holder, answer)
        except TimeoutError:
            _logger.warning("%s is not learned from %s: no answer", type_name, holder.node)
            raise self._left_alone(_whole(holder), _NO_ANSWER, PAUSE_S) from None
        except _ERRORS as error:
            _logger.warning("%s is not learned from %s: %s", type_name, holder.node, error)
            why = f"a node that has it says: {error}"
            raise self._left_alone(holder, why, PAUSE_S) from error
        self._hashes[type_name] = holder.type_hash
        _logger.info("%s is learned from %s", type_name, holder.node)
        return new

    async def _call(self, service: str, type_name: str, holder: TypeHolder) -> dict[str, Any]:
        request = {
            "type_name": type_name,
            "type_hash": holder.type_hash,
            "include_type_sources": True,
        }
        service_type = self._types.service(_SERVICE_TYPE)
        key = service, _SERVICE_TYPE
        with self._clients.use(key, lambda: self._ros.services.client(*key)) as client:
            response = await client.call(service_type.request.encode(request, 0))
        return service_type.response.decode(response)

    def _believed(
        self, type_name: str, holder: TypeHolder, answer: dict[str, Any]
    ) -> Mapping[str, Definition]:
        if not answer["successful"]:
            raise RosError("not_found", str(answer["failure_reason"])[:_MAX_REASON])
        told = described_definitions(answer)
        present = set(chain.from_iterable(self._ros.topics().values()))
        in_use = {name: known for name, known in self._hashes.items() if name in present}
        return believed(self._definitions, type_name, told, holder.type_hash, in_use)

    def _why_left_alone(self, holder: TypeHolder) -> str | None:
        now_s = asyncio.get_running_loop().time()
        for each in (holder, _whole(holder)):
            silence = self._silent.get(each)
            if silence is not None and silence.until_s > now_s:
                return silence.why
        return None

    def _left_alone(self, holder: TypeHolder, why: str, pause_s: float) -> RosError:
        """Leave a node alone for a while. Return the error that says why."""
        loop = asyncio.get_running_loop()
        if len(self._silent) >= MAX_SILENT:
            del self._silent[next(iter(self._silent))]
        self._silent[holder] = _Silence(loop.time() + pause_s, why)
        self._await_end()
        return RosError("not_found", why)

    def _await_end(self) -> None:
        if self._again is not None:
            self._again.cancel()
        loop = asyncio.get_running_loop()
        next_s = min((each.until_s for each in self._silent.values()), default=None)
        self._again = None if next_s is None else loop.call_at(next_s, self._ask_again)

    def _ask_again(self) -> None:
        now_s = asyncio.get_running_loop().time()
        self._silent = {key: each for key, each in self._silent.items() if each.until_s > now_s}
        self._await_end()
        self._on_change()


def _whole(holder: TypeHolder) -> TypeHolder:
    """Return the key for all types of a node: one that hangs answers for none."""
    return TypeHolder(holder.node, "")
