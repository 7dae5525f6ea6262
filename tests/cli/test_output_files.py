# SPDX-License-Identifier: Apache-2.0
"""Files in a user's folder: which are overwritten, and which are not."""

import os

import pytest

from gateway.cli.generate import write_files
from gateway.errors import GatewayError, UsageError

MARK = "made by us"
OURS = f"// {MARK}, long ago\n"


def test_files_are_written_with_their_folders(tmp_path):
    changed = write_files(tmp_path / "new", {"a.ts": OURS, "b/c.json": "{}"}, MARK)
    assert changed == [tmp_path / "new/a.ts", tmp_path / "new/b/c.json"]
    assert (tmp_path / "new/b/c.json").read_text() == "{}"


def test_a_file_that_was_made_so_is_overwritten(tmp_path):
    (tmp_path / "a.ts").write_text(OURS)
    assert write_files(tmp_path, {"a.ts": "new"}, MARK) == [tmp_path / "a.ts"]
    assert (tmp_path / "a.ts").read_text() == "new"


def test_a_file_that_is_as_it_should_be_is_not_touched(tmp_path):
    (tmp_path / "a.ts").write_text(OURS)
    before = (tmp_path / "a.ts").stat().st_mtime_ns
    assert write_files(tmp_path, {"a.ts": OURS}, MARK) == []
    assert (tmp_path / "a.ts").stat().st_mtime_ns == before


def test_of_a_foreign_file_nothing_is_written_at_all(tmp_path):
    (tmp_path / "b.ts").write_text("mine")
    (tmp_path / "c.ts").write_text("mine, too")
    with pytest.raises(UsageError, match=r"b\.ts and 1 more would be overwritten.*--force"):
        write_files(tmp_path, {"a.ts": OURS, "b.ts": OURS, "c.ts": OURS}, MARK)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["b.ts", "c.ts"]
    assert (tmp_path / "b.ts").read_text() == "mine"


def test_a_file_with_a_mark_far_down_is_foreign(tmp_path):
    (tmp_path / "a.ts").write_text(f"{'mine ' * 200}{MARK}")
    with pytest.raises(UsageError, match=r"a\.ts would be overwritten"):
        write_files(tmp_path, {"a.ts": OURS}, MARK)


def test_a_foreign_file_is_replaced_if_asked_for(tmp_path):
    (tmp_path / "a.ts").write_text("mine")
    assert write_files(tmp_path, {"a.ts": OURS}, MARK, replace=True) == [tmp_path / "a.ts"]
    assert (tmp_path / "a.ts").read_text() == OURS


@pytest.mark.parametrize("make", [os.mkfifo, os.mkdir])
@pytest.mark.parametrize("replace", [False, True])
def test_a_pipe_is_neither_waited_for_nor_replaced(tmp_path, replace, make):
    make(tmp_path / "a.ts")
    with pytest.raises(UsageError, match=r"a\.ts is not a file: choose another --output"):
        write_files(tmp_path, {"a.ts": OURS}, MARK, replace=replace)


def test_an_optional_file_of_others_stays(tmp_path):
    (tmp_path / "__init__.py").write_text("mine")
    texts = {"__init__.py": OURS, "a.py": OURS}
    changed = write_files(tmp_path, texts, MARK, optional=["*.asmdef", "__init__.*"])
    assert changed == [tmp_path / "a.py"]
    assert (tmp_path / "__init__.py").read_text() == "mine"


def test_a_file_that_cannot_be_written_is_named(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(GatewayError, match=r"cannot write .*, file exists"):
        write_files(tmp_path, {"file/a.ts": OURS}, MARK)
