# SPDX-License-Identifier: Apache-2.0
"""A topic that ROS does not have: the gateway sends it to one client alone."""

from typing import Final

from gateway.core.errors import NothingThereError, ProtocolError, over_limit
from gateway.fronts.rosbridge import messages
from gateway.fronts.rosbridge.operations.topics import Subscribe, Unsubscribe
from gateway.fronts.rosbridge.session import RosbridgeSession

# options of `subscribe` that are not available here, in addition to `compression`
_UNAVAILABLE: Final = (
    "throttle_rate",
    "queue_length",
    "fields",
    "image",
    "meta",
    "qos",
    "stale_after_ms",
)


class VirtualTopic:
    """The `subscribe` requests of one client for such a topic, by requested names and ids."""

    def __init__(self, session: RosbridgeSession, name: str, type_name: str) -> None:
        self._session = session
        self._name = name
        self._type_name = type_name
        # the fragment size of each. A whole request may be large
        self._requests: dict[str, dict[str | int | None, int | None]] = {}

    def __bool__(self) -> bool:
        """Return whether the client has subscribed."""
        return bool(self._requests)

    def subscribe(self, request: Subscribe) -> None:
        """Add a request, or replace the one with the same id.

        Raises:
            ProtocolError: there are too many. Nothing has changed.
        """
        session = self._session
        own = self._requests.get(request.topic, {})
        limit = session.limits.max_subscriptions
        if request.id not in own and sum(map(len, self._requests.values())) >= limit:
            raise over_limit(limit, "subscriptions per client", "max_subscriptions")
        self._requests.setdefault(request.topic, own)[request.id] = request.fragment_size
        if ignored := _ignored(request):
            text = f"{', '.join(ignored)}: not available on {self._name}, sending plain JSON"
            session.warn(ProtocolError("bad_request", text), request.request())
        session.inform(f"subscribed to {self._name} ({self._type_name})", request.request())

    def unsubscribe(self, request: Unsubscribe) -> None:
        """End one request, or all of them.

        Raises:
            ProtocolError: the client has no such request.
        """
        if request.id is None:
            self._requests.clear()
            return
        found = [own for own in self._requests.values() if request.id in own]
        for own in found:
            del own[request.id]
        self._requests = {name: own for name, own in self._requests.items() if own}
        if not found:
            text = f"not subscribed to {self._name} with id {request.id!r}"
            raise NothingThereError(text)

    def frames(self, message: bytes) -> bytes:
        """Return a message as the client gets it, once for each name that it has requested."""
        return b"".join(
            self._session.framed(
                messages.publish_prefix(name) + message + messages.PUBLISH_SUFFIX,
                min(filter(None, sizes.values()), default=None),
            )
            for name, sizes in self._requests.items()
        )


def _ignored(request: Subscribe) -> list[str]:
    ignored = [name for name in _UNAVAILABLE if getattr(request, name)]
    if request.compression not in {None, "", "none"}:
        ignored.append("compression")
    return ignored
