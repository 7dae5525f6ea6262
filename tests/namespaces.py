# SPDX-License-Identifier: Apache-2.0
"""The mark of tests that mount something where nobody else sees it."""

import subprocess

import pytest


def has_namespaces() -> bool:
    command = ["unshare", "--mount", "sh", "-c", "mount -t tmpfs tmpfs /mnt"]
    try:
        return subprocess.run(command, capture_output=True, check=False).returncode == 0
    except FileNotFoundError:
        return False


needs_namespaces = pytest.mark.skipif(
    not has_namespaces(), reason="mounting a file system takes root, or CAP_SYS_ADMIN"
)
