# SPDX-License-Identifier: Apache-2.0
"""The transforms of a robot, and lookups between any two of its frames."""

from collections.abc import Callable, Collection
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

# Five humanoids with all their fingers. 67 MB if every frame moves at 200 Hz. A tracker may
# invent new names forever: frames that have ceased make room.
MAX_FRAMES: Final = 512
# Frame names with namespaces, prefixes and numbers stay below half of it.
MAX_FRAME_CHARACTERS: Final = 256
# Looking for frames that have ceased takes a millisecond. If too many frames are alive, that
# must not happen for each new one.
SWEEP_NS: Final = 1_000_000_000
# All the repeated lookups that 32 clients may have, each of a different pair, take 0.3 MB.
_MAX_ANSWERS: Final = 512


class FoundTransform(NamedTuple):
    """The transform of a frame in another, and its time."""

    stamp_ns: int  # 0 if it never changes and no time was asked for
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
    """The transforms of the last seconds, of each frame in its parent.

    ``revision`` changes whenever an answer may have changed.
    """

    def __init__(self) -> None:
        self._frames: dict[str, History | _Fixed] = {}
        self._known: set[str] = set()  # every frame named, as a child or a parent
        self._sweep_due_ns = 0
        self._answers: dict[tuple[str, str], FoundTransform] = {}  # of one revision
        self._answered = 0  # that revision
        self.revision = 0

    def insert(
        self,
        child: str,
        parent: str,
        stamp_ns: int,
        transform: Rigid,
        *,
        heard_ns: int,
        is_static: bool,
    ) -> bool:
        """Insert the *transform* of *child* in *parent*, received at a monotonic time.

        A leading slash, which ROS 1 had, is dropped. Quaternions of any length are normalized.
        Return false if earlier transforms disagree on whether the frame is static. A frame that is
        published as both counts as moving, until no moving one was received for `HISTORY_NS`.

        Raises:
            InvalidTransformError: the transform is invalid, or there are too many frames.
        """
        child, parent = _name(child), _name(parent)
        _check_names(child, parent)
        try:
            transform = transform.normalized()
        except ValueError as error:
            raise InvalidTransformError(child, str(error)) from None
        self._admit(child, parent, heard_ns)
        known = self._frames.get(child)
        if is_static:
            if isinstance(known, History) and not _has_ceased(known, heard_ns):
                return False
            fixed = _Fixed(parent, transform)
            if known == fixed:
                return True
            self._frames[child] = fixed
        elif not isinstance(known, History):
            self._frames[child] = History(stamp_ns, parent, transform, heard_ns)
        elif not known.add(stamp_ns, parent, transform, heard_ns):
            return True
        self.revision += 1
        return is_static or not isinstance(known, _Fixed)

    def clear(self) -> None:
        """Forget moving frames. Static ones stay, because nobody would publish them again."""
        self._keep(lambda frame: isinstance(frame, _Fixed))

    def forget(self) -> None:
        """Forget all."""
        self._keep(lambda frame: False)

    def lookup(self, target: str, source: str, stamp_ns: int | None = None) -> FoundTransform:
        """Return the transform that takes points from *source* into *target*.

        Without a time, use the newest time at which all frames between them are known.

        Raises:
            UnknownFrameError, NotConnectedError, LoopError, ExtrapolationError
        """
        target, source = _name(target), _name(source)
        if stamp_ns is not None:
            return self._found(target, source, stamp_ns)
        if self._answered != self.revision or len(self._answers) >= _MAX_ANSWERS:
            self._answers.clear()
            self._answered = self.revision
        found = self._answers.get((target, source))
        if found is None:
            found = self._found(target, source, None)
            self._answers[target, source] = found
        return found

    def _found(self, target: str, source: str, stamp_ns: int | None) -> FoundTransform:
        self._check_known(target)
        self._check_known(source)
        up, down = self._paths(target, source, stamp_ns)
        if stamp_ns is None:
            moving = (self._frames[frame] for frame in (*up, *down))
            stamp_ns = min((f.newest_ns for f in moving if isinstance(f, History)), default=0)
            # a frame may have had another parent at that time
            up, down = self._paths(target, source, stamp_ns)
        in_common = self._composed(up, stamp_ns)
        transform = self._composed(down, stamp_ns).inverse().after(in_common) if down else in_common
        return FoundTransform(stamp_ns, transform)

    def _paths(self, target: str, source: str, stamp_ns: int | None) -> tuple[list[str], list[str]]:
        """Return the frames from *source* and *target* up to, without, their common ancestor."""
        down = self._chain(target, stamp_ns)
        up = self._chain(source, stamp_ns, until=down)
        common = next(reversed(up))
        if common not in down:
            for chain in (down, up):
                self._check_ends(list(chain), stamp_ns)
            raise NotConnectedError(list(down), list(up))
        return list(up)[:-1], list(down)[: list(down).index(common)]

    def _chain(
        self, frame: str, stamp_ns: int | None, until: Collection[str] = ()
    ) -> dict[str, None]:
        """Return a frame and its ancestors, in order, up to one of *until* or the root.

        If a frame is its own ancestor, the chain ends before that frame would repeat.
        """
        chain = {frame: None}
        while frame not in until and (known := self._frames.get(frame)) is not None:
            frame = known.parent(stamp_ns)
            if frame in chain:
                break
            chain[frame] = None
        return chain

    def _check_ends(self, chain: list[str], stamp_ns: int | None) -> None:
        """Check that the last frame of a chain is a root."""
        last = self._frames.get(chain[-1])
        if last is not None:
            again = last.parent(stamp_ns)
            raise LoopError([*chain[chain.index(again) :], again])

    def _composed(self, path: list[str], stamp_ns: int) -> Rigid:
        """Return the transform of a path's first frame in the parent of its last one."""
        composed = IDENTITY
        for name in path:
            composed = self._step(name, stamp_ns).after(composed)
        return composed

    def _step(self, name: str, stamp_ns: int) -> Rigid:
        """Return the transform of a frame in its parent."""
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

    def _admit(self, child: str, parent: str, heard_ns: int) -> None:
        """Make room for a new frame, if needed, by forgetting frames that have ceased."""
        new = {child, parent} - self._known
        if len(self._known) + len(new) > MAX_FRAMES and heard_ns >= self._sweep_due_ns:
            self._sweep_due_ns = heard_ns + SWEEP_NS
            self._keep(lambda f: isinstance(f, _Fixed) or not _has_ceased(f, heard_ns))
            new = {child, parent} - self._known
        if len(self._known) + len(new) > MAX_FRAMES:
            raise InvalidTransformError(child, f"at most {MAX_FRAMES} frames are kept")
        self._known |= new

    def _keep(self, is_kept: Callable[[History | _Fixed], bool]) -> None:
        self._frames = {name: frame for name, frame in self._frames.items() if is_kept(frame)}
        self._known = set(self._frames).union(*(f.parents for f in self._frames.values()))
        self.revision += 1


def _name(frame: str) -> str:
    return frame.removeprefix("/")


def _check_names(child: str, parent: str) -> None:
    if not child or not parent:
        raise InvalidTransformError(child, "it or its parent has no name")
    if len(child) > MAX_FRAME_CHARACTERS or len(parent) > MAX_FRAME_CHARACTERS:
        limit = f"{MAX_FRAME_CHARACTERS} characters"
        raise InvalidTransformError(child, f"it or its parent has a name of over {limit}")
    if child == parent:
        raise InvalidTransformError(child, "it is said to be in itself")


def _has_ceased(frame: History, now_ns: int) -> bool:
    return frame.heard_ns < now_ns - HISTORY_NS
