# SPDX-License-Identifier: Apache-2.0
"""The command line in a process that lacks what only POSIX has, as on Windows.

The standard library and other packages are imported before, as they have parts for Windows.
"""

import asyncio  # noqa: F401
import contextlib
import importlib
import os
import signal
import socket
import subprocess  # noqa: F401
import sys
import sysconfig
import tempfile  # noqa: F401

MODULES = ("fcntl", "grp", "pty", "pwd", "resource", "syslog", "termios", "tty", "uvloop")
OTHERS = ("cryptography.x509", "numpy", "orjson", "pydantic", "websockets.sync.client")
SIGNALS = {"SIGABRT", "SIGFPE", "SIGILL", "SIGINT", "SIGSEGV", "SIGTERM", "SIG_DFL", "SIG_IGN"}
FUNCTIONS = [
    "chown",
    "fchmod",
    "fchown",
    "fork",
    "forkpty",
    "getegid",
    "geteuid",
    "getgid",
    "getgroups",
    "getloadavg",
    "getpgid",
    "getpgrp",
    "getpriority",
    "getsid",
    "getuid",
    "killpg",
    "lchown",
    "mkfifo",
    "nice",
    "openpty",
    "pread",
    "pwrite",
    "posix_spawn",
    "register_at_fork",
    "sched_getaffinity",
    "setpgid",
    "setsid",
    "statvfs",
    "fstatvfs",
    "sysconf",
    "tcgetpgrp",
    "uname",
    "wait",
    "O_CLOEXEC",
    "O_DIRECTORY",
    "O_NOFOLLOW",
    "O_NONBLOCK",
]


def hide() -> None:
    for name in OTHERS:
        with contextlib.suppress(ImportError):
            importlib.import_module(name)
    sysconfig.get_paths()
    for name in MODULES:
        sys.modules[name] = None  # type: ignore[assignment]  # every import of it fails
    for name in dir(signal):
        if name.startswith("SIG") and name not in SIGNALS:
            delattr(signal, name)
    for name in FUNCTIONS:
        if hasattr(os, name):
            delattr(os, name)
    del socket.SO_REUSEPORT
    sys.platform = "win32"


if __name__ == "__main__":
    hide()
    sys.modules["rclpy"] = None  # type: ignore[assignment]
    from gateway.cli.main import main

    sys.exit(main())
