# SPDX-License-Identifier: Apache-2.0
"""The recorded robot once more: its tokens, its samples, and what its latched topics keep."""

import json
from typing import Any

from zenoh import ext

from gateway.sources.zenoh.tokens import EndpointToken, parse_token
from tests.sources.zenoh.outside import client
from tests.sources.zenoh.recordings import of_robot, recording, tokens


class Replay:
    """A session with the tokens and publishers of one recording."""

    def __init__(self, router: str, name: str) -> None:
        self._session = client(router)
        self._samples = of_robot(name, "put")
        self._publishers: dict[tuple[str, bytes], Any] = {}
        latched = []
        live = self._session.liveliness()
        self._tokens = [live.declare_token(token) for token in tokens(name)]
        for token in map(parse_token, tokens(name)):
            if isinstance(token, EndpointToken) and token.kind == "MP":
                key = token.key.text
                if token.qos.durability == "transient_local":
                    cache = ext.CacheConfig(token.qos.depth)
                    publisher = ext.declare_advanced_publisher(
                        self._session, key, cache=cache, publisher_detection=True
                    )
                    latched.append(token.gid)
                else:
                    publisher = self._session.declare_publisher(key)
                self._publishers[token.key.name, token.gid] = publisher
        kept = [line for line in recording(name) if line["kind"] == "reply"]
        seen = set()
        for line in kept:
            gid = bytes.fromhex(line["attachment"] or "")[-16:]
            mark = (line["key"], line["attachment"])
            if gid in latched and mark not in seen:
                seen.add(mark)
                self._put(line)

    def is_matched(self, topic: str) -> bool:
        """Return whether the volatile publishers of a topic have a subscriber."""
        return all(
            publisher.matching_status.matching
            for (name, _), publisher in self._publishers.items()
            if name == topic
        )

    def play(self, topic: str) -> list[dict[str, Any]]:
        """Publish the samples of a topic, and return their lines."""
        lines = [line for line in self._samples if line["key"].split("/")[1] == topic.strip("/")]
        for line in lines:
            self._put(line)
        return lines

    def close(self) -> None:
        self._session.close()

    def _put(self, line: dict[str, Any]) -> None:
        attachment = bytes.fromhex(line["attachment"])
        for (_, gid), publisher in self._publishers.items():
            if gid == attachment[-16:]:
                publisher.put(bytes.fromhex(line["payload"]), attachment=attachment)


def expected(name: str, topic: str) -> list[Any]:
    """Return the values that the recorded node has published."""
    notes = [json.loads(line["note"]) for line in of_robot(name, "event")]
    return [each["expected"] for each in notes if each.get("topic") == topic and "expected" in each]
