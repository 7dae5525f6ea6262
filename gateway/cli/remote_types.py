# SPDX-License-Identifier: Apache-2.0
"""The definitions that a running gateway knows, by its own operations."""

import json
import re
from collections import deque
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated, Final

from pydantic import BaseModel, Field, TypeAdapter, ValidationError

from gateway.cli.remote_connection import Gateway, RemoteConnection, connected
from gateway.cli.type_names import is_pattern, matching
from gateway.errors import GatewayError, UsageError
from schemas.definition import DefinitionError
from schemas.installed import InstalledDefinitions, UnknownTypeError
from schemas.interface import Interface

_NUMBER: Final = re.compile(r"[0-9]{1,9}")  # in the list of message types
MAX_TYPES: Final = 5000  # a large robot has 2000
_NAME: Final = r"[a-z][a-z0-9_]{0,99}/(msg|srv|action)/[A-Z][A-Za-z0-9]{0,99}"


class _Described(BaseModel):
    """The parts of the answer to `describe` that matter here."""

    type: Annotated[str, Field(pattern=f"^{_NAME}$")]
    definition: str
    type_hash: Annotated[str, Field(pattern=r"^RIHS01_[0-9a-f]{64}$")] | None = None


class _Listed(BaseModel):
    """The values of ``/rosapi/interfaces``."""

    interfaces: list[str]


@contextmanager
def remote_types(
    gateway: Gateway, requested: Iterable[str]
) -> Iterator[tuple[InstalledDefinitions, Mapping[str, Sequence[str]]]]:
    """Fetch what *requested* names, with all nested types, until the context ends.

    It takes the names of types, topics, services and actions, numbers of message types, and
    patterns. The second result has the full names of the types by what was requested.

    Raises:
        UsageError: the gateway knows no such type, or has a definition that cannot be read.
        GatewayError: the gateway cannot be asked, or answers otherwise than a gateway.
    """
    with TemporaryDirectory(prefix="ros2-gateway-") as folder, connected(gateway) as connection:
        fetched = _Fetched(connection, gateway.url, Path(folder))
        named = {each: fetched.named(each) for each in dict.fromkeys(requested)}
        fetched.complete()
        yield fetched.definitions, named


class _Fetched:
    """The types of a gateway as files in a folder, like those of an installation."""

    def __init__(self, connection: RemoteConnection, url: str, folder: Path) -> None:
        self._connection = connection
        self._url = url
        self._folder = folder
        self._names: set[str] = set()
        self._nested: deque[str] = deque()
        self.definitions = InstalledDefinitions([folder])

    def named(self, requested: str) -> list[str]:
        """Fetch one type, or those that a pattern stands for, and return their full names."""
        if not is_pattern(requested):
            return [self._fetch(requested)]
        names = matching(requested, self._listed())
        for name in names:
            if name not in self._names:
                self._fetch(name)
        return names

    def complete(self) -> None:
        """Fetch what the types nest, and what that nests."""
        while self._nested:
            name = self._nested.popleft()
            if name not in self._names:
                self._fetch(name)

    def _listed(self) -> list[str]:
        service = {"op": "call_service", "service": "/rosapi/interfaces", "args": {}}
        answer = self._connection.ask(service)
        try:
            listed = _Listed.model_validate(answer.get("values")).interfaces
        except ValidationError as error:
            raise self._no_gateway("/rosapi/interfaces") from error
        return [name for name in listed if re.fullmatch(_NAME, name)]

    def _fetch(self, requested: str) -> str:
        asked = int(requested) if _NUMBER.fullmatch(requested) else requested
        answer = self._connection.ask({"op": "describe", "type": asked})
        try:
            described = _DESCRIBED.validate_python(answer)
        except ValidationError as error:
            raise self._no_gateway("describe") from error
        self._keep(described)
        return described.type

    def _keep(self, described: _Described) -> None:
        name = described.type
        self._names.add(name)
        if len(self._names) > MAX_TYPES:
            raise UsageError(
                f"{self._url}: over {MAX_TYPES} types with the nested ones: ask for fewer"
            )
        package, kind, short_name = name.split("/")
        path = self._folder / "share" / package / kind / f"{short_name}.{kind}"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(described.definition, encoding="utf-8", errors="replace")
        if described.type_hash is not None:
            known = {"type_name": name, "hash_string": described.type_hash}
            hashes = json.dumps({"type_hashes": [known]})
            path.with_suffix(".json").write_text(hashes, encoding="utf-8")
        try:
            found = self.definitions.get_any(name)
        except (UnknownTypeError, DefinitionError) as error:
            raise UsageError(f"{self._url}: {error}") from error
        parts = found.parts.values() if isinstance(found, Interface) else [found]
        self._nested.extend(nested for part in parts for nested in part.nested())

    def _no_gateway(self, operation: str) -> GatewayError:
        return GatewayError(
            f"{self._url}: the answer to {operation} is not that of ros2-gateway: rosbridge and "
            "others do not give definitions"
        )


_DESCRIBED: Final = TypeAdapter(_Described)
