# SPDX-License-Identifier: Apache-2.0
"""Types that are not installed here: the source is asked for their definitions.

Topics with such types are looked at as the graph changes, so that their types are mostly known
before a client asks for one.
"""

import asyncio
from collections.abc import Callable, Coroutine, Mapping
from itertools import chain
from typing import Final

from gateway.sources.source import RosError, Source
from schemas.definition import Definition, DefinitionError
from schemas.installed import InstalledDefinitions, UnknownTypeError, is_message_name

# Between two looks at all topics: a robot that starts changes its graph for seconds.
LOOK_S: Final = 1.0
_TOLD_S: Final = 0.02  # so that types that are learned together are followed once


class LearnedTypes:
    """Asks the source for definitions. *on_change* is called soon after an answer."""

    def __init__(
        self, source: Source, definitions: InstalledDefinitions, on_change: Callable[[], None]
    ) -> None:
        self._source = source
        self._definitions = definitions
        self._on_change = on_change
        self._tasks: set[asyncio.Task[None]] = set()
        self._asking: set[str] = set()  # types that clients wait for
        self._answers: dict[
            str, str
        ] = {}  # by type: why it has no definition, if there is a reason
        self._looking: asyncio.Task[None] | None = None
        self._has_changed = False
        self._telling: asyncio.TimerHandle | None = None

    def close(self) -> None:
        """End what is under way. *on_change* is not called any more."""
        for task in self._tasks:
            task.cancel()
        if self._telling is not None:
            self._telling.cancel()

    def on_graph_change(self) -> None:
        """Look soon for types that are not known, or not as they are now."""
        self._has_changed = True
        # a reason may no longer hold. Without one, the source has nobody to ask
        self._answers = {name: why for name, why in self._answers.items() if not why}
        if self._looking is None:
            self._looking = self._start(self._look())

    def ask(self, type_name: str) -> bool:
        """Ask for a type of the graph, unless it is known. Return whether that is under way."""
        if type_name in self._asking:
            return True
        is_settled = type_name in self._answers or not self._may_ask(type_name)
        if is_settled or self._is_known(type_name):
            return False
        self._asking.add(type_name)
        self._start(self._ask(type_name))
        return True

    def _start(self, work: Coroutine[None, None, None]) -> asyncio.Task[None]:
        task = asyncio.create_task(work)
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)
        return task

    async def _look(self) -> None:
        try:
            while self._has_changed:
                self._has_changed = False
                present = dict.fromkeys(chain.from_iterable(self._source.topics().values()))
                self._answers = {
                    name: self._answers[name] for name in self._answers if name in present
                }
                for type_name in present:
                    if self._may_ask(type_name) and type_name not in self._asking:
                        task = self._start(self._ask(type_name))
                        # other work has its turn. A source with nothing new has answered then
                        await asyncio.sleep(0)
                        if not task.done():
                            self._asking.add(type_name)
                await asyncio.sleep(LOOK_S)
        finally:
            self._looking = None

    def _may_ask(self, type_name: str) -> bool:
        return is_message_name(type_name) and not self._definitions.is_installed(type_name)

    def _is_known(self, type_name: str) -> bool:
        try:
            self._definitions.get(type_name)
        except (UnknownTypeError, DefinitionError):  # a source may have what a file has not
            return False
        return True

    async def _ask(self, type_name: str) -> None:
        new: Mapping[str, Definition] = {}
        self._note(type_name, "it is being asked for")
        try:
            carried = await self._source.definitions(type_name) or {}
            told, why = self._definitions.told, ""
            new = {name: carried[name] for name in carried if told.get(name) != carried[name]}
        except RosError as error:
            why = str(error)
        finally:
            is_awaited = type_name in self._asking
            self._asking.discard(type_name)
        if new:
            self._definitions.tell(new)
        self._note(type_name, why)
        self._answers[type_name] = why
        if (new or why or is_awaited) and self._telling is None:
            loop = asyncio.get_running_loop()
            self._telling = loop.call_later(_TOLD_S, self._tell)

    def _note(self, type_name: str, why: str) -> None:
        if not self._is_known(type_name):
            self._definitions.note_untold(type_name, why)

    def _tell(self) -> None:
        self._telling = None
        self._on_change()
