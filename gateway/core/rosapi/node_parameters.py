# SPDX-License-Identifier: Apache-2.0
"""The parameters of other nodes, over the standard parameter services."""

import asyncio
import contextlib
from collections.abc import Callable, Coroutine, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final

from gateway.backports import TaskGroup, timeout
from gateway.codec.error_text import did_you_mean, truncate
from gateway.codec.types import Types
from gateway.core.bad_type import bad_type
from gateway.core.deadline import Deadline
from gateway.core.errors import ProtocolError
from gateway.core.rosapi.graph_services import is_hidden
from gateway.core.rosapi.parameter_values import ParameterValueError, description, fitted, value_of
from gateway.core.rosapi.unresponsive_nodes import UnresponsiveNodes
from gateway.core.service_clients import ServiceClients
from gateway.sources.source import RosError, RosGraph
from schemas.definition import DefinitionError
from schemas.installed import UnknownTypeError

# A node that spins answers within milliseconds, after some tenths of a second for discovery.
# roslibpy gives rosapi 3 s.
NODE_TIMEOUT_S: Final = 2.5
# All nodes together, however many of them are dead, and each of these.
ALL_NODES_TIMEOUT_S: Final = 2.0
EACH_NODE_TIMEOUT_S: Final = 1.0
# A node that DDS has not matched with this client yet loses its answer, and only the node hears of
# it. Requests that change nothing are therefore sent again: after this time, then after twice as
# long.
ASK_AGAIN_S: Final = 1.2
# However long a client would wait: a node that is silent for longer has stopped spinning.
MAX_TIMEOUT_S: Final = 60.0
# Each takes a ROS client, of 256 entities in all. Two batches of dead nodes fit the time above.
NODES_AT_ONCE: Final = 32


@dataclass(frozen=True, slots=True)
class SetResult:
    """The result of setting a parameter, with the node's reason if it refused."""

    successful: bool
    reason: str = ""


@dataclass(frozen=True, slots=True)
class _Service:
    """One of the services that every node with parameters has."""

    name: str
    type_name: str
    items: str  # the field of the response with one item for each item of the request
    is_read: bool = True  # asking twice does no harm


_LIST: Final = _Service("list_parameters", "rcl_interfaces/srv/ListParameters", "result")
_GET: Final = _Service("get_parameters", "rcl_interfaces/srv/GetParameters", "values")
_SET: Final = _Service(
    "set_parameters", "rcl_interfaces/srv/SetParameters", "results", is_read=False
)
_DESCRIBE: Final = _Service(
    "describe_parameters", "rcl_interfaces/srv/DescribeParameters", "descriptors"
)


def node_timeout_s(asked: float | None, default: float = NODE_TIMEOUT_S) -> float:
    """Return the timeout of nodes for a client's *asked*. 0 asks for the longest."""
    return default if asked is None else min(asked or MAX_TIMEOUT_S, MAX_TIMEOUT_S)


class Parameters:
    """Reads and writes the parameters of any node.

    Nodes may be named without the leading slash. *timeout_s* covers all requests of one method to
    its node. Every method raises `ProtocolError`: ``not_found`` for an unknown node, ``timeout``
    for one that does not answer, or that has just left another request unanswered for as long.
    """

    def __init__(
        self,
        ros: RosGraph,
        types: Types,
        service_clients: ServiceClients,
        check: Callable[[str], None] = lambda service: None,
    ) -> None:
        """*check* raises `ProtocolError` for a service that those who ask may not call."""
        self._ros = ros
        self._types = types
        self._service_clients = service_clients
        self._check = check
        self.unresponsive = UnresponsiveNodes()

    async def list_names(
        self, node: str, prefixes: Sequence[str] = (), timeout_s: float = NODE_TIMEOUT_S
    ) -> list[str]:
        """Return the parameters of a node, sorted: all, or those at or below *prefixes*."""
        return await self._conversation(node, timeout_s).names(prefixes)

    async def get(
        self, node: str, names: Sequence[str] | None = None, timeout_s: float = NODE_TIMEOUT_S
    ) -> dict[str, object]:
        """Return the values of *names* or of all parameters. ``None`` if one has no value.

        `gateway.codec.json.dumps` takes the values. Bytes are base64.

        Raises:
            ProtocolError: also ``not_found`` if a parameter is not declared.
        """
        conversation = self._conversation(node, timeout_s)
        asked = sorted(await conversation.declared()) if names is None else names
        found = await conversation.ask_each(_GET, asked)
        values = {name: value_of(found[name]) if name in found else None for name in asked}
        # Nodes differ in their answers for an undeclared parameter. None reports it clearly.
        await conversation.check_declared([name for name in names or () if values[name] is None])
        return values

    async def set(
        self, node: str, values: Mapping[str, object], timeout_s: float = NODE_TIMEOUT_S
    ) -> dict[str, SetResult]:
        """Set values, each by itself. ``None`` undeclares a parameter.

        A value is sent with the type of the parameter, or with its own if that has none.
        """
        conversation = self._conversation(node, timeout_s)
        present = await conversation.ask_each(_DESCRIBE, list(values))
        results: dict[str, SetResult] = {}
        messages: dict[str, dict[str, object]] = {}
        for name, value in values.items():
            if "\0" in name:
                results[name] = SetResult(successful=False, reason="expected a name without U+0000")
                continue
            try:
                messages[name] = fitted(value, present.get(name))
            except ParameterValueError as error:
                results[name] = SetResult(successful=False, reason=str(error))
        for name, result in (await conversation.set(messages)).items():
            is_undeclared = name not in present and not result.successful
            results[name] = _undeclared(result) if is_undeclared else result
        return {name: results[name] for name in values}

    async def describe(
        self, node: str, names: Sequence[str] | None = None, timeout_s: float = NODE_TIMEOUT_S
    ) -> dict[str, dict[str, object]]:
        """Return the types, descriptions and limits of *names* or of all parameters.

        Raises:
            ProtocolError: also ``not_found`` if a parameter is not declared.
        """
        conversation = self._conversation(node, timeout_s)
        asked = sorted(await conversation.declared()) if names is None else names
        found = await conversation.ask_each(_DESCRIBE, asked)
        await conversation.check_declared([name for name in names or () if name not in found])
        return {name: description(found[name]) for name in asked if name in found}

    async def names_by_node(self, timeout_s: float = ALL_NODES_TIMEOUT_S) -> dict[str, list[str]]:
        """Return the parameters of all nodes that answer in time, sorted, without hidden nodes.

        It takes no longer than *timeout_s*. Nodes that did not respond before are asked last.
        """
        suffix = f"/{_LIST.name}"
        nodes = [
            service.name.removesuffix(suffix)
            for service in self._ros.graph().services
            if service.name.endswith(suffix)
            and _LIST.type_name in service.types
            and not is_hidden(service.name)
        ]
        found: dict[str, list[str]] = {}
        places = asyncio.Semaphore(NODES_AT_ONCE)

        async def look(node: str) -> None:
            try:
                found[node] = await self._with(node, EACH_NODE_TIMEOUT_S).names()
            except ProtocolError:
                pass  # the result leaves it out
            finally:
                places.release()

        with contextlib.suppress(TimeoutError):
            async with timeout(timeout_s), TaskGroup() as group:
                for node in sorted(nodes, key=self.unresponsive.noticed_s):
                    await places.acquire()
                    group.create_task(look(node))
                    # opening a ROS client takes milliseconds of the loop: one per iteration
                    await asyncio.sleep(0)
        return dict(sorted(found.items()))

    async def call(
        self, node: str, service: _Service, request: dict[str, object], deadline: Deadline
    ) -> dict[str, Any]:
        """Call a parameter service of a node. Raises what `ServiceClients.call` raises."""
        try:
            service_type = self._types.service(service.type_name)
        except (UnknownTypeError, DefinitionError) as error:
            raise bad_type(error, self._types.definitions) from error
        name = f"{node}/{service.name}"
        self._check(name)

        def ask() -> Coroutine[Any, Any, dict[str, Any]]:
            return self._service_clients.call(name, service_type, request, deadline)

        return await (_asked_again(ask) if service.is_read else ask())

    def offers(self, node: str, service: _Service) -> bool:
        """Return whether a node has a parameter service, as far as the graph knows."""
        return bool(self._ros.service_types(f"{node}/{service.name}"))

    def _conversation(self, requested: str, timeout_s: float) -> "_Conversation":
        node = requested if requested.startswith("/") else f"/{requested}"
        nodes = self._ros.graph().nodes
        if node not in nodes:
            near = did_you_mean(node, nodes)
            raise ProtocolError("not_found", f"node {truncate(node)} does not exist{near}")
        return self._with(node, timeout_s)

    def _with(self, node: str, timeout_s: float) -> "_Conversation":
        return _Conversation(self, node, Deadline.within(timeout_s))


class _Conversation:
    """The requests to one node within one deadline."""

    def __init__(self, parameters: Parameters, node: str, deadline: Deadline) -> None:
        self._parameters = parameters
        self._node = node
        self._deadline = deadline
        self._has_answered = False
        self._declared: frozenset[str] | None = None

    async def names(self, prefixes: Sequence[str] = ()) -> list[str]:
        # without a depth, the answer has all levels
        response = await self._ask(_LIST, {"prefixes": list(prefixes)})
        return sorted(response["names"])

    async def declared(self) -> frozenset[str]:
        """Return the names of all parameters of the node. It is asked once."""
        if self._declared is None:
            self._declared = frozenset(await self.names())
        return self._declared

    async def ask_each(self, service: _Service, names: Sequence[str]) -> dict[str, Any]:
        """Call a service about parameters. Leave out those that the node does not answer."""
        names = [name for name in names if "\0" not in name]  # no string in ROS can have one
        if not names:
            return {}
        items = await self._ask(service, {"names": names})
        if len(items) == len(names):
            return dict(zip(names, items, strict=True))
        # A single undeclared or uninitialised parameter silences both rclcpp and rclpy.
        if len(names) == 1:
            return {}
        declared = await self.declared()
        if not declared.issuperset(names):
            return await self.ask_each(service, [name for name in names if name in declared])
        middle = len(names) // 2
        found = await self.ask_each(service, names[:middle])
        return found | await self.ask_each(service, names[middle:])

    async def check_declared(self, names: Sequence[str]) -> None:
        """Raise an error if the node has not declared a parameter."""
        if not names:
            return
        declared = await self.declared()
        undeclared = [name for name in names if name not in declared]
        if undeclared:
            first = undeclared[0]
            reason = f"node {self._node} has not declared parameter {truncate(first)}"
            if len(undeclared) > 1:
                reason += f" (nor {len(undeclared) - 1} more)"
            reason += did_you_mean(first, sorted(declared))
            raise ProtocolError("not_found", reason)

    async def set(self, messages: Mapping[str, object]) -> dict[str, SetResult]:
        if not messages:
            return {}
        parameters = [{"name": name, "value": value} for name, value in messages.items()]
        results = await self._ask(_SET, {"parameters": parameters})
        if len(results) != len(messages):
            raise ProtocolError(
                "internal",
                f"node {self._node} answered {len(results)} results for {len(messages)} parameters",
            )
        return {
            name: SetResult(result["successful"], _reason(result))
            for name, result in zip(messages, results, strict=True)
        }

    async def _ask(self, service: _Service, request: dict[str, object]) -> Any:
        loop = asyncio.get_running_loop()
        node, timeout_s = self._node, self._deadline.timeout_s
        unresponsive = self._parameters.unresponsive
        if not self._has_answered and unresponsive.has_just_timed_out(node, timeout_s, loop.time()):
            raise self._no_answer()
        try:
            response = await self._parameters.call(node, service, request, self._deadline)
        except RosError as error:
            raise ProtocolError(error.code, truncate(str(error))) from error
        except ProtocolError as error:
            if error.code != "timeout":
                raise
            if not self._has_answered:
                unresponsive.add(node, timeout_s, loop.time())
            raise self._no_answer() from None
        self._has_answered = True
        unresponsive.remove(node)
        return response[service.items]

    def _no_answer(self) -> ProtocolError:
        if not self._parameters.offers(self._node, _LIST):
            return ProtocolError("not_found", f"node {self._node} offers no parameters")
        return self._deadline.error(f"node {self._node} has not answered")


async def _asked_again(ask: Callable[[], Coroutine[Any, Any, dict[str, Any]]]) -> dict[str, Any]:
    """Return the first answer, also a late one of a node that takes its time for each question."""
    asked: set[asyncio.Task[dict[str, Any]]] = set()
    wait_s = ASK_AGAIN_S
    try:
        while True:
            asked.add(asyncio.ensure_future(ask()))
            done, _ = await asyncio.wait(asked, timeout=wait_s, return_when=asyncio.FIRST_COMPLETED)
            if done:
                return next(iter(done)).result()
            wait_s *= 2
    finally:
        for each in asked:
            each.cancel()
        await asyncio.gather(*asked, return_exceptions=True)


def _undeclared(result: SetResult) -> SetResult:
    # rclpy's own reason: "Invalid access to undeclared parameter(s): []"
    return replace(result, reason=f"the node has not declared it: {result.reason}")


def _reason(result: Mapping[str, Any]) -> str:
    if result["successful"]:
        return ""
    return result["reason"] or "the node refuses it without a reason"
