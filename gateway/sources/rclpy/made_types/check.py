# SPDX-License-Identifier: Apache-2.0
"""Try whether this ROS takes made types: exit code 0 if it does.

A sample goes from a real publisher to a made subscription. Another one goes from a made publisher
to a real subscription. Both are of std_msgs/msg/Header within this process. Services are called
likewise, those of std_srvs/srv/SetBool. A fault is one line on stdout. A crash says nothing.
`gateway.sources.rclpy.message_classes` runs it, before it makes any types.
"""

import os
import resource
import sys
import time
from typing import Any, Final

import rclpy
from rclpy.context import Context
from rclpy.node import Node
from rclpy.serialization import deserialize_message, serialize_message
from std_msgs.msg import Header
from std_srvs.srv import SetBool

from gateway.sources.rclpy.errors import REFUSALS, refused
from gateway.sources.rclpy.made_types.classes import MadeTypes, check_middleware
from gateway.sources.rclpy.rclpy_private.handles import (
    message_taker,
    request_sender,
    request_taker,
    response_sender,
    response_taker,
)
from gateway.sources.rclpy.service_forms import ServiceForm, of_made, of_package
from gateway.sources.rclpy.shared_memory import without_shared_memory
from gateway.sources.source import RosError
from schemas.installed import InstalledDefinitions
from schemas.type_hash import type_hash

_HEADER: Final = "std_msgs/msg/Header"
_SET_BOOL: Final = "std_srvs/srv/SetBool"
_WITHIN_S: Final = 50
_STEP_S: Final = 0.005
_TO_MADE: Final = "/_to_made"
_FROM_MADE: Final = "/_from_made"
_AGAIN_S: Final = 0.2  # a request is lost if DDS has matched only half of a service yet
# DDS pads what it sends to a multiple of 4 bytes, and a large one comes in fragments.
_TEXTS: Final = ("", "a", "ab", "abc", "a" * 100_000)


def main() -> int:
    """Try it."""
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    try:
        check_middleware()
        wrong = _exchange()
    except RosError as error:
        wrong = str(error)
    except REFUSALS as error:
        wrong = str(refused("made types", error)).partition("\n")[0]
    if wrong:
        print(wrong)  # noqa: T201
    return 1 if wrong else 0


def _exchange() -> str:
    """Try everything at once, and return the first fault in words."""
    context = Context()
    with without_shared_memory():  # which would stay, as this process ends at once
        rclpy.init(context=context, args=[])
        # nothing spins it: samples, requests and responses are taken here
        node = Node("_made_types_check", context=context, start_parameter_services=False)
    definitions, made_types = InstalledDefinitions(), MadeTypes()
    calls = open_calls(node, made_types, definitions)
    parts: list[_Topics | Calls] = [_Topics(node, made_types, definitions), *calls]
    end_s = time.monotonic() + _WITHIN_S
    while not all(part.is_over for part in parts) and time.monotonic() < end_s:
        for part in parts:
            part.step()
        time.sleep(_STEP_S)
    return next((part.fault for part in parts if part.fault), "")


class _Topics:
    """A sample in either direction, sent until it arrives."""

    def __init__(
        self, node: Node, made_types: MadeTypes, definitions: InstalledDefinitions
    ) -> None:
        header = definitions.get(_HEADER)
        self._hash = type_hash(header, definitions)
        made = made_types.get(header, definitions)
        self._node = node
        self._publishers = [
            node.create_publisher(Header, _TO_MADE, 10),
            node.create_publisher(made, _FROM_MADE, 10),
        ]
        subscriptions = [
            node.create_subscription(made, _TO_MADE, _never_called, 10, raw=True),
            node.create_subscription(Header, _FROM_MADE, _never_called, 10, raw=True),
        ]
        self._takers = list(map(message_taker, subscriptions))
        self._classes = [made, Header]
        self._heard: list[bytes | None] = [None, None]
        self._message = Header(frame_id="made")

    @property
    def is_over(self) -> bool:
        """True once both have arrived."""
        return None not in self._heard

    @property
    def fault(self) -> str:
        """The words for what is wrong. Empty if nothing is."""
        heard = [cdr for cdr in self._heard if cdr is not None]
        if len(heard) < len(self._heard):
            return "no messages pass between made types and real ones here"
        if any(deserialize_message(cdr, Header) != self._message for cdr in heard):
            return "messages of made types arrive as others here"
        found = self._node.get_publishers_info_by_topic(_FROM_MADE)
        if {str(each.topic_type_hash) for each in found} != {self._hash}:
            return "made types have no hash here"
        return ""

    def step(self) -> None:
        """Send and take."""
        if self.is_over:
            return
        for publisher in self._publishers:
            publisher.publish(serialize_message(self._message))
        for index, take in enumerate(self._takers):
            taken = take(self._classes[index], True)  # raw
            if taken is not None:
                self._heard[index] = taken[0]


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
        self._send = request_sender(client)
        self._take_response = response_taker(client)
        self._take_request = request_taker(service)
        self._answer = response_sender(service)
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
        request, response = (f"{_SET_BOOL}_{part}" for part in ("Request", "Response"))
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
    made_class = made_types.service(definitions.interface(_SET_BOOL), definitions)
    made, real = of_made(_SET_BOOL, made_class), of_package(_SET_BOOL, SetBool)
    return [
        Calls(node, "/_calls_made", calling=real, serving=made),
        Calls(node, "/_calls_real", calling=made, serving=real),
    ]


def _response(text: str) -> Any:
    return SetBool.Response(success=True, message=text)


def _never_called(*_: object) -> None:
    """Serve as the callback that rclpy requires. Nothing calls it."""


if __name__ == "__main__":
    code = main()
    sys.stdout.flush()
    os._exit(code)  # DDS would take 0.3 s to close what nobody uses
