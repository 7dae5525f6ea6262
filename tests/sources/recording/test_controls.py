# SPDX-License-Identifier: Apache-2.0
"""The services of the player, where they differ from what it does when it is asked directly."""

from pathlib import Path

import pytest

from gateway.codec.cdr import compile_decoder, compile_encoder
from gateway.definitions import known_definitions
from gateway.sources.recording.controls import MAX_STEPS, REFUSAL, Controls
from gateway.sources.recording.options import PlayOptions
from gateway.sources.source import RosError
from schemas.installed import InstalledDefinitions
from tests import recordings
from tests.sources.recording.test_files import numbers
from tests.sources.recording.test_player import playing

BURST = "rosbag2_interfaces/srv/Burst"


async def test_a_burst_is_bounded(tmp_path: Path) -> None:
    definitions = known_definitions((), "types.paths")
    encode = compile_encoder(definitions.get(f"{BURST}_Request"), definitions)
    decode = compile_decoder(definitions.get(f"{BURST}_Response"), definitions)
    file = recordings.write_mcap(tmp_path / "a.mcap", numbers(3))
    async with playing(file, PlayOptions(is_paused=True)) as watched:
        client = Controls(watched.player, definitions).client("/rosbag2_player/burst", BURST)
        answer = decode(await client.call(encode({"num_messages": 2**63}, 0)))
        assert answer == {"actually_burst": MAX_STEPS}
        assert watched.player._steps <= MAX_STEPS


async def test_other_services_and_types_are_refused(tmp_path: Path) -> None:
    file = recordings.write_mcap(tmp_path / "a.mcap", numbers(3))
    async with playing(file, PlayOptions(is_paused=True)) as watched:
        controls = Controls(watched.player, InstalledDefinitions())
        with pytest.raises(RosError, match=REFUSAL):
            controls.client("/reset", "std_srvs/srv/Trigger")
        with pytest.raises(RosError, match="has type rosbag2_interfaces/srv/Burst"):
            controls.client("/rosbag2_player/burst", "std_srvs/srv/Trigger")
        with pytest.raises(RosError, match=REFUSAL):
            controls.serve("/mine", BURST, lambda _: None)
