# SPDX-License-Identifier: Apache-2.0
"""The options of `subscribe` that decide about frames: compression, fragments, and odd numbers."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field, replace
from typing import Final, Literal, cast, get_args

from gateway.codec import cbor
from gateway.codec.error_text import truncate
from gateway.codec.json import ascii_only
from gateway.codec.nonfinite import NonFinite
from gateway.codec.png import large_text_as_png, text_as_png
from gateway.core.frames import Content, Framing, PublishFrames
from gateway.fronts.rosbridge import messages
from gateway.fronts.rosbridge.publish_frames import CborFrames, JsonFrames, PngFrames

Compression = Literal["none", "png", "cbor", "cbor-raw"]
"""The form of messages: JSON, JSON in a picture, CBOR, or CDR in CBOR. Later ones are stronger."""

_COMPRESSIONS: Final[tuple[Compression, ...]] = get_args(Compression)
_CONTENT: Final[dict[Compression, Content]] = {
    "none": "json",
    "png": "json",
    "cbor": "cbor",
    "cbor-raw": "cdr",
}


@dataclass(frozen=True, kw_only=True)
class RosbridgeFraming(Framing):
    """The form in which a client of rosbridge gets the messages of a topic."""

    compression: Compression = "none"
    fragment_size: int | None = field(default=None, compare=False)  # in characters

    @classmethod
    def of(
        cls,
        compression: str | None = None,
        fragment_size: int | None = None,
        nonfinite: NonFinite | None = None,
    ) -> "RosbridgeFraming":
        """Return it as a client asks for it. An unknown compression counts as ``none``."""
        known: Compression = next((each for each in _COMPRESSIONS if each == compression), "none")
        warning = ""
        if known == "none" and compression not in {None, "", "none"}:
            unknown = truncate(compression or "")
            warning = f"compression: {unknown!r} is not available, sending plain JSON"
        return cls(
            content=_CONTENT[known],
            nonfinite=nonfinite,
            warning=warning,
            compression=known,
            fragment_size=fragment_size,
        )

    @property
    def name(self) -> str:
        """The compression."""
        return self.compression

    @property
    def needs_own_frames(self) -> bool:
        """True if the frames are in fragments."""
        return self.fragment_size is not None

    @property
    def is_packed(self) -> bool:
        """True if messages are in pictures."""
        return self.compression == "png"

    def after(self, older: Framing) -> "RosbridgeFraming":
        """Take the strongest compression, the smallest fragments, and the newest odd numbers."""
        older = cast("RosbridgeFraming", older)
        sizes = [size for each in (older, self) if (size := each.fragment_size) is not None]
        strongest = max((older, self), key=lambda each: _COMPRESSIONS.index(each.compression))
        nonfinite = self.nonfinite or older.nonfinite
        return replace(strongest, nonfinite=nonfinite, fragment_size=min(sizes, default=None))

    def frames(self, topic: str) -> PublishFrames:
        """Return what makes the frames of a topic."""
        if self.content != "json":
            return CborFrames(topic)
        return PngFrames(topic) if self.is_packed else JsonFrames(topic)

    def before_cdr(self, now_ns: int, size: int) -> bytes:
        """Return the message of `cbor-raw` up to its last member, the CDR."""
        secs, nsecs = divmod(now_ns, 1_000_000_000)
        members = {"secs": secs, "nsecs": nsecs}
        items = [cbor.text(name) + cbor.dumps(value) for name, value in members.items()]
        # the map has one member more, and its items just follow each other
        head = cbor.head(cbor.MAP, len(members) + 1)
        return b"".join((head, *items, cbor.text("bytes"), cbor.head(cbor.OCTETS, size)))

    def pack(
        self, topic: str, message: Iterable[bytes], pause: Callable[[], None] | None = None
    ) -> bytes:
        """Return a picture that holds the whole `publish` frame."""
        text = _publish(topic, message)
        return text_as_png(b"".join(text)) if pause is None else large_text_as_png(text, pause)


def _publish(topic: str, message: Iterable[bytes]) -> Iterator[bytes]:
    yield ascii_only(messages.publish_prefix(topic))
    yield from map(ascii_only, message)
    yield messages.PUBLISH_SUFFIX
