# SPDX-License-Identifier: Apache-2.0
"""The transforms of a robot, and the answer to where any frame is in any other."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, NamedTuple

from gateway.tf.errors import (
    ExtrapolationError,
    InvalidTransformError,
    LoopError,
    NotConnectedError,
    UnknownFrameError,
)
from gateway.tf.history import HISTORY_NS, History
from gateway.tf.rigid import IDENTITY, Rigid

# Five humanoids with all their fingers; 75 MB if every one of them moves at 200 Hz. A tracker may
# name frames anew for ever: those that have ceased make room.
MAX_FRAMES: Final = 512


class Found(NamedTuple):
    """Where a frame is in another, and at what time."""

    stamp_ns: int  # 0 where it never changes and no time was asked for
    transform: Rigid


@dataclass(frozen=True, slots=True)
class _Fixed:
    """A frame that never moves in its parent."""

    parent_name: str
    transform: Rigid

    def parent(self, stamp_ns: int | None) -> str:
        del stamp_ns
        return self.parent_name

    @property
    def parents(self) -> set[str]:
        return {self.parent_name}


class Buffer:
    """Transforms as they were over the last seconds, each frame in its parent.

    ``revision`` changes whenever an answer may have changed.
    """

    def __init__(self) -> None:
        self._frames: dict[str, History | _Fixed] = {}
        self._known: set[str] = set()  # all that was named, as a parent too
        self.revision = 0

    def insert(
        self, child: str, parent: str, stamp_ns: int, transform: Rigid, *, is_static: bool
    ) -> None:
        """Take the word that *child* is at *transform* in *parent*.

        A leading slash, which ROS 1 had, is dropped. Quaternions of any length are made unit ones.

        Raises:
            InvalidTransformError: it is no transform, or that of one frame too many.
        """
        child, parent = _name(child), _name(parent)
        if not child or not parent:
            raise InvalidTransformError(f"{child!r} in {parent!r}: a frame has no name")
        if child == parent:
            raise InvalidTransformError(f"frame {child} is said to be in itself")
        try:
            transform = transform.normalized()
        except ValueError as error:
            raise InvalidTransformError(f"{child} in {parent}: {error}") from None
        self._admit(child, parent)
        known = self._frames.get(child)
        if is_static:
            fixed = _Fixed(parent, transform)
            if known == fixed:
                return
            self._frames[child] = fixed
        elif not isinstance(known, History):
            self._frames[child] = History(stamp_ns, parent, transform)
        elif not known.add(stamp_ns, parent, transform):
            return
        self.revision += 1

    def clear(self) -> None:
        """Forget what moves; what is fixed stays, because nobody would say it again."""
        self._keep(lambda frame: isinstance(frame, _Fixed))
        self.revision += 1

    def forget(self) -> None:
        """Forget all."""
        self._keep(lambda frame: False)
        self.revision += 1

    def lookup(self, target: str, source: str, stamp_ns: int | None = None) -> Found:
        """Return the transform that takes points from *source* into *target*.

        Without a time it is that of the newest moment for which all frames between them are
        known.

        Raises:
            UnknownFrameError, NotConnectedError, LoopError, ExtrapolationError
        """
        target, source = _name(target), _name(source)
        up, down = self._paths(target, source, stamp_ns)
        if stamp_ns is None:
            moving = (self._frames[frame] for frame in (*up, *down))
            stamp_ns = min((f.newest_ns for f in moving if isinstance(f, History)), default=0)
            # a frame may have had another parent then
            up, down = self._paths(target, source, stamp_ns)
        in_common = self._composed(up, stamp_ns)
        transform = self._composed(down, stamp_ns).inverse().after(in_common) if down else in_common
        return Found(stamp_ns, transform)

    def _paths(self, target: str, source: str, stamp_ns: int | None) -> tuple[list[str], list[str]]:
        """Return the frames from *source* and from *target* up to below what is above both."""
        up = self._chain(source, stamp_ns)
        down = self._chain(target, stamp_ns)
        if up[-1] != down[-1]:
            self._check_known(target)
            self._check_known(source)
            raise NotConnectedError(down, up)
        if len(up) == len(down) == 1:
            self._check_known(source)
        while up and down and up[-1] == down[-1]:
            up.pop()
            down.pop()
        return up, down

    def _chain(self, frame: str, stamp_ns: int | None) -> list[str]:
        """Return a frame and all that are above it, up to the root."""
        chain = {frame: None}
        while (known := self._frames.get(frame)) is not None:
            frame = known.parent(stamp_ns)
            if frame in chain:
                looped = list(chain)
                raise LoopError([*looped[looped.index(frame) :], frame])
            chain[frame] = None
        return list(chain)

    def _composed(self, path: list[str], stamp_ns: int) -> Rigid:
        """Return where the first frame of a path is in the parent of the last one."""
        composed = IDENTITY
        for name in path:
            composed = self._step(name, stamp_ns).after(composed)
        return composed

    def _step(self, name: str, stamp_ns: int) -> Rigid:
        """Return where a frame is in its parent."""
        frame = self._frames[name]
        if isinstance(frame, _Fixed):
            return frame.transform
        transform = frame.at(stamp_ns)
        if transform is None:
            oldest_ns, newest_ns = frame.oldest_ns, frame.newest_ns
            raise ExtrapolationError(
                name, frame.parent(stamp_ns), stamp_ns, oldest_ns=oldest_ns, newest_ns=newest_ns
            )
        return transform

    def _check_known(self, frame: str) -> None:
        if frame not in self._known:
            raise UnknownFrameError(frame, self._known)

    def _admit(self, child: str, parent: str) -> None:
        """Make room for what is new, where that is needed, at the expense of what has ceased."""
        new = {child, parent} - self._known
        if len(self._known) + len(new) > MAX_FRAMES:
            moving = (f for f in self._frames.values() if isinstance(f, History))
            oldest_ns = max((f.newest_ns for f in moving), default=0) - HISTORY_NS
            self._keep(lambda frame: isinstance(frame, _Fixed) or frame.newest_ns >= oldest_ns)
            if len(self._known | new) > MAX_FRAMES:
                raise InvalidTransformError(f"frame {child}: at most {MAX_FRAMES} frames are kept")
        self._known |= new

    def _keep(self, is_kept: Callable[[History | _Fixed], bool]) -> None:
        self._frames = {name: frame for name, frame in self._frames.items() if is_kept(frame)}
        self._known = set(self._frames).union(*(f.parents for f in self._frames.values()))


def _name(frame: str) -> str:
    return frame.removeprefix("/")
