# SPDX-License-Identifier: Apache-2.0
"""Services of the rest of the robot, by rclpy's own clients and servers."""

import asyncio
import time
from collections.abc import Callable
from typing import Any

from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.serialization import deserialize_message, serialize_message
from rclpy.task import Future

from gateway.sources.rclpy.interfaces import service_class
from gateway.sources.services import ServiceRequest

KNOWN_S = 3  # a client that has gone is no longer waited for


async def arrived(future: Any) -> Any:
    """Wait on the loop for a future of an executor's thread."""
    loop = asyncio.get_running_loop()
    result: asyncio.Future[Any] = loop.create_future()

    def settle() -> None:
        if not result.done():
            result.set_result(future.result())

    future.add_done_callback(lambda _: loop.call_soon_threadsafe(settle))
    return await result


def until_known(node: Node, *services: str) -> None:
    """Wait on the executor's thread until the clients of these services have been discovered.

    A response to a client that is not is lost 0.1 s later, which is soon on a busy machine.
    """
    end_s = time.monotonic() + KNOWN_S
    while not all(map(node.count_clients, services)) and time.monotonic() < end_s:
        time.sleep(0.005)


class OutsideRequest:
    """A request that the executor's thread has taken, and whose answer it waits for."""

    def __init__(self, cdr: bytes, answer: Callable[[bytes], None]) -> None:
        self.cdr = cdr
        self.answer = answer


class OutsideService:
    def __init__(
        self,
        node: Node,
        wake: Callable[[], None],
        name: str,
        type_name: str,
        on_request: Callable[[ServiceRequest], None],
        depth: int,
    ) -> None:
        self._node = node
        self._name = name
        self._wake = wake
        self._loop = asyncio.get_running_loop()
        self._class = service_class(type_name)
        self._on_request = on_request
        self._service: Any = node.create_service(
            self._class,
            name,
            self._execute,
            qos_profile=QoSProfile(depth=depth),
            callback_group=ReentrantCallbackGroup(),
        )

    def close(self) -> None:
        if self._service is not None:
            service, self._service = self._service, None
            self._node.destroy_service(service)

    async def _execute(self, request: Any, _: Any) -> Any:
        until_known(self._node, self._name)
        response: Any = Future()

        def answer(cdr: bytes) -> None:
            if self._service is not None:
                response.set_result(deserialize_message(cdr, self._class.Response))
                self._wake()

        arrived = OutsideRequest(serialize_message(request), answer)
        self._loop.call_soon_threadsafe(self._on_request, arrived)
        return await response


class OutsideClient:
    def __init__(self, node: Node, name: str, type_name: str, is_known: Callable[[], bool]) -> None:
        self._node = node
        self._is_known = is_known
        self._class = service_class(type_name)
        self._client: Any = node.create_client(self._class, name, qos_profile=QoSProfile(depth=100))

    async def call(self, request: bytes) -> bytes:
        while not (self._client.service_is_ready() and self._is_known()):  # noqa: ASYNC110
            await asyncio.sleep(0.01)
        message = deserialize_message(request, self._class.Request)
        return serialize_message(await arrived(self._client.call_async(message)))

    def close(self) -> None:
        self._node.destroy_client(self._client)
