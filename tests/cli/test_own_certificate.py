# SPDX-License-Identifier: Apache-2.0
"""The certificate that this machine signs for its port with TLS."""

import datetime as dt
import shlex
import stat
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

from gateway.cli import certificate
from gateway.cli.certificate import make_certificate, own_certificate
from gateway.errors import UsageError
from schemas.backports import tomllib

pytest.importorskip("cryptography")

HOME = "192.168.1.7"
ROOT = Path(__file__).parents[2]


@pytest.fixture(autouse=True)
def home(monkeypatch):
    monkeypatch.setattr(certificate, "own_addresses", lambda: [HOME])


def test_it_is_made_once_and_its_key_is_its_owners(tmp_path: Path, caplog):
    folder = tmp_path / "ros2-gateway"
    cert, key = own_certificate(folder)
    assert stat.S_IMODE(key.stat().st_mode) == 0o600
    made = cert.read_bytes()
    assert [record.levelname for record in caplog.records] == ["WARNING"]
    assert own_certificate(folder) == (cert, key)
    assert cert.read_bytes() == made
    assert len(caplog.records) == 1


def test_another_address_of_this_machine_needs_another(tmp_path: Path, monkeypatch, caplog):
    cert, _ = own_certificate(tmp_path)
    made = cert.read_bytes()
    monkeypatch.setattr(certificate, "own_addresses", lambda: ["10.0.0.5"])
    own_certificate(tmp_path)
    assert cert.read_bytes() != made
    assert "this machine is 10.0.0.5 now" in caplog.messages[-1]


def test_without_a_network_it_stays(tmp_path: Path, monkeypatch):
    cert, _ = own_certificate(tmp_path)
    made = cert.read_bytes()
    monkeypatch.setattr(certificate, "own_addresses", list)
    own_certificate(tmp_path)
    assert cert.read_bytes() == made


def test_one_that_has_expired_is_replaced(tmp_path: Path, monkeypatch, caplog):
    after = dt.datetime.now(dt.UTC) + dt.timedelta(days=certificate.VALID_DAYS)

    class Later(dt.datetime):
        @classmethod
        def now(cls, _: dt.tzinfo | None = None) -> dt.datetime:
            return after

    cert, _ = own_certificate(tmp_path)
    made = cert.read_bytes()
    clock = SimpleNamespace(datetime=Later, timedelta=dt.timedelta, timezone=dt.timezone)
    monkeypatch.setattr(certificate, "dt", clock)
    own_certificate(tmp_path)
    assert cert.read_bytes() != made
    assert "has expired" in caplog.messages[-1]


def test_another_authoritys_is_taken_as_it_is(tmp_path: Path, monkeypatch):
    monkeypatch.setattr(certificate, "_SIGNER", "An authority")
    make_certificate(tmp_path, [])
    monkeypatch.undo()
    monkeypatch.setattr(certificate, "own_addresses", lambda: ["10.0.0.5"])
    made = (tmp_path / "cert.pem").read_bytes()
    own_certificate(tmp_path)
    assert (tmp_path / "cert.pem").read_bytes() == made


def test_a_file_that_is_not_a_certificate_is_named(tmp_path: Path):
    (tmp_path / "cert.pem").write_text("nothing")
    with pytest.raises(UsageError, match=r"cert\.pem is not a certificate in PEM"):
        own_certificate(tmp_path)


def test_a_folder_that_cannot_be_made_is_named(tmp_path: Path):
    (tmp_path / "file").write_text("")
    with pytest.raises(UsageError, match="cannot write"):
        own_certificate(tmp_path / "file" / "folder")


def test_without_cryptography_the_error_names_a_command_that_installs_it(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "cryptography", None)
    with pytest.raises(UsageError) as caught:
        make_certificate(tmp_path, ())
    *command, requirement = shlex.split(str(caught.value).partition(": run ")[2])
    assert command == [sys.executable, "-m", "pip", "install"]
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    assert project["optional-dependencies"]["tls"] == [requirement]
