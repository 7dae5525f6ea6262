# SPDX-License-Identifier: Apache-2.0
"""Topics, services, actions and nodes, in rosapi's form.

An unknown name has the type ``""`` and empty lists, as in rosbridge. Hidden names, those with a
part that begins with ``_``, are not listed, but can be asked for.
"""

from collections.abc import Callable, Iterable, Mapping
from typing import Final, TypeVar

from gateway.sources.graph import ServerInfo, TopicInfo
from gateway.sources.source import RosGraph
from schemas.installed import Kind

ROSAPI_NODE: Final = "/rosapi"

_Entry = TypeVar("_Entry", TopicInfo, ServerInfo)
_Answer = dict[str, object]


class GraphServices:
    """The services about the graph. *own* returns rosapi's services with their types.

    They are listed as if a node ``/rosapi`` provided them, as it does with rosbridge.
    """

    def __init__(self, ros: RosGraph, own: Callable[[], Mapping[str, str]]) -> None:
        self._ros = ros
        self._own = own

    def topics(self, _: Mapping[str, str]) -> _Answer:
        """List the topics, and the first type of each."""
        found = self.types_of_topics()
        return {"topics": list(found), "types": list(found.values())}

    def topics_for_type(self, request: Mapping[str, str]) -> _Answer:
        """List the topics of a type."""
        return {"topics": _of_type(self._ros.graph().topics, request["type"], "msg")}

    def topic_type(self, request: Mapping[str, str]) -> _Answer:
        """Answer with the type of a topic."""
        return {"type": _first_type(_find(self._ros.graph().topics, request["topic"]))}

    def publishers(self, request: Mapping[str, str]) -> _Answer:
        """List the nodes that publish a topic, each once."""
        topic = _find(self._ros.graph().topics, request["topic"])
        return {"publishers": _each_once(topic.publishers if topic else ())}

    def subscribers(self, request: Mapping[str, str]) -> _Answer:
        """List the nodes that subscribe to a topic, each once."""
        topic = _find(self._ros.graph().topics, request["topic"])
        return {"subscribers": _each_once(topic.subscribers if topic else ())}

    def services(self, _: Mapping[str, str]) -> _Answer:
        """List the services."""
        return {"services": [service.name for service in _visible(self._services())]}

    def services_for_type(self, request: Mapping[str, str]) -> _Answer:
        """List the services of a type."""
        return {"services": _of_type(self._services(), request["type"], "srv")}

    def service_type(self, request: Mapping[str, str]) -> _Answer:
        """Answer with the type of a service."""
        return {"type": _first_type(_find(self._services(), request["service"]))}

    def service_node(self, request: Mapping[str, str]) -> _Answer:
        """Answer with a node that provides a service."""
        service = _find(self._services(), request["service"])
        return {"node": service.nodes[0] if service and service.nodes else ""}

    def service_providers(self, request: Mapping[str, str]) -> _Answer:
        """List the nodes that provide services of a type. The field ``service`` holds the type."""
        type_name = full_type(request["service"], "srv")
        services = [service for service in self._services() if type_name in service.types]
        return {"providers": _each_once(node for service in services for node in service.nodes)}

    def nodes(self, _: Mapping[str, str]) -> _Answer:
        """List the nodes."""
        nodes = {node for node in self._ros.graph().nodes if not is_hidden(node)}
        return {"nodes": sorted(nodes | {ROSAPI_NODE})}

    def node_details(self, request: Mapping[str, str]) -> _Answer:
        """List the topics that a node subscribes to and publishes, and the services it provides."""
        node = _full_name(request["node"])
        topics = _visible(self._ros.graph().topics)
        services = _visible(self._services())
        return {
            "subscribing": [topic.name for topic in topics if node in topic.subscribers],
            "publishing": [topic.name for topic in topics if node in topic.publishers],
            "services": [service.name for service in services if node in service.nodes],
        }

    def action_servers(self, _: Mapping[str, str]) -> _Answer:
        """List the actions that have a server."""
        return {"action_servers": [action.name for action in _visible(self._ros.graph().actions)]}

    def action_type(self, request: Mapping[str, str]) -> _Answer:
        """Answer with the type of an action."""
        return {"type": _first_type(_find(self._ros.graph().actions, request["action"]))}

    def types_of_topics(self) -> dict[str, str]:
        """Return the first type of each topic that is not hidden."""
        return {each.name: _first_type(each) for each in _visible(self._ros.graph().topics)}

    def _services(self) -> list[ServerInfo]:
        own = [ServerInfo(name, (type_,), (ROSAPI_NODE,)) for name, type_ in self._own().items()]
        names = {each.name for each in own}
        others = [each for each in self._ros.graph().services if each.name not in names]
        return sorted([*others, *own], key=lambda service: service.name)


def full_type(requested: str, kind: Kind) -> str:
    """Return ``pkg/KIND/Name`` for ``pkg/Name``, and any other text unchanged."""
    package, slash, name = requested.partition("/")
    return f"{package}/{kind}/{name}" if slash and "/" not in name else requested


def is_hidden(name: str) -> bool:
    """Return whether a part of a name begins with ``_``."""
    return "/_" in name


def _visible(entries: Iterable[_Entry]) -> list[_Entry]:
    return [entry for entry in entries if not is_hidden(entry.name)]


def _find(entries: Iterable[_Entry], name: str) -> _Entry | None:
    full_name = _full_name(name)
    return next((entry for entry in entries if entry.name == full_name), None)


def _full_name(name: str) -> str:
    return name if name.startswith("/") else f"/{name}"


def _first_type(entry: TopicInfo | ServerInfo | None) -> str:
    return entry.types[0] if entry and entry.types else ""


def _of_type(entries: Iterable[_Entry], requested: str, kind: Kind) -> list[str]:
    type_name = full_type(requested, kind)
    return [entry.name for entry in _visible(entries) if type_name in entry.types]


def _each_once(names: Iterable[str]) -> list[str]:
    return sorted(set(names))
