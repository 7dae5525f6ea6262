# SPDX-License-Identifier: Apache-2.0
"""The languages of clients' code, and the functions that write each."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final

from schemas.generate import csharp_clients, json_clients, python_clients, typescript_clients
from schemas.generate.request import Request


@dataclass(frozen=True, slots=True)
class Language:
    """One language: ``files`` returns texts by relative path with ``/``, ``text`` one of all.

    Files that are ``optional`` may as well be the user's own.
    """

    files: Callable[[Request], Mapping[str, str]]
    text: Callable[[Request], str]
    optional: tuple[str, ...] = ()


LANGUAGES: Final[Mapping[str, Language]] = MappingProxyType(
    {
        "csharp": Language(csharp_clients.files, csharp_clients.text),
        "typescript": Language(typescript_clients.files, typescript_clients.text),
        "python": Language(python_clients.files, python_clients.text, (python_clients.INIT,)),
        "json-schema": Language(json_clients.files, json_clients.text),
    }
)
