# SPDX-License-Identifier: Apache-2.0
import os
import stat
import threading
from pathlib import Path

import pytest

from gateway.access.token_file import change, default_path, read
from gateway.access.tokens import TokenFileError, Tokens, make_token

NOW = "2026-01-02T03:04:05+00:00"


def test_the_file_is_below_the_configuration_of_the_user():
    assert default_path({"XDG_CONFIG_HOME": "/conf"}) == Path("/conf/ros2-gateway/tokens.json")
    home = Path.home() / ".config/ros2-gateway/tokens.json"
    assert default_path({}) == home
    assert default_path({"XDG_CONFIG_HOME": "relative"}) == home


def test_only_its_owner_may_read_the_file_and_its_folder(tmp_path):
    path = tmp_path / "new" / "tokens.json"
    former = os.umask(0)
    try:
        change(path, lambda tokens: tokens.added(make_token("a", "viewer", NOW)[1]))
    finally:
        os.umask(former)
    assert stat.S_IMODE(path.stat().st_mode) == 0o600
    assert stat.S_IMODE(path.parent.stat().st_mode) == 0o700
    assert [token.name for token in read(path).known] == ["a"]
    assert [each.name for each in path.parent.iterdir()] == ["tokens.json"]


def test_a_missing_file_has_no_tokens(tmp_path):
    assert read(tmp_path / "tokens.json") == Tokens()


@pytest.mark.parametrize("mode", [0o620, 0o602, 0o666])
def test_a_file_that_others_may_write_is_refused_with_the_remedy(tmp_path, mode):
    path = tmp_path / "tokens.json"
    change(path, lambda tokens: tokens)
    path.chmod(mode)
    with pytest.raises(TokenFileError, match=f"chmod 600 {path}"):
        read(path)


def test_an_unreadable_file_is_an_error_with_the_path(tmp_path):
    with pytest.raises(TokenFileError, match=f"cannot read {tmp_path}, is a directory"):
        read(tmp_path)
    path = tmp_path / "tokens.json"
    path.write_bytes(b"x" * 2_000_000)
    with pytest.raises(TokenFileError, match="more than 1048576 bytes"):
        read(path)
    path.write_text("no JSON")
    with pytest.raises(TokenFileError, match=f"{path} is not a token file: the text: invalid json"):
        read(path)


def test_a_change_that_fails_leaves_the_file_as_it_was(tmp_path):
    path = tmp_path / "tokens.json"
    change(path, lambda tokens: tokens.added(make_token("a", "viewer", NOW)[1]))
    before = path.read_bytes()
    with pytest.raises(TokenFileError, match="no token is named b"):
        change(path, lambda tokens: tokens.without("b"))
    path.write_text("damaged")
    with pytest.raises(TokenFileError, match="not a token file"):
        change(path, lambda tokens: tokens)
    assert path.read_text() == "damaged"
    assert before
    with pytest.raises(TokenFileError, match="cannot write /proc/"):
        change(Path("/proc/nothing/tokens.json"), lambda tokens: tokens)


def test_changes_at_the_same_time_are_all_made(tmp_path):
    path = tmp_path / "tokens.json"

    def add(number: int) -> None:
        for count in range(5):
            token = make_token(f"t{number}-{count}", "viewer", NOW)[1]
            change(path, lambda tokens, token=token: tokens.added(token))

    threads = [threading.Thread(target=add, args=(number,)) for number in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(read(path).known) == 20
