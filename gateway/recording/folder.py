# SPDX-License-Identifier: Apache-2.0
"""The directory of a recording, as rosbag2 has it: files, and a description of them.

The package mcap is needed to import this.
"""

import errno
import json
import logging
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

from mcap.reader import make_reader

from gateway.config.recording import RecordingConfig
from gateway.errors import system_reason
from gateway.log_fields import counted
from gateway.recording.disk import DiskFullError
from gateway.recording.entries import incomplete
from gateway.recording.mcap_file import repair

METADATA: Final = "metadata.yaml"

logger = logging.getLogger(__name__)


def write_metadata(folder: Path, distro: str = "") -> None:
    """Describe all complete files of a recording, as rosbag2 does. JSON is YAML.

    A description that exists keeps its *distro*.

    Raises:
        OSError: the description cannot be written.
    """
    files: list[dict[str, Any]] = []
    topics: dict[str, dict[str, Any]] = {}
    for path in sorted(folder.glob("*.mcap"), key=_number):
        try:
            file, its_topics = _contents(path)
        except Exception as error:  # noqa: BLE001  # mcap, struct, and zstandard have their own
            text = "move it elsewhere, if another program wrote it"
            logger.warning("%s is not in %s, %r: %s", path, METADATA, error, text)
            continue
        files.append(file)
        for each in its_topics:
            topic = topics.setdefault(each["topic_metadata"]["name"], {"message_count": 0})
            topic["topic_metadata"] = each["topic_metadata"]
            topic["message_count"] += each["message_count"]
    distro = _distro_of(folder) or distro
    _replace(folder / METADATA, _description(files, list(topics.values()), distro))


def repair_all(directory: Path, config: RecordingConfig, library: str, distro: str = "") -> None:
    """Complete the recordings in a directory whose writers were killed. Log what was done."""
    for active in incomplete(directory):
        try:
            count = repair(active, config, library)
            if count is None:
                continue
            write_metadata(active.parent, distro)
        except DiskFullError as error:
            logger.error("cannot repair %s, %s", active, error)
        except OSError as error:
            is_full = error.errno in {errno.ENOSPC, errno.EDQUOT}
            text = "make room on the disk" if is_full else "check who owns it"
            logger.error("cannot repair %s, %s: %s", active, system_reason(error), text)
        except Exception:
            logger.exception("cannot repair %s", active)
        else:
            logger.warning("repaired %s: it has %s", active.parent, counted(count, "message"))


def _contents(path: Path) -> tuple[dict[str, Any], list[dict[str, Any]]]:
    """Describe a file and its topics. Any error says that this program has not written it."""
    with path.open("rb") as file:
        summary = make_reader(file).get_summary()
    if summary is None or summary.statistics is None:
        raise ValueError("it has no summary")
    statistics = summary.statistics
    start_ns, end_ns = statistics.message_start_time, statistics.message_end_time
    description = {
        "path": path.name,
        "starting_time": {"nanoseconds_since_epoch": start_ns},
        "duration": {"nanoseconds": end_ns - start_ns},
        "message_count": statistics.message_count,
    }
    topics = [
        {
            "topic_metadata": {
                "name": channel.topic,
                "type": summary.schemas[channel.schema_id].name,
                "serialization_format": "cdr",
                "offered_qos_profiles": json.loads(channel.metadata["offered_qos_profiles"]),
                "type_description_hash": channel.metadata["topic_type_hash"],
            },
            "message_count": statistics.channel_message_counts.get(number, 0),
        }
        for number, channel in summary.channels.items()
    ]
    return description, topics


def _distro_of(folder: Path) -> str:
    """Return what the description says so far, if this program has written it."""
    try:
        with (folder / METADATA).open(encoding="utf-8") as file:
            return str(json.load(file)["rosbag2_bagfile_information"]["ros_distro"])
    except (OSError, ValueError, LookupError, TypeError):
        return ""


def _description(
    files: list[dict[str, Any]], topics: list[dict[str, Any]], distro: str
) -> Mapping[str, Any]:
    filled = [each for each in files if each["message_count"]]
    starts = [each["starting_time"]["nanoseconds_since_epoch"] for each in filled]
    ends = [
        each["starting_time"]["nanoseconds_since_epoch"] + each["duration"]["nanoseconds"]
        for each in filled
    ]
    return {
        "rosbag2_bagfile_information": {
            "version": 9,
            "storage_identifier": "mcap",
            "duration": {"nanoseconds": max(ends, default=0) - min(starts, default=0)},
            "starting_time": {"nanoseconds_since_epoch": min(starts, default=0)},
            "message_count": sum(each["message_count"] for each in files),
            "topics_with_message_count": topics,
            "compression_format": "",
            "compression_mode": "",
            "relative_file_paths": [each["path"] for each in files],
            "files": files,
            "custom_data": {},
            "ros_distro": distro,
        }
    }


def _number(path: Path) -> tuple[int, str]:
    """Return the order of files, of which the tenth follows the ninth."""
    return len(path.name), path.name


def _replace(path: Path, description: Mapping[str, Any]) -> None:
    new = path.with_name(path.name + ".new")
    with new.open("w", encoding="utf-8") as file:
        json.dump(description, file, indent=2)
        file.flush()
        os.fsync(file.fileno())
    new.rename(path)
