# SPDX-License-Identifier: Apache-2.0
"""The rest of the robot over Zenoh: a router in this process, and a node that speaks rmw_zenoh.

It is written for itself, from what rmw_zenoh puts on the wire, and shares only names of types with
the source that it tests.
"""

import itertools
import json
import socket
import struct
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import xxhash
import zenoh
from zenoh import ext

from gateway.codec.types import Types
from gateway.sources.services import ServiceRequest
from gateway.sources.source import Qos, Sample
from schemas.definition_text import parse_definition
from schemas.installed import InstalledDefinitions
from schemas.type_hash import type_description, type_hash

DOMAIN = 117
# Other programs that speak rmw_zenoh. See tools/make-clients.sh.
PEERS = Path(sys.prefix) / "clients/zenoh-peers"
WHY_MISSING = f"not in {PEERS}: `make test` installs it"
DEFINITIONS = InstalledDefinitions()


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


def session(**settings: Any) -> Any:
    config = zenoh.Config()
    common = {
        "scouting/multicast/enabled": False,
        "timestamping/enabled": True,
        "transport/shared_memory/enabled": False,
    }
    for key, value in {**common, **settings}.items():
        config.insert_json5(key, json.dumps(value))
    return zenoh.open(config)


class Router:
    """A router on a port of the loopback interface."""

    def __init__(self, port: int = 0) -> None:
        self.address = f"tcp/127.0.0.1:{port or free_port()}"
        self._session = session(mode="router", **{"listen/endpoints": [self.address]})

    def close(self) -> None:
        self._session.close()


def client(router: str, **settings: str) -> Any:
    ends = {"connect/endpoints": [router], "listen/endpoints": []}
    return session(mode="client", **ends, **settings)


def gid_of(token: str) -> bytes:
    return xxhash.xxh3_128_digest(token.encode())[::-1]


def hash_of(type_name: str) -> str:
    return type_hash(DEFINITIONS.get(type_name), DEFINITIONS)


class ZenohPublisher:
    """A publisher of a node, as rmw_zenoh makes it."""

    def __init__(self, outside: "ZenohOutside", topic: str, type_name: str, qos: Qos, a_hash: str):
        package, kind, name = type_name.split("/")
        dds = f"{package}::{kind}::dds_::{name}_"
        is_latched, is_reliable = (
            qos.durability == "transient_local",
            qos.reliability != "best_effort",
        )
        options: dict[str, Any] = {}
        if is_latched:
            options |= {"cache": ext.CacheConfig(qos.depth or 10), "publisher_detection": True}
            if is_reliable:
                beat = ext.MissDetectionConfig(heartbeat=None, sporadic_heartbeat=0.5)
                options["sample_miss_detection"] = beat
        key = f"{DOMAIN}{topic}/{dds}/{a_hash}"
        self._publisher = ext.declare_advanced_publisher(
            outside.session,
            key,
            congestion_control=zenoh.CongestionControl.BLOCK,  # so that tests lose nothing
            reliability=(
                zenoh.Reliability.RELIABLE if is_reliable else zenoh.Reliability.BEST_EFFORT
            ),
            **options,
        )
        deadline, lifespan = (
            "," if each is None else f"{each // 10**9},{each % 10**9}"
            for each in (qos.deadline_ns, qos.lifespan_ns)
        )
        profile = (
            f"{'' if is_reliable else 2}:{1 if is_latched else ''}:,{qos.depth or 10}"
            f":{deadline}:{lifespan}:,,"
        )
        escaped = topic.replace("/", "%")
        token = f"{outside.token('MP')}/{escaped}/{dds}/{a_hash}/{profile}"
        self.gid = gid_of(token)
        self._token = outside.session.liveliness().declare_token(token)
        self._numbers = itertools.count(1)

    def publish(self, cdr: bytes) -> None:
        number, now_ns = next(self._numbers), time.time_ns()
        self._publisher.put(cdr, attachment=struct.pack("<qqB16s", number, now_ns, 16, self.gid))

    def close(self) -> None:
        self._publisher.undeclare()
        self._token.undeclare()


class ZenohOutside:
    """One node, ``/outside``, in a separate session."""

    def __init__(self, router: str, name: str = "outside", **settings: str) -> None:
        self.router = router
        self.session = client(router, **settings)
        self._name = name
        self._ids = itertools.count(1)
        self._kept: list[Any] = []
        self._zid = str(self.session.info.zid())
        self._node = self.session.liveliness().declare_token(self.token("NN", 0))

    def token(self, kind: str, number: int | None = None) -> str:
        number = next(self._ids) if number is None else number
        return f"@ros2_lv/{DOMAIN}/{self._zid}/0/{number}/{kind}/%/%/{self._name}"

    def add_publisher(
        self, topic: str, type_name: str, qos: Qos | None = None, a_hash: str | None = None
    ) -> ZenohPublisher:
        publisher = ZenohPublisher(
            self, topic, type_name, qos or Qos(), a_hash or hash_of(type_name)
        )
        self._kept.append(publisher)
        return publisher

    def add_described_publisher(self, topic: str, type_name: str, text: str) -> ZenohPublisher:
        """Publish a type that no file has. The node has the definition."""
        told = {type_name: parse_definition(type_name, text)}
        definitions = DEFINITIONS.with_told(told)
        asked = Types(DEFINITIONS).service("type_description_interfaces/srv/GetTypeDescription")
        described = type_description(told[type_name], definitions)
        answer = {"successful": True, "type_description": described}

        def on_request(request: ServiceRequest) -> None:
            assert asked.request.decode(request.cdr)["type_name"] == type_name
            request.answer(asked.response.encode(answer, 0))

        self.add_service(f"/{self._name}/get_type_description", asked.name, on_request)
        return self.add_publisher(topic, type_name, None, type_hash(told[type_name], definitions))

    def add_subscription(
        self,
        topic: str,
        type_name: str,
        on_samples: Callable[[Sequence[Sample]], None],
        qos: Qos | None = None,
    ) -> Any:
        raise NotImplementedError

    def close(self) -> None:
        self.session.close()
