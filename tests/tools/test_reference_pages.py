# SPDX-License-Identifier: Apache-2.0
"""The generated parts of reference pages are up to date, and the rest of a page stays."""

from pathlib import Path

import pytest

from tools.reference_pages import BEGIN, END, PAGES, commands, main, metrics, updated

ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize("name", PAGES)
def test_a_page_has_the_generated_part(name):
    page = (ROOT / name).read_text("utf-8")
    assert updated(page, PAGES[name]()) == page, "run: python -m tools.reference_pages"


def test_each_command_has_a_section_with_its_help():
    text = commands()
    for name in ("serve", "check-config", "token", "find"):
        assert f"\n## {name}\n\n```text\nusage: ros2-gateway {name} " in text
    assert "\n### token create\n\n```text\nusage: ros2-gateway token create " in text


def test_each_metric_has_its_name_for_prometheus_and_its_labels():
    text = metrics()
    assert "\n| `ros2_gateway_client_published_total` | `client`, `topic` | counter | " in text
    assert "\n| `ros2_gateway_event_loop_lag_seconds` |  | histogram | " in text


def test_only_the_part_between_the_markers_changes():
    page = f"Head\n{BEGIN}old\n{END}Tail\n"
    assert updated(page, "new `$2` \\n\n") == f"Head\n{BEGIN}\nnew `$2` \\n\n\n{END}Tail\n"


@pytest.mark.parametrize("page", ["", BEGIN, END, f"{END}{BEGIN}"])
def test_a_page_without_both_markers_is_refused(page):
    with pytest.raises(ValueError, match="needs the line"):
        updated(page, "new")


def test_a_check_writes_nothing(tmp_path, capsys):
    old = f"# Title\n{BEGIN}old\n{END}"
    for name in PAGES:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(old)
    assert main(["--check"], tmp_path) == 1
    assert {(tmp_path / name).read_text() for name in PAGES} == {old}
    assert main([], tmp_path) == 0
    assert main(["--check"], tmp_path) == 0
    assert "differs: docs/reference/commands.md" in capsys.readouterr().out
