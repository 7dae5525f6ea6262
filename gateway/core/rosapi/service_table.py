# SPDX-License-Identifier: Apache-2.0
"""The table of the rosapi services: the name, the type and the implementation of each."""

from collections.abc import Awaitable, Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import cast

from typing_extensions import assert_never

from gateway.codec.error_text import CodecError
from gateway.codec.types import Types
from gateway.core.errors import ProtocolError
from gateway.core.rosapi.graph_services import GraphServices
from gateway.core.rosapi.interfaces import interfaces_prefix
from gateway.core.rosapi.node_parameters import Parameters
from gateway.core.rosapi.parameter_services import ParameterServices
from gateway.core.rosapi.type_services import TypeServices
from gateway.sources.source import RosGraph
from schemas.installed import InstalledDefinitions
from schemas.interface import part_name

Answer = dict[str, object]
_Request = Mapping[str, str]  # every field of every request is a string


@dataclass(frozen=True, slots=True)
class _Local:
    """A service that the gateway answers at once."""

    type_name: str
    answer: Callable[[_Request], Answer]


@dataclass(frozen=True, slots=True)
class _Remote:
    """A service that needs answers of other nodes."""

    type_name: str
    answer: Callable[[_Request, float | None], Awaitable[Answer]]


class Rosapi:
    """Answers the services below ``/rosapi/``, by their resolved names.

    The definitions in this package check requests, whatever version of rosapi_msgs is installed:
    clients of all versions must work.
    """

    def __init__(
        self,
        ros: RosGraph,
        definitions: InstalledDefinitions,
        parameters: Parameters,
        sees: Callable[[str], bool] = lambda name: True,
    ) -> None:
        """*sees* returns whether a name exists for those who ask."""
        self._ros = ros
        self._sees = sees
        self._requests = Types(InstalledDefinitions([interfaces_prefix()]))
        graph = GraphServices(ros, self.types)
        types = TypeServices(graph, definitions)
        params = ParameterServices(parameters)
        self._services: dict[str, _Local | _Remote] = {
            "/rosapi/topics": _Local("Topics", graph.topics),
            "/rosapi/topics_for_type": _Local("TopicsForType", graph.topics_for_type),
            "/rosapi/topics_and_raw_types": _Local("TopicsAndRawTypes", types.topics_and_raw_types),
            "/rosapi/topic_type": _Local("TopicType", graph.topic_type),
            "/rosapi/publishers": _Local("Publishers", graph.publishers),
            "/rosapi/subscribers": _Local("Subscribers", graph.subscribers),
            "/rosapi/services": _Local("Services", graph.services),
            "/rosapi/services_for_type": _Local("ServicesForType", graph.services_for_type),
            "/rosapi/service_type": _Local("ServiceType", graph.service_type),
            "/rosapi/service_node": _Local("ServiceNode", graph.service_node),
            "/rosapi/service_providers": _Local("ServiceProviders", graph.service_providers),
            "/rosapi/nodes": _Local("Nodes", graph.nodes),
            "/rosapi/node_details": _Local("NodeDetails", graph.node_details),
            "/rosapi/action_servers": _Local("GetActionServers", graph.action_servers),
            "/rosapi/action_type": _Local("ActionType", graph.action_type),
            "/rosapi/interfaces": _Local("Interfaces", types.interfaces),
            "/rosapi/message_details": _Local("MessageDetails", types.message_details),
            "/rosapi/service_request_details": _Local(
                "ServiceRequestDetails", types.details("srv", "request")
            ),
            "/rosapi/service_response_details": _Local(
                "ServiceResponseDetails", types.details("srv", "response")
            ),
            "/rosapi/action_goal_details": _Local(
                "ActionGoalDetails", types.details("action", "goal")
            ),
            "/rosapi/action_result_details": _Local(
                "ActionResultDetails", types.details("action", "result")
            ),
            "/rosapi/action_feedback_details": _Local(
                "ActionFeedbackDetails", types.details("action", "feedback")
            ),
            "/rosapi/get_param": _Remote("GetParam", params.get_param),
            "/rosapi/set_param": _Remote("SetParam", params.set_param),
            "/rosapi/delete_param": _Remote("DeleteParam", params.delete_param),
            "/rosapi/has_param": _Remote("HasParam", params.has_param),
            "/rosapi/get_param_names": _Remote("GetParamNames", params.get_param_names),
            "/rosapi/get_time": _Local("GetTime", self._time),
            "/rosapi/get_ros_version": _Local("GetROSVersion", self._version),
        }

    def has(self, service: str) -> bool:
        """Return whether rosapi has this service."""
        return service in self._services

    def type_of(self, service: str) -> str:
        """Return the type of a rosapi service, ``rosapi_msgs/srv/Name``."""
        return f"rosapi_msgs/srv/{self._services[service].type_name}"

    def types(self) -> dict[str, str]:
        """Return the services of rosapi that exist for those who ask, with their types."""
        return {name: self.type_of(name) for name in self._services if self._sees(name)}

    def answer(
        self, service: str, args: object, timeout_s: float | None = None
    ) -> Answer | Callable[[], Awaitable[Answer]]:
        """Answer a call of a rosapi service, or return a function that asks other nodes first.

        *args* are the values of the request's fields, by name or in order. ``None`` means none are
        given. *timeout_s* is for other nodes: ``None`` is the default of each service, 0 the
        longest.

        Raises:
            ProtocolError: *args* do not fit, or name no type. The returned function may also
                raise it.
        """
        found = self._services[service]
        request = self._request(self.type_of(service), args)
        match found:
            case _Local():
                return found.answer(request)
            case _Remote():
                return partial(found.answer, request, timeout_s)
        assert_never(found)

    def _request(self, type_name: str, args: object) -> _Request:
        # the responses may nest types that are not installed
        request = self._requests.get(part_name(type_name, "request"))
        try:
            values = request.named(args) if isinstance(args, list) else args
            cdr = request.encode({} if values is None else values, self._ros.now_ns, "args")
        except CodecError as error:
            raise ProtocolError("invalid_value", str(error)) from error
        # checked, and with the defaults of what is left out
        return cast("_Request", request.decode(cdr))

    def _time(self, _: _Request) -> Answer:
        sec, nanosec = divmod(self._ros.now_ns(), 1_000_000_000)
        # roslibpy reads the names of ROS 1
        return {"time": {"sec": sec, "nanosec": nanosec, "secs": sec, "nsecs": nanosec}}

    def _version(self, _: _Request) -> Answer:
        return {"version": 2, "distro": self._ros.distro}
