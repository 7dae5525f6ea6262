# SPDX-License-Identifier: Apache-2.0
"""Checks of the computer: shared memory, permissions, ports, clock, free disk."""

import ctypes
import fcntl
import os
import pwd
import shlex
import time
from collections import Counter
from pathlib import Path
from typing import Final

from gateway.access import token_file
from gateway.access.tokens import TokenFileError
from gateway.access_files import exposed_secrets
from gateway.cli.doctor.finding import Finding, FindingLevel, Note, Results
from gateway.cli.doctor.machine import Machine, existing
from gateway.cli.service import TOKENS, installed_service
from gateway.cli.tokens import own_command
from gateway.errors import system_reason
from gateway.log_fields import counted
from gateway.sources.options import ZENOH_RMW
from gateway.sources.rclpy.shared_memory import FOLDER, LOCK, NEEDED_BYTES, needed_bytes

# Each participant takes 0.5 MB, and more for large messages: this is enough for a robot.
ROOM_BYTES: Final = 64 * 1024**2
# The audit log of the default size twice, and ROS's logs of a day.
DISK_BYTES: Final = 200 * 1024**2
FULL_BYTES: Final = 1024**2
AHEAD_S: Final = 60  # files of another machine may be so much newer than this one's clock
WATCHED_S: Final = 1  # the clock, for steps
STEP_S: Final = 0.05  # slewing changes it by at most 0.5 ms in a second
_TIME_ERROR: Final = 5  # adjtimex(2): the clock is not synchronized
_TIMEX_ROOM: Final = 512  # more than `struct timex` has
_TIMESYNC: Final = Path("/var/lib/systemd/timesync/clock")  # its mtime is the last known time


def shared_memory(machine: Machine) -> Results:
    """Check the room of /dev/shm, its permissions, and segments of others."""
    if machine.uses_zenoh:
        yield Note(f"{ZENOH_RMW} uses none, unless its configuration says so")
        return
    try:
        found = os.statvfs(FOLDER)
    except OSError as error:
        what = f"{FOLDER} cannot be used, {system_reason(error)}"
        why = "Nodes of this machine then send all data by UDP, which costs more CPU time"
        yield Finding("warning", what, why, f"Mount it: `sudo mount -t tmpfs tmpfs {FOLDER}`")
        return
    free = found.f_bavail * found.f_frsize
    text = f"{FOLDER} has {_size(free)} free"
    level: FindingLevel = "error" if free < needed_bytes() else "warning"
    if found.f_blocks and free < ROOM_BYTES:
        yield Finding(
            level,
            text,
            f"ROS needs {_size(NEEDED_BYTES)} to start, and a robot about {_size(ROOM_BYTES)}",
            f"Remove old files there, run `fastdds shm clean`, or enlarge {FOLDER}",
        )
    else:
        yield Note(text)
    if not os.access(FOLDER, os.W_OK | os.X_OK):
        what = f"{FOLDER} is not writable for {_user(os.geteuid())}"
        why = "Nodes of this user cannot share memory"
        yield Finding("error", what, why, f"Run `sudo chmod 1777 {FOLDER}`")
    yield from _segments_of_others()


def _segments_of_others() -> Results:
    living: Counter[int] = Counter()
    dead: Counter[int] = Counter()
    for lock in FOLDER.iterdir():
        if not LOCK.fullmatch(lock.name):
            continue
        try:
            owner = lock.stat().st_uid
            if owner != os.geteuid():
                (dead if _is_free(lock) else living)[owner] += 1
        except OSError:  # it has gone, or only its owner may read it
            continue
    for owner, count in living.items():
        yield Finding(
            "warning",
            f"{counted(count, 'participant')} of user {_user(owner)} in shared memory",
            f"In one domain, {_user(os.geteuid())} sees their topics, but gets no messages of them",
            "Run the gateway and the nodes of the robot as the same user",
        )
    for owner, count in dead.items():
        yield Finding(
            "warning",
            f"{counted(count, 'segment')} of shared memory left by programs of user {_user(owner)}",
            "Only that user can remove them",
            f"Run `sudo -u {_user(owner)} fastdds shm clean`",
        )


def _is_free(lock: Path) -> bool:
    descriptor = os.open(lock, os.O_RDONLY | os.O_NOFOLLOW | os.O_CLOEXEC)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    finally:
        os.close(descriptor)
    return True


def permissions(machine: Machine) -> Results:
    """Check the directories that are written, and the files with secrets."""
    user = _user(os.geteuid())
    yield Note(f"checked as user {user}")
    service = installed_service()
    if service and service.user != user:
        home = service.variables.get("XDG_CONFIG_HOME", "").replace("%S", str(TOKENS.parents[1]))
        own = shlex.join(own_command())
        command = f"sudo -u {service.user} XDG_CONFIG_HOME={home} {own} doctor"
        yield Note(f"the service runs as {service.user}: to check as it, run `{command}`")
    for folder in machine.folders:
        nearest = existing(folder)
        if not os.access(nearest, os.W_OK | os.X_OK):
            what = f"{nearest} is not writable for {user}"
            why = f"The gateway keeps files in {folder}"
            advice = f"Run `sudo install -d -o {user} {folder}`, or run the gateway as its owner"
            yield Finding("error", what, why, advice)
    yield from _token_file(machine.tokens, user)
    for sentence in exposed_secrets(machine.config):
        what, _, command = sentence.partition(": run ")
        why = "Such files hold secrets, or the hashes of tokens"
        yield Finding("warning", what, why, f"Run `{command}`")


def _token_file(path: Path, user: str) -> Results:
    try:
        token_file.read(path)
    except TokenFileError as error:
        what, _, command = str(error).partition(": run ")
        why = "The gateway refuses a token file that it cannot read or trust"
        if command:
            yield Finding("error", what, why, f"Run `{command}`")
        elif what.startswith("cannot read"):
            yield Finding("error", what, why, f"Run `sudo chown {user} {path}`")
        else:
            yield Finding("error", what, why, "Move it away, and create the tokens again")


def clock(machine: Machine) -> Results:
    """Check whether the clock is synchronized, far behind, or just stepped."""
    state = _clock_state()
    if state == _TIME_ERROR:
        yield Finding(
            "warning",
            "the clock is not synchronized",
            "Stamps of this robot do not fit those of other computers",
            "Start a time service: `sudo systemctl enable --now systemd-timesyncd`, or chrony",
        )
    elif state < 0:
        yield Note("this system does not tell whether the clock is synchronized")
    else:
        yield Note("the clock is synchronized")
    newest = max((_TIMESYNC, Path(__file__), machine.tokens), key=_changed_s)
    behind_s = _changed_s(newest) - time.time()
    if behind_s > AHEAD_S:
        yield Finding(
            "error",
            f"the clock is at least {_duration(behind_s)} behind",
            f"{newest} was changed at a time that is in the future",
            "Set the clock: `sudo date --set=TIME`, and check the battery of the computer",
        )
    before_s = machine.began_s
    time.sleep(WATCHED_S)
    step_s = (time.time() - time.monotonic()) - before_s
    if abs(step_s) > STEP_S:
        yield Finding(
            "warning",
            f"the clock was just set by {step_s:+.1f} s",
            "It moved otherwise than the clock since the start of the computer",
            "Wait until the time service has finished, and check again",
        )


def _clock_state() -> int:
    """Return the state that adjtimex(2) reports, or -1."""
    try:
        return int(ctypes.CDLL(None).adjtimex(ctypes.create_string_buffer(_TIMEX_ROOM)))
    except (OSError, AttributeError):
        return -1


def _changed_s(path: Path) -> float:
    try:
        return path.stat().st_mtime
    except OSError:
        return 0.0


def _duration(seconds: float) -> str:
    for unit, name in ((86400, "days"), (3600, "h"), (60, "min")):
        if seconds >= 2 * unit:
            return f"{seconds / unit:.0f} {name}"
    return f"{seconds:.0f} s"


def disk(machine: Machine) -> Results:
    """Check the free room where the gateway and ROS write."""
    by_device: dict[int, Path] = {}
    for folder in machine.folders:
        nearest = existing(folder)
        by_device.setdefault(nearest.stat().st_dev, nearest)
    for folder in by_device.values():
        found = os.statvfs(folder)
        free = found.f_bavail * found.f_frsize
        text = f"{_size(free)} free for {folder}"
        if found.f_files and not found.f_favail:
            what, why = f"no inodes left for {folder}", "No file can be created there"
            yield Finding("error", what, why, "Remove files that are not needed there")
        elif free < DISK_BYTES:
            level: FindingLevel = "error" if free < FULL_BYTES else "warning"
            why = f"Logs, tokens, and the audit log need room, about {_size(DISK_BYTES)}"
            advice = "Free disk space, for example by `sudo journalctl --vacuum-size=100M`"
            yield Finding(level, text, why, advice)
        else:
            yield Note(text)


def _size(size: int) -> str:
    for unit, name in ((1024**3, "GiB"), (1024**2, "MiB"), (1024, "KiB")):
        if size >= unit:
            return f"{size / unit:.0f} {name}"
    return f"{size} bytes"


def _user(uid: int) -> str:
    try:
        return pwd.getpwuid(uid).pw_name
    except KeyError:
        return f"'#{uid}'"  # as sudo expects it
