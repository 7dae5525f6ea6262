# SPDX-License-Identifier: Apache-2.0
"""The commands `token` and `cert`, from outside."""

import ipaddress
import os
import pty
import socket
import stat
import subprocess
import sys
from pathlib import Path

import pytest

from gateway.access.token_file import read
from tests.cli.test_main import ROOT, TIMEOUT_S, ros2_gateway


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    return tmp_path / "ros2-gateway"


def sentence(*arguments: str) -> str:
    finished = ros2_gateway(*arguments)
    assert (finished.returncode, finished.stdout) == (2, "")
    (line,) = finished.stderr.splitlines()
    return line.removeprefix("ros2-gateway: ")


def test_a_token_is_made_listed_and_revoked(home: Path):
    made = ros2_gateway("token", "create", "tablet")
    token = made.stdout.strip()
    found = read(home / "tokens.json").find(token)
    assert (found.name, found.role) == ("tablet", "operator")
    assert "is shown only this once" in made.stderr
    assert token not in made.stderr
    ros2_gateway("token", "create", "wall", "--role", "viewer")
    lines = ros2_gateway("token", "list").stdout.splitlines()
    assert [line.split()[:2] for line in lines] == [["tablet", "operator"], ["wall", "viewer"]]
    assert "is revoked" in ros2_gateway("token", "revoke", "tablet").stderr
    assert read(home / "tokens.json").find(token) is None


def test_a_mistake_with_a_token_is_one_sentence(home: Path):
    assert sentence("token", "revoke", "x") == "no token is named x: see `ros2-gateway token list`"
    ros2_gateway("token", "create", "x")
    assert sentence("token", "create", "x") == "a token named x exists already: choose another name"
    assert sentence("token", "create", "a b").startswith("got name 'a b', expected letters")
    (home / "tokens.json").chmod(0o666)
    assert sentence("token", "list").endswith(f"chmod 600 {home / 'tokens.json'}")


def test_the_token_file_is_the_configured_one(tmp_path: Path):
    path, config = tmp_path / "t.json", tmp_path / "gateway.toml"
    config.write_text(f"[access]\ntoken_file = '{path}'\n")
    assert ros2_gateway("token", "--config", str(config), "create", "a").returncode == 0
    assert [token.name for token in read(path).known] == ["a"]
    assert ros2_gateway("token", "--file", str(path), "create", "b").returncode == 0
    assert len(read(path).known) == 2


def test_a_certificate_is_for_the_names_and_addresses_of_this_machine(home: Path):
    x509 = pytest.importorskip("cryptography.x509")
    made = ros2_gateway("cert", "--name", "robot.lan", "--name", "10.1.2.3")
    assert made.returncode == 0
    cert, key = home / "cert.pem", home / "key.pem"
    assert f"--tls-cert {cert} --tls-key {key}" in made.stdout
    assert stat.S_IMODE(key.stat().st_mode) == 0o600
    certificate = x509.load_pem_x509_certificate(cert.read_bytes())
    subjects = certificate.extensions.get_extension_for_class(x509.SubjectAlternativeName).value
    names = subjects.get_values_for_type(x509.DNSName)
    assert {"robot.lan", "localhost", socket.gethostname().lower()} <= set(names)
    addresses = subjects.get_values_for_type(x509.IPAddress)
    assert {ipaddress.ip_address(each) for each in ("10.1.2.3", "127.0.0.1", "::1")} <= set(
        addresses
    )
    lifetime = certificate.not_valid_after_utc - certificate.not_valid_before_utc
    assert lifetime.days == 825
    assert sentence("cert") == f"{key} exists: add --replace to make another"
    before = key.read_bytes()
    assert ros2_gateway("cert", "--replace").returncode == 0
    assert key.read_bytes() != before
    assert sentence("cert", "--name", "a b").startswith("--name: got 'a b', expected a host name")


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        (("--lan", "--anyone-may-drive"), "access.anonymous_role: got a role, but every client"),
        (("--tls-key", "k"), "tls.key: needs tls.cert, which is missing"),
        (("--tls-port", "0", "--tls-key", "k"), "tls.key: needs tls.cert, which is missing"),
        (("--tls-cert", "/none.pem"), "tls.cert, tls.key: cannot read the files, no such file"),
        (("--tls-cert", "pyproject.toml"), "tls.cert: cannot use pyproject.toml, "),
        (("--set", "audit.file=/none/a"), "audit.file: cannot write /none/a, no such file"),
        (("--lan", "--set", "access.token_file=/"), "access.token_file: cannot read /, is a"),
        (("--set", "access.operator.call=a"), "--set access.operator.call: got 'a', expected glo"),
        (("--set", "allowed_hosts=http://a"), "--set allowed_hosts: got 'http://a', expected host"),
    ],
)
def test_a_mistake_in_the_settings_of_access_is_one_sentence(arguments, text):
    finished = ros2_gateway("serve", "--port", "0", "--log-level", "error", *arguments)
    assert finished.returncode == 2
    (line,) = finished.stderr.splitlines()
    assert line.removeprefix("ros2-gateway: ").startswith(text)


def test_check_config_finds_values_that_contradict_each_other(tmp_path: Path):
    path = tmp_path / "gateway.toml"
    path.write_text("lan = true\n[access]\nanonymous_role = 'operator'\n")
    found = sentence("check-config", str(path))
    assert found.startswith(f"{path}:3: access.anonymous_role: got a role")


@pytest.mark.parametrize(("flags", "is_shown"), [((), True), (("--no-qr",), False)])
def test_a_terminal_shows_a_qr_code_of_a_gateway_on_the_network(home, flags, is_shown):
    terminal, end = pty.openpty()
    errors = home.with_name("errors")
    with errors.open("wb") as log:
        process = subprocess.Popen(
            [sys.executable, "-m", "tests.patient_gateway", "demo", "--lan", "--port", "0", *flags],
            cwd=ROOT,
            stdout=end,
            stderr=log,
        )
    os.close(end)
    seen = ""
    while "Ctrl-C ends" not in seen:
        seen += os.read(terminal, 4096).decode(errors="replace")
    process.terminate()
    assert process.wait(TIMEOUT_S) == 0, errors.read_text()
    os.close(terminal)
    assert ("█▀▀" in seen or "▄▄▄▄▄" in seen) is is_shown
    assert ("for a phone: http://" in seen) is is_shown
