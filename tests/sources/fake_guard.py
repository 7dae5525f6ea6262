# SPDX-License-Identifier: Apache-2.0
"""A guard without a process, which notes what it hears."""

from collections.abc import Callable, Collection

from gateway.drive.effects import GuardState


class FakeGuard:
    """A guard that notes its messages. `report` answers in its place."""

    def __init__(self) -> None:
        self.told: list[tuple[object, ...]] = []
        self.is_ready = True
        self.losses = 0
        self.on_state: dict[str, Callable[[GuardState], None]] = {}
        self.on_moving: Callable[[], None] = lambda: None

    def start(self) -> None:
        self.told.append(("start",))

    def open(
        self,
        topic: str,
        type_name: str,
        readers: Collection[str],
        on_state: Callable[[GuardState], None],
    ) -> None:
        self.told.append(("open", topic, type_name, len(readers)))
        self.on_state[topic] = on_state
        if self.is_ready:
            on_state("ready")

    def prove(self, topic: str, stamp_offset_ns: int, frame_id: str) -> None:
        self.told.append(("prove", topic, frame_id))

    def close(self, topic: str) -> None:
        self.told.append(("close", topic))
        self.on_state.pop(topic)

    def moving(self, topic: str, stamp_offset_ns: int, frame_id: str) -> None:
        self.told.append(("moving", topic, frame_id))
        self.on_moving()

    def rest(self, topic: str) -> None:
        self.told.append(("rest", topic))

    def report(self, state: GuardState) -> None:
        for on_state in list(self.on_state.values()):
            on_state(state)

    @property
    def verbs(self) -> list[object]:
        return [told[0] for told in self.told]
