# SPDX-License-Identifier: Apache-2.0
"""The part of `gateway.sources.rclpy.made_types_check` that calls services.

std_srvs/srv/SetBool.
"""

import time
from typing import Any, Final

from rclpy.node import Node
from rclpy.serialization import deserialize_message, serialize_message
from std_srvs.srv import SetBool

from gateway.sources.rclpy import rclpy_private
from gateway.sources.rclpy.made_types import MadeTypes
from gateway.sources.rclpy.service_forms import ServiceForm, of_made, of_package
from schemas.installed import InstalledDefinitions

_NAME: Final = "std_srvs/srv/SetBool"
_AGAIN_S: Final = 0.2  # a request is lost if DDS has matched only half of a service yet
# DDS pads what it sends to a multiple of 4 bytes, and a large one comes in fragments.
_TEXTS: Final = ("", "a", "ab", "abc", "a" * 100_000)


class Calls:
    """Calls of one service, one after another. Each response has another length."""

    def __init__(self, node: Node, name: str, calling: ServiceForm, serving: ServiceForm) -> None:
        self._node = node
        self._name = name
        self._calling = calling
        self._serving = serving
        client = node.create_client(calling.service_class, name)
        service = node.create_service(serving.service_class, name, _never_called)
        self._is_ready = client.service_is_ready
        self._send = rclpy_private.request_sender(client)
        self._take_response = rclpy_private.response_taker(client)
        self._take_request = rclpy_private.request_taker(service)
        self._answer = rclpy_private.response_sender(service)
        self._left = list(_TEXTS)
        self._number: int | None = None  # of the request under way
        self._sent_s = 0.0
        self._is_wrong = False

    @property
    def is_over(self) -> bool:
        """True once all responses are there, or something is wrong."""
        return self._is_wrong or not self._left

    @property
    def fault(self) -> str:
        """The words for what is wrong. Empty if nothing is."""
        if self._is_wrong:
            return "calls of made services arrive as others here"
        if self._left:
            return "no calls pass between made services and real ones here"
        return "" if self._has_hashes() else "made services have no hashes here"

    def step(self) -> None:
        """Do what can be done now."""
        if not self.is_over:
            self._serve()
            self._receive()
        if not self.is_over and self._is_ready():
            self._call()

    def _has_hashes(self) -> bool:
        """Return whether DDS announces the made side with the hashes of the real one."""
        request, response = (f"{_NAME}_{part}" for part in ("Request", "Response"))
        known = InstalledDefinitions()
        writers = self._node.get_publishers_info_by_topic(f"rr{self._name}Reply", no_mangle=True)
        readers = self._node.get_subscriptions_info_by_topic(
            f"rq{self._name}Request", no_mangle=True
        )
        found = [{str(each.topic_type_hash) for each in side} for side in (readers, writers)]
        return found == [{known.get(part).type_hash} for part in (request, response)]

    def _call(self) -> None:
        if self._number is None or time.monotonic() > self._sent_s + _AGAIN_S:
            request = serialize_message(SetBool.Request(data=True))
            self._number = self._send(self._calling.to_request(request))
            self._sent_s = time.monotonic()

    def _serve(self) -> None:
        request, info = self._take_request(self._serving.service_class.Request)
        if info is not None:
            self._expect(self._serving, request, SetBool.Request(data=True))
            response = serialize_message(_response(self._left[0]))
            self._answer(self._serving.to_response(response), info.request_id)

    def _receive(self) -> None:
        info, response = self._take_response(self._calling.service_class.Response)
        if info is not None and info.request_id.sequence_number == self._number:
            self._expect(self._calling, response, _response(self._left.pop(0)))
            self._number = None

    def _expect(self, form: ServiceForm, message: Any, expected: Any) -> None:
        cdr = form.to_cdr(message)
        self._is_wrong |= bool(deserialize_message(cdr, type(expected)) != expected)


def open_calls(node: Node, made_types: MadeTypes, definitions: InstalledDefinitions) -> list[Calls]:
    """Begin to call a made service by a real client, and a real one by a made client."""
    made_class = made_types.service(definitions.interface(_NAME), definitions)
    made, real = of_made(_NAME, made_class), of_package(_NAME, SetBool)
    return [
        Calls(node, "/_calls_made", calling=real, serving=made),
        Calls(node, "/_calls_real", calling=made, serving=real),
    ]


def _response(text: str) -> Any:
    return SetBool.Response(success=True, message=text)


def _never_called(*_: object) -> None:
    """Serve as the callback that rclpy requires. Nothing calls it."""
