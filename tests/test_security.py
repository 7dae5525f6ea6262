# SPDX-License-Identifier: Apache-2.0
"""The parts that decide about access, as the configuration opens and reloads them."""

import logging
import ssl
from pathlib import Path
from typing import Any

import pytest

from gateway.access.token_file import change, read
from gateway.access.tokens import make_token
from gateway.access_files import tls_context
from gateway.cli.certificate import make_certificate
from gateway.config.access import AccessConfig, AuditConfig, OperatorConfig, TlsConfig
from gateway.config.model import Config
from gateway.errors import ConfigError
from gateway.security import open_security

NOW = "2026-01-02T03:04:05+00:00"


@pytest.fixture
def path(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    return tmp_path / "ros2-gateway/tokens.json"


def config(*, lan: bool = True, **access: Any) -> Config:
    return Config(lan=lan, access=AccessConfig(**access))


def test_without_a_network_nothing_is_read_or_written(path: Path):
    path.parent.mkdir()
    path.write_text("damaged")
    with open_security(config(lan=False)) as security:
        assert security.new_token is None
        assert security.authentication.anonymous is not None
        assert security.authentication.anonymous.role == "admin"


@pytest.mark.usefixtures("path")
@pytest.mark.parametrize(
    ("settings", "standing"),
    [({}, "local"), ({"lan": True}, "foreign"), ({"trusted_proxies": ("::1",)}, "foreign")],
)
def test_pages_of_localhost_are_of_this_machine_only_if_no_other_reaches_the_gateway(
    settings, standing
):
    with open_security(Config(**settings)) as security:
        page = security.rules.standing("http://localhost:1", "localhost:2", is_encrypted=False)
    assert page == standing


def test_a_first_token_is_made_once_of_an_operator_and_kept_as_a_hash(path: Path):
    with open_security(config()) as security:
        first = security.new_token
        assert first is not None
        identity = security.authentication.identify(first)
        assert (identity.name, identity.role) == ("first", "operator")
    assert first not in path.read_text()
    with open_security(config()) as security:
        assert security.new_token is None
        assert security.authentication.identify(first).name == "first"


def test_no_token_is_created_if_clients_need_none(path: Path):
    with open_security(config(authentication="none")) as security:
        assert security.new_token is None
    assert not path.exists()


def test_a_place_that_cannot_be_written_leaves_the_gateway_closed_and_running(
    monkeypatch: pytest.MonkeyPatch, caplog
):
    monkeypatch.setenv("XDG_CONFIG_HOME", "/proc/nothing")
    with open_security(config()) as security:
        assert security.authentication.anonymous is None
        assert security.new_token is not None
        assert security.authentication.identify(security.new_token).name == "first"
    assert "valid until the gateway ends" in caplog.text
    assert security.new_token not in caplog.text


def test_a_reload_reads_tokens_and_permissions_again(path: Path):
    with open_security(config()) as security:
        change(path, lambda tokens: tokens.added(make_token("more", "viewer", NOW)[1]))
        other = config(operator=OperatorConfig(publish=("/a",)))
        tokens, policy = security.reload(other)
        assert tokens == read(path)
        assert [token.name for token in tokens.known] == ["first", "more"]
        assert policy.of("operator").may("publish", "/a")
        assert not policy.of("operator").may("publish", "/b")
        path.write_text("damaged")
        with pytest.raises(ConfigError, match="not a token file"):
            security.reload(other)


def test_a_missing_token_file_keeps_the_old_tokens(path: Path, caplog):
    with open_security(config()) as security:
        before = security.authentication.tokens
        assert before.known
        path.unlink()
        tokens, _ = security.reload(config())
        assert tokens == before
    assert f"{path} is missing: the old tokens stay valid" in caplog.text


@pytest.mark.parametrize(
    ("lan", "has_file", "level"),
    [(False, False, logging.DEBUG), (True, False, logging.INFO), (False, True, logging.INFO)],
)
@pytest.mark.usefixtures("path")
def test_the_audit_log_is_for_debugging_only_on_this_machine_alone(
    tmp_path: Path, caplog, lan, has_file, level
):
    file = tmp_path / "audit.jsonl"
    audit = AuditConfig(file=str(file) if has_file else None)
    with (
        caplog.at_level(logging.DEBUG, "gateway.audit"),
        open_security(Config(lan=lan, audit=audit)) as security,
    ):
        security.audit.record("connected", name="a")
    assert [record.levelno for record in caplog.records] == [level]
    assert file.exists() is has_file
    if has_file:
        assert '"connected"' in file.read_text()


def test_tls_is_1_2_at_least_and_its_certificate_is_read_again(tmp_path: Path):
    pytest.importorskip("cryptography")
    make_certificate(tmp_path, [])
    cert, key = str(tmp_path / "cert.pem"), str(tmp_path / "key.pem")
    tls = TlsConfig(cert=cert, key=key)
    context = tls_context(tls)
    assert context is not None
    assert context.minimum_version == ssl.TLSVersion.TLSv1_2
    with open_security(Config(tls=tls)) as security:
        make_certificate(tmp_path, [], replace=True)
        security.reload(Config(tls=tls))
        Path(key).write_text("damaged")
        with pytest.raises(ConfigError, match=r"tls\.cert: cannot use"):
            security.reload(Config(tls=tls))
    assert tls_context(TlsConfig()) is None


def test_an_encrypted_key_is_an_error_and_not_a_question(tmp_path: Path):
    pytest.importorskip("cryptography")
    from cryptography.hazmat.primitives import serialization

    make_certificate(tmp_path, [])
    path = tmp_path / "key.pem"
    key = serialization.load_pem_private_key(path.read_bytes(), None)
    path.write_bytes(
        key.private_bytes(
            serialization.Encoding.PEM,
            serialization.PrivateFormat.PKCS8,
            serialization.BestAvailableEncryption(b"secret"),
        )
    )
    with pytest.raises(ConfigError, match=r"tls\.cert: cannot use"):
        tls_context(TlsConfig(cert=str(tmp_path / "cert.pem"), key=str(path)))
