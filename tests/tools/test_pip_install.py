# SPDX-License-Identifier: Apache-2.0
"""The packages that `make` installs, and its texts, with and without a network."""

import http.server
import os
import random
import shutil
import socket
import subprocess
import sys
import threading
import zipfile
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
TIMEOUT_S = 300
NOTHING_REACHABLE = "no network: pip cannot reach its package index, so nothing is installed.\n"


def run(command: list[str], index: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """Run a command that installs from one index alone, as on a machine without settings."""
    environment = {"PATH": os.environ["PATH"], "HOME": str(folder), "PIP_CONFIG_FILE": os.devnull}
    return subprocess.run(
        command,
        cwd=folder,
        env=environment | {"PIP_INDEX_URL": index, "PIP_NO_CACHE_DIR": "1"},
        capture_output=True,
        text=True,
        timeout=TIMEOUT_S,
        check=False,
    )


def install(index: str, folder: Path, *packages: str) -> subprocess.CompletedProcess[str]:
    script = ["sh", str(ROOT / "tools/pip-install.sh"), sys.executable]
    return run([*script, "--target", str(folder / "there"), *packages], index, folder)


@pytest.fixture
def index(tmp_path: Path) -> Iterator[str]:
    """Serve an index with one package of 2 MB."""
    page = tmp_path / "simple/big"
    page.mkdir(parents=True)
    name = "big-1.0-py3-none-any.whl"
    with zipfile.ZipFile(page / name, "w") as wheel:
        wheel.writestr("big.txt", random.Random(0).randbytes(2_000_000))
        wheel.writestr(
            "big-1.0.dist-info/METADATA", "Metadata-Version: 2.1\nName: big\nVersion: 1.0\n"
        )
        wheel.writestr("big-1.0.dist-info/WHEEL", "Wheel-Version: 1.0\nTag: py3-none-any\n")
        wheel.writestr("big-1.0.dist-info/RECORD", "")
    (page / "index.html").write_text(f'<a href="{name}">{name}</a>')
    handler = partial(http.server.SimpleHTTPRequestHandler, directory=tmp_path)
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_port}/simple"
        server.shutdown()


def test_a_large_package_is_named_while_it_is_fetched(index: str, tmp_path: Path):
    finished = install(index, tmp_path, "big")
    assert finished.returncode == 0, finished.stderr
    assert finished.stdout == "  big-1.0-py3-none-any.whl, 2.0 MB\n  unpacking ...\n"
    assert (tmp_path / "there/big.txt").exists()


def test_a_package_that_an_index_lacks_does_not_mean_a_missing_network(index: str, tmp_path: Path):
    finished = install(index, tmp_path, "small")
    assert finished.returncode == 1
    assert "No matching distribution found for small" in finished.stderr
    assert "no network" not in finished.stderr


def test_without_a_network_make_says_so_after_two_attempts(tmp_path: Path):
    make = shutil.which("make")
    if make is None:
        pytest.skip("make is not installed")
    for source in ("Makefile", "pyproject.toml"):
        shutil.copy(ROOT / source, tmp_path)
    (tmp_path / "tools").symlink_to(ROOT / "tools")
    python = tmp_path / ".venv/bin/python"
    python.parent.mkdir(parents=True)
    # as one that lacks what is installed first
    python.write_text(f'#!/bin/sh\nexec "{sys.executable}" "$@" --target "{tmp_path}/there"\n')
    python.chmod(0o755)
    with socket.create_server(("127.0.0.1", 0)) as listener:
        attempts: list[None] = []

        def refuse() -> None:
            while True:
                try:
                    listener.accept()[0].close()
                except OSError:
                    return
                attempts.append(None)

        threading.Thread(target=refuse, daemon=True).start()
        port = listener.getsockname()[1]
        finished = run([make, "demo"], f"http://127.0.0.1:{port}/simple", tmp_path)
        listener.shutdown(socket.SHUT_RDWR)
    assert finished.returncode != 0
    assert NOTHING_REACHABLE in finished.stderr
    assert "Then run make again." in finished.stderr
    assert len(attempts) == 2
    assert not (tmp_path / ".venv/.ready").exists()


def test_without_a_network_the_clients_that_tests_drive_are_not_installed(tmp_path: Path):
    python = tmp_path / "bin/python"
    python.parent.mkdir()
    python.write_text(f'#!/bin/sh\nexec "{sys.executable}" "$@"\n')
    python.chmod(0o755)
    with socket.create_server(("127.0.0.1", 0)) as closed:
        port = closed.getsockname()[1]
    script = ["sh", str(ROOT / "tools/make-clients.sh"), str(tmp_path)]
    finished = run(script, f"http://127.0.0.1:{port}/simple", tmp_path)
    assert finished.returncode == 1
    assert NOTHING_REACHABLE in finished.stderr
    assert not (tmp_path / "clients/.ready").exists()
