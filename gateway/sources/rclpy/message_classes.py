# SPDX-License-Identifier: Apache-2.0
"""The classes of types: those of installed packages, and made ones for the others."""

import asyncio
import contextlib
import os
import subprocess
import sys
from collections.abc import Callable
from typing import Final, TypeVar

from gateway.codec.types import Types
from gateway.sources.action_cdr import ActionCdr
from gateway.sources.rclpy.action_forms import ActionForm, MadeActionForm, PackageAction
from gateway.sources.rclpy.interfaces import action_class, message_class, service_class
from gateway.sources.rclpy.made_types.classes import MadeTypes
from gateway.sources.rclpy.service_forms import ServiceForm, of_made, of_package
from gateway.sources.realignment import Realignment
from gateway.sources.source import RosError
from schemas.definition import DefinitionError
from schemas.derived import DerivedDefinitions
from schemas.installed import InstalledDefinitions, UnknownTypeError
from schemas.type_hash import type_hash

_CHECK: Final = ("-m", "gateway.sources.rclpy.made_types.check")
_CHECK_S: Final = 60  # of a machine that is busy with other things. Else it takes one

_T = TypeVar("_T")


class MessageClasses:
    """Finds the classes for a type, by which CDR goes in and out.

    Those of *definitions* that are not installed are made once `make_types` has ended.
    """

    def __init__(self, definitions: InstalledDefinitions | None = None) -> None:
        self._definitions = definitions
        self._makes_types = False
        self._why_not: str | None = None
        self._trying: asyncio.Task[str | None] | None = None
        self._made = MadeTypes()
        self._types = Types(definitions or InstalledDefinitions([]))  # of empty results
        self._revision = 0  # of the definitions
        self._hashes: dict[str, str] = {}  # of the types that were used

    @property
    def definitions(self) -> InstalledDefinitions | None:
        """The definitions that are known, also of types that are not installed."""
        return self._definitions

    def begin_trial(self) -> asyncio.Task[str | None]:
        """Begin to try whether this ROS takes made types, which takes some tenths of a second."""
        if self._trying is None:
            self._trying = why_types_cannot_be_made(asyncio.get_running_loop())
        return self._trying

    async def make_types(self) -> None:
        """Make types from now on, or refuse them if this ROS does not take them."""
        self.allow_made_types(await asyncio.shield(self.begin_trial()))

    def allow_made_types(self, why_not: str | None = None) -> None:
        """Make types from now on, or refuse them in the words of *why_not*."""
        self._makes_types = True
        self._why_not = why_not

    async def close(self) -> None:
        """End the process that tries, if it is still there."""
        if self._trying is not None:
            self._trying.cancel()
            await asyncio.wait([self._trying])

    def hash_of(self, type_name: str) -> str | None:
        """Return the REP-2011 hash of ``pkg/msg/Name``, if its definition is known.

        Also of the types that are derived of a service or an action, as in `schemas.derived`.
        """
        if self._definitions is not None and self._revision != self._definitions.revision:
            self._revision = self._definitions.revision
            self._hashes.clear()
        if type_name not in self._hashes and self._definitions is not None:
            with contextlib.suppress(UnknownTypeError, DefinitionError):
                self._hashes[type_name] = _hash(type_name, self._definitions)
        return self._hashes.get(type_name)

    def get(self, type_name: str) -> type:
        """Return the class of ``pkg/msg/Name``.

        Raises:
            RosError: ``bad_type``: the name is malformed, or no package here has that message, and
                none can be made for it. ``limit_exceeded``: too many were made.
        """
        return self._find(
            lambda: message_class(type_name),
            lambda known: self._made.get(known.get(type_name), known),
        )

    def service(self, type_name: str) -> ServiceForm:
        """Return the form of ``pkg/srv/Name``, a made one where types are made.

        That spares the way from CDR to rclpy's objects and back, which holds the event loop for 13
        ms where a response has 500 poses.

        Raises:
            RosError: as for `get`.
        """
        return self._find_made(
            lambda: of_package(type_name, service_class(type_name)),
            lambda known: self._make_service(type_name, known),
        )

    def action(self, type_name: str) -> ActionForm:
        """Return the form of ``pkg/action/Name``, as `service` does.

        Raises:
            RosError: as for `get`.
        """
        return self._find_made(
            lambda: PackageAction(type_name, action_class(type_name)),
            lambda known: self._make_action(type_name, known),
        )

    def _make_service(self, type_name: str, known: InstalledDefinitions) -> ServiceForm:
        interface = known.interface(type_name, "srv")
        return of_made(type_name, self._made.service(interface, known))

    def _make_action(self, type_name: str, known: InstalledDefinitions) -> ActionForm:
        interface = known.interface(type_name, "action")
        result = interface.parts["result"]
        cdr = ActionCdr(
            type_name,
            Realignment(result, known),
            lambda: self._types.get(result.name).encode({}, 0),
        )
        return MadeActionForm(self._made.action(interface, known), cdr)

    def _find_made(self, find: Callable[[], _T], make: Callable[[InstalledDefinitions], _T]) -> _T:
        """Make it, or find it if that is not possible."""
        if self._definitions is not None and self._makes_types and self._why_not is None:
            with contextlib.suppress(UnknownTypeError, DefinitionError, RosError):
                return make(self._definitions)
        return self._find(find, make)

    def _find(self, find: Callable[[], _T], make: Callable[[InstalledDefinitions], _T]) -> _T:
        try:
            return find()
        except RosError as error:
            if self._definitions is None or not self._makes_types:
                raise
            if self._why_not is not None:
                raise RosError("bad_type", f"{error}, and {self._why_not}") from error
            try:
                return make(self._definitions)
            except (UnknownTypeError, DefinitionError):
                raise error from None


def _hash(type_name: str, definitions: InstalledDefinitions) -> str:
    package, _, rest = type_name.partition("/")
    kind, _, name = rest.partition("/")
    if kind not in {"srv", "action"}:
        return type_hash(definitions.get(type_name), definitions)
    interface, _, _ = name.partition("_")  # which no such name has
    derived = DerivedDefinitions(
        definitions.interface(f"{package}/{kind}/{interface}"), definitions
    )
    return type_hash(derived.get(type_name), derived)


def why_types_cannot_be_made(loop: asyncio.AbstractEventLoop) -> "asyncio.Task[str | None]":
    """Begin to try whether this ROS takes made types. Await ``None``, or in words why it does not.

    A separate process tries, because it may crash if the structures are not as expected. It starts
    now, runs while DDS opens its sockets here, and ends with the task, however that ends.
    """
    environment = os.environ | {"ROS_AUTOMATIC_DISCOVERY_RANGE": "OFF"}  # nobody else hears of it
    environment.pop("ROS_LOCALHOST_ONLY", None)  # it would take precedence
    try:
        process = subprocess.Popen(
            [sys.executable, *_CHECK],
            env=environment,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
        )
    except OSError as error:
        reason = (error.strerror or type(error).__name__).lower()
        return loop.create_task(
            _at_once(f"a test whether others can be made did not start: {reason}")
        )
    trying = loop.create_task(_verdict(process))
    # a task that is cancelled before its first step runs nothing of itself
    trying.add_done_callback(lambda _: _end(process))
    return trying


async def _at_once(words: str) -> str | None:
    return words


async def _verdict(process: "subprocess.Popen[bytes]") -> str | None:
    try:
        said, _ = await asyncio.to_thread(process.communicate, timeout=_CHECK_S)
    except subprocess.TimeoutExpired:
        return f"a test whether others can be made took over {_CHECK_S} s"
    if process.returncode == 0:
        return None
    words = bytes(said).decode(errors="replace").strip()
    return words or f"a test whether others can be made ended with {process.returncode}"


def _end(process: "subprocess.Popen[bytes]") -> None:
    with process:
        process.kill()
