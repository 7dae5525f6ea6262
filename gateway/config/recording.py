# SPDX-License-Identifier: Apache-2.0
"""Settings of recordings."""

from typing import Annotated

from pydantic import Field

from gateway.config.access import FileName
from gateway.config.section import Section

Bytes = Annotated[int, Field(ge=1024**2)]


class RecordingConfig(Section):
    """Recordings of `ros2-gateway record`, and of clients that send `record`."""

    directory: FileName | None = Field(
        None,
        description="Directory that gets a directory for each recording. Unset:"
        " `ros2-gateway/recordings` in `XDG_DATA_HOME` or `~/.local/share`.",
    )
    max_file_bytes: Bytes = Field(
        1024**3,
        description="Maximum size of a file. Then the recording continues in the next file.",
    )
    max_file_s: Annotated[float, Field(ge=1, allow_inf_nan=False)] | None = Field(
        None,
        description="Maximum duration of a file. Then the recording continues in the next file.",
    )
    min_free_bytes: Annotated[int, Field(ge=0)] = Field(
        1000**3,
        description="Free space that a recording leaves on the disk. Then it ends. On a small"
        " disk, `min_free_share` is less and counts.",
    )
    min_free_share: Annotated[float, Field(ge=0, le=1, allow_inf_nan=False)] = Field(
        0.05, description="The same as a share of the disk. The smaller one of both counts."
    )
    queue_bytes: Bytes = Field(
        128 * 1024**2,  # 2 s of two raw cameras: an fsync of a slow disk takes so long
        description="Maximum size of the messages that wait for the disk. Beyond it, the topic"
        " that has most loses its oldest message.",
    )
