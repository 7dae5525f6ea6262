# SPDX-License-Identifier: Apache-2.0
"""The classes of message types: those of installed packages, and made ones for the others."""

import asyncio
import contextlib
import os
import sys
from typing import Final

from gateway.ports import RosError
from gateway.ros.interfaces import message_class
from gateway.ros.made_types import MadeTypes
from schemas.definition import DefinitionError
from schemas.installed import InstalledDefinitions, UnknownTypeError
from schemas.type_hash import type_hash

_CHECK: Final = ("-m", "gateway.ros.made_types_check")
_CHECK_S: Final = 60  # of a machine that is busy with other things; else it takes one


class MessageClasses:
    """Finds the class for a topic's type, by which CDR goes in and out.

    Those of *definitions* that are not installed are made once `make_types` was called.
    """

    def __init__(self, definitions: InstalledDefinitions | None = None) -> None:
        self._definitions = definitions
        self._makes_types = False
        self._why_not: str | None = None
        self._made = MadeTypes()
        self._hashes: dict[str, str] = {}  # of the types that were used

    def make_types(self, why_not: str | None) -> None:
        """Make types from now on, or refuse them in the words of *why_not*."""
        self._makes_types = True
        self._why_not = why_not

    def hash_of(self, type_name: str) -> str | None:
        """Return the REP-2011 hash of ``pkg/msg/Name``, if its definition is known."""
        if type_name not in self._hashes and self._definitions is not None:
            with contextlib.suppress(UnknownTypeError, DefinitionError):
                definition = self._definitions.get(type_name)
                self._hashes[type_name] = type_hash(definition, self._definitions)
        return self._hashes.get(type_name)

    def get(self, type_name: str) -> type:
        """Return the class of ``pkg/msg/Name``.

        Raises:
            RosError: ``bad_type``: the name is malformed, or no package here has that message, and
                none can be made for it; ``limit_exceeded``: too many were made.
        """
        try:
            return message_class(type_name)
        except RosError as error:
            if self._definitions is None or not self._makes_types:
                raise
            if self._why_not is not None:
                raise RosError("bad_type", f"{error}, and {self._why_not}") from error
            try:
                return self._made.get(self._definitions.get(type_name), self._definitions)
            except (UnknownTypeError, DefinitionError):
                raise error from None


async def why_types_cannot_be_made() -> str | None:
    """Return in words why this ROS takes no made types, ``None`` if it does.

    A process of its own tries: where the structures are not as expected, that may crash.
    """
    environment = os.environ | {"ROS_AUTOMATIC_DISCOVERY_RANGE": "OFF"}  # nobody else hears of it
    environment.pop("ROS_LOCALHOST_ONLY", None)  # it would take precedence
    try:
        process = await asyncio.create_subprocess_exec(
            sys.executable,
            *_CHECK,
            env=environment,
            stdin=asyncio.subprocess.DEVNULL,
            stdout=asyncio.subprocess.PIPE,
            stderr=asyncio.subprocess.DEVNULL,
        )
    except OSError as error:
        reason = (error.strerror or type(error).__name__).lower()
        return f"a test whether others can be made did not start: {reason}"
    try:
        async with asyncio.timeout(_CHECK_S):
            said, _ = await process.communicate()
    except TimeoutError:
        return f"a test whether others can be made took over {_CHECK_S} s"
    finally:
        if process.returncode is None:
            process.kill()
            await process.wait()
    if process.returncode == 0:
        return None
    words = said.decode(errors="replace").strip()
    return words or f"a test whether others can be made ended with {process.returncode}"
