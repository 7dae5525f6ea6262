# SPDX-License-Identifier: Apache-2.0
"""Clients' code of the types that the gateway knows, by the writers of `ros2-gateway generate`."""

import asyncio
import time
from concurrent.futures import ThreadPoolExecutor
from typing import Any, Final

from gateway.backports import timeout
from gateway.codec.error_text import truncate
from gateway.core.bad_type import bad_type
from gateway.core.errors import ProtocolError
from gateway.core.requests import Generate
from gateway.core.session import Session
from schemas.definition import DefinitionError
from schemas.generate.catalogue import Catalogue
from schemas.generate.languages import LANGUAGES
from schemas.generate.request import MARK, ClientCodeError, GenerateRequest
from schemas.installed import InstalledDefinitions, UnknownTypeError

# A quarter of what the Unity client reads in one message, where JSON may double it. All of
# nav2_msgs has 120 kB.
MAX_BYTES: Final = 4 * 1024 * 1024
MAX_NAMED: Final = 20  # types in the first line of each file
TURN_S: Final = 8.0  # to wait for other clients, less than this one waits for its answer


class ClientCode:
    """Writes it in a thread, for one client after the other: a package takes up to 0.1 s."""

    def __init__(self, definitions: InstalledDefinitions) -> None:
        self._definitions = definitions
        self._thread = ThreadPoolExecutor(1, thread_name_prefix="client_code")
        self._turn = asyncio.Semaphore()

    def close(self) -> None:
        """Write no more. The thread ends with what it is writing."""
        self._thread.shutdown(wait=False, cancel_futures=True)

    async def generate(self, session: Session, request: Generate) -> dict[str, Any]:
        """Return the files by their names, and sentences about them.

        The time that it takes is the client's: it holds the interpreter's lock.

        Raises:
            ProtocolError: a type is unknown, or cannot be written in that language.
        """
        # the event loop goes on to learn types
        definitions = self._definitions.with_told({})
        try:
            async with timeout(TURN_S):
                await self._turn.acquire()
        except TimeoutError:
            text = "other clients are waiting for code too long: try again"
            raise ProtocolError("limit_exceeded", text) from None
        work = _Writing(request, definitions)
        written = asyncio.get_running_loop().run_in_executor(self._thread, work.run)

        def end(done: "asyncio.Future[Any]") -> None:
            self._turn.release()
            session.turns.spend(work.took_s, time.monotonic())
            if not done.cancelled():
                done.exception()  # of a client that has left nobody asks for it

        # not when the client leaves, which ends no thread
        written.add_done_callback(end)
        try:
            files, notes = await asyncio.shield(written)
        except (UnknownTypeError, DefinitionError) as error:
            raise bad_type(error, self._definitions) from error
        except ClientCodeError as error:
            raise ProtocolError("bad_type", truncate(str(error))) from error
        if sum(len(text.encode()) for text in files.values()) > MAX_BYTES:
            text = f"the code has over {MAX_BYTES} bytes: ask for fewer types at once"
            raise ProtocolError("limit_exceeded", text)
        return {"files": files, "notes": notes}


class _Writing:
    """One request, and what it has cost."""

    def __init__(self, request: Generate, definitions: InstalledDefinitions) -> None:
        self._request = request
        self._definitions = definitions
        self.took_s = 0.0
        """Of the thread's own time."""

    def run(self) -> tuple[dict[str, str], list[str]]:
        """Write the files, in any thread."""
        begin_s = time.thread_time()
        try:
            return _written(self._request, self._definitions)
        finally:
            self.took_s = time.thread_time() - begin_s


def _written(
    request: Generate, definitions: InstalledDefinitions
) -> tuple[dict[str, str], list[str]]:
    names = tuple(sorted(set(request.types)))
    language = LANGUAGES[request.language]
    asked = GenerateRequest(
        names, Catalogue.of_types(names, definitions), MARK, asmdef=request.asmdef
    )
    # the head of each file: 200 names in 200 files would be more than the code
    head = names if len(names) <= MAX_NAMED else [f"of {len(names)} types"]
    asked = asked.made_by(request.language, head)
    return dict(language.files(asked)), list(language.notes(asked))
