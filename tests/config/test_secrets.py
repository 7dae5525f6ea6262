# SPDX-License-Identifier: Apache-2.0
"""Secrets are in files alone: no setting takes one, and no text shows one."""

import argparse
from pathlib import Path

import pytest

from gateway.access.tokens import make_token
from gateway.cli.arguments import argument_parser
from gateway.cli.report import report
from gateway.config.files import Given
from gateway.config.secrets import ADVICE, exposure, is_secret_name, without_tokens
from gateway.config.settings import load, settings
from gateway.errors import ConfigError, UsageError

TOKEN, _ = make_token("me", "operator", "2026-01-02T03:04:05+00:00")


def problem(*given: Given, environment: dict[str, str] | None = None) -> str:
    with pytest.raises(ConfigError) as caught:
        load(given, environment)
    (found,) = caught.value.problems
    return found


def test_no_setting_takes_a_secret():
    assert [setting.key for setting in settings() if is_secret_name(setting.key)] == []


@pytest.mark.parametrize("key", ["access.token", "tls.password", "api_key", "access.secrets"])
def test_a_secret_is_refused_in_each_source_with_advice_and_without_its_value(key):
    assert problem(Given(key, "hunter2", "--set")) == f"--set: {key}: {ADVICE}"
    variable = f"ROS2_GATEWAY_{key.replace('.', '__').upper()}"
    assert problem(environment={variable: "hunter2"}) == f"{variable}: {ADVICE}"


def test_a_token_is_refused_as_the_value_of_any_setting():
    for setting in settings():
        found = problem(Given(setting.key, TOKEN, "gateway.toml:3", is_text=False))
        assert found == f"gateway.toml:3: {setting.key}: got a token, but {ADVICE}"
        assert TOKEN not in found


@pytest.mark.parametrize("arguments", [("serve", "--token", TOKEN), ("serve", f"--token={TOKEN}")])
def test_a_flag_for_a_token_is_refused_with_advice(arguments):
    with pytest.raises(UsageError) as caught:
        argument_parser().parse_args(arguments)
    assert str(caught.value) == f"--token: {ADVICE}. See ros2-gateway serve --help"


def test_no_report_shows_a_token(capsys):
    arguments = argparse.Namespace(debug=False, log_format="text")
    report(UsageError(f"what is {TOKEN}?"), arguments)
    assert capsys.readouterr().err == "ros2-gateway: what is r2g_...?\n"
    assert without_tokens(f"{TOKEN},{TOKEN}") == "r2g_...,r2g_..."


@pytest.mark.parametrize(("mode", "is_exposed"), [(0o600, False), (0o640, False), (0o644, True)])
def test_a_file_with_secrets_that_every_user_can_read_is_named(tmp_path: Path, mode, is_exposed):
    path = tmp_path / "key.pem"
    path.touch()
    path.chmod(mode)
    sentence = f"{path} can be read by every user of this machine: run chmod o-rwx {path}"
    assert exposure(path) == (sentence if is_exposed else None)
    assert exposure(tmp_path / "none") is None
