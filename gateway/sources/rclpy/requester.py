# SPDX-License-Identifier: Apache-2.0
"""Clients of services whose messages the event loop itself sends and takes.

Services consist of these and of `gateway.sources.rclpy.replier`, and so does most of an action. No
executor is involved: in rclpy 7.1 a service that answers later fails on the EventsExecutor, and
actions lose results on it.
"""

from typing import Any

from gateway.sources.rclpy.creating import group_of_one
from gateway.sources.rclpy.errors import creation, refusals, remapped
from gateway.sources.rclpy.rclpy_private.handles import request_sender, response_taker
from gateway.sources.rclpy.ready_events import SERVICE_PROFILE, Endpoints
from gateway.sources.requester import Requester
from gateway.sources.source import MAX_TAKES_PER_TURN


class RclpyRequester(Requester):
    """A client of rclpy with any number of requests under way. Servers are their DDS readers."""

    def __init__(
        self, endpoints: Endpoints, service_class: Any, name: str, *, subject: str, **options: Any
    ) -> None:
        """Create it. *options* are those of `Requester`.

        Raises:
            RosError: ROS refuses it, or gives it another name.
        """
        super().__init__(endpoints.loop, subject=subject, **options)
        node = endpoints.node
        self._node = node
        self._name = name
        self._response_class = service_class.Response
        with creation(subject):
            self._source = endpoints.ready_events.open(
                "client",
                lambda: node.create_client(
                    service_class, name, qos_profile=SERVICE_PROFILE, callback_group=group_of_one()
                ),
                node.destroy_client,
                self._take,
            )
        self._client = self._source.entity
        self._send_request = request_sender(self._client)
        self._take_response = response_taker(self._client)
        given = self._client.service_name
        if given != name:
            self.close()
            raise remapped(subject, given)

    def _has_server(self) -> bool:
        return bool(self._client.service_is_ready())

    def _transmit(self, request: Any) -> int:
        with refusals(self._subject):
            return self._send_request(request)

    def _destroy(self) -> None:
        self._source.close()

    def _find_servers(self) -> frozenset[bytes]:
        """Identify the servers by their DDS readers. 40 us.

        Empty with an rmw that names these topics otherwise than those of Fast DDS and Cyclone DDS.
        """
        topic = f"rq{self._name}Request"
        readers = self._node.get_subscriptions_info_by_topic(topic, no_mangle=True)
        return frozenset(bytes(reader.endpoint_gid) for reader in readers)

    def _take(self) -> None:
        for _ in range(MAX_TAKES_PER_TURN):
            info, message = self._take_response(self._response_class)
            is_pending = self._source.count_take()
            if info is None:
                if is_pending:
                    continue  # it could not be read
                return
            self._settle(info.request_id.sequence_number, message)
        self._source.notify_again()  # there may be more
