# SPDX-License-Identifier: Apache-2.0
"""Subscriptions and services of the rest of the robot over Zenoh. See `outside`."""

import asyncio
import itertools
import struct
import time
from collections.abc import Callable, Sequence
from typing import Any

import zenoh
from zenoh import ext

from gateway.sources.services import ServiceRequest
from gateway.sources.source import Qos, Sample
from schemas.derived import DerivedDefinitions
from schemas.type_hash import type_hash
from tests.sources.zenoh.outside import DEFINITIONS, DOMAIN, ZenohOutside, gid_of, hash_of

ATTACHMENT = struct.Struct("<qqB16s")


def dds(type_name: str) -> str:
    package, kind, name = type_name.split("/")
    return f"{package}::{kind}::dds_::{name}_"


def service_hash(type_name: str) -> str:
    """Return the hash of a service, also of one of those that an action consists of."""
    package, kind, name = type_name.split("/")
    interface = DEFINITIONS.interface(f"{package}/{kind}/{name.partition('_')[0]}")
    derived = DerivedDefinitions(interface, DEFINITIONS)
    return type_hash(derived.get(type_name), derived)


class ZenohAnswerable:
    """A request that has arrived."""

    def __init__(self, service: "ZenohServer", query: Any) -> None:
        self.cdr = query.payload.to_bytes()
        self._service, self._query = service, query

    def answer(self, response: bytes) -> None:
        if self._service.is_open:
            number, _, _, gid = ATTACHMENT.unpack(self._query.attachment.to_bytes())
            attachment = ATTACHMENT.pack(number, time.time_ns(), 16, gid)
            self._query.reply(self._service.key, response, attachment=attachment)
            self._query.drop()


class ZenohServer:
    def __init__(
        self,
        world: "ZenohWorld",
        name: str,
        type_name: str,
        on_request: Callable[[ServiceRequest], None],
        a_hash: str | None = None,
    ) -> None:
        loop = asyncio.get_running_loop()
        self.is_open = True
        self.key, self._token = world.declare("SS", name, type_name, a_hash)

        def arrive(query: Any) -> None:
            loop.call_soon_threadsafe(on_request, ZenohAnswerable(self, query))

        self._queryable = world.session.declare_queryable(self.key, arrive, complete=True)

    def close(self) -> None:
        self.is_open = False
        self._queryable.undeclare()
        self._token.undeclare()


class ZenohCaller:
    def __init__(
        self, world: "ZenohWorld", name: str, type_name: str, a_hash: str | None = None
    ) -> None:
        self.key, self._token = world.declare("SC", name, type_name, a_hash)
        self._querier = world.session.declare_querier(
            self.key,
            target=zenoh.QueryTarget.ALL_COMPLETE,
            consolidation=zenoh.ConsolidationMode.NONE,
        )
        self._numbers = itertools.count(1)

    async def call(self, request: bytes) -> bytes:
        while not self._querier.matching_status.matching:  # noqa: ASYNC110  # in Zenoh
            await asyncio.sleep(0.01)
        loop = asyncio.get_running_loop()
        answer: asyncio.Future[bytes] = loop.create_future()
        number = next(self._numbers)

        def arrive(reply: Any) -> None:
            if reply.ok is not None:
                assert ATTACHMENT.unpack(reply.ok.attachment.to_bytes())[0] == number
                loop.call_soon_threadsafe(settle, reply.ok.payload.to_bytes())

        def settle(cdr: bytes) -> None:
            if not answer.done():
                answer.set_result(cdr)

        attachment = ATTACHMENT.pack(number, time.time_ns(), 16, b"x" * 16)
        self._querier.get(arrive, payload=request, attachment=attachment)
        return await answer

    def close(self) -> None:
        self._querier.undeclare()
        self._token.undeclare()


class ZenohWorld(ZenohOutside):
    """The node, with all that a test may want of it."""

    def declare(
        self, kind: str, name: str, type_name: str, a_hash: str | None = None
    ) -> tuple[str, Any]:
        """Declare the token of a service's end. Return its key, and the token."""
        of_type = f"{dds(type_name)}/{a_hash or service_hash(type_name)}"
        token = f"{self.token(kind)}/{name.replace('/', '%')}/{of_type}/::,10:,:,:,,"
        return f"{DOMAIN}{name}/{of_type}", self.session.liveliness().declare_token(token)

    def add_subscription(
        self,
        topic: str,
        type_name: str,
        on_samples: Callable[[Sequence[Sample]], None],
        qos: Qos | None = None,
        a_hash: str | None = None,
    ) -> Any:
        loop, qos = asyncio.get_running_loop(), qos or Qos()
        of_type = f"{dds(type_name)}/{a_hash or hash_of(type_name)}"
        is_latched = qos.durability == "transient_local"

        def arrive(sample: Any) -> None:
            number, source_ns, _, gid = ATTACHMENT.unpack(sample.attachment.to_bytes())
            taken = Sample(sample.payload.to_bytes(), 0, source_ns, number, gid)
            loop.call_soon_threadsafe(on_samples, [taken])

        history = ext.HistoryConfig(detect_late_publishers=True, max_samples=qos.depth or 10)
        subscriber = ext.declare_advanced_subscriber(
            self.session,
            f"{DOMAIN}{topic}/{of_type}",
            arrive,
            history=history if is_latched else None,
            subscriber_detection=is_latched,
        )
        profile = f":{1 if is_latched else ''}:,{qos.depth or 10}:,:,:,,"
        text = f"{self.token('MS')}/{topic.replace('/', '%')}/{of_type}/{profile}"
        token = self.session.liveliness().declare_token(text)
        self._kept += [subscriber, token]
        return subscriber, token, gid_of(text)

    def remove_subscription(self, subscription: Any) -> None:
        subscriber, token, _ = subscription
        subscriber.undeclare()
        token.undeclare()

    def add_service(
        self,
        name: str,
        type_name: str,
        on_request: Callable[[ServiceRequest], None],
        a_hash: str | None = None,
    ) -> ZenohServer:
        return self._keep(ZenohServer(self, name, type_name, on_request, a_hash))

    def add_client(self, name: str, type_name: str) -> ZenohCaller:
        return self._keep(ZenohCaller(self, name, type_name))

    def _keep(self, opened: Any) -> Any:
        self._kept.append(opened)
        return opened
