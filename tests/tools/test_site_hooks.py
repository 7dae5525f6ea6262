# SPDX-License-Identifier: Apache-2.0
"""Markdown as GitHub reads it, for a site that Python-Markdown writes."""

import pytest

pytest.importorskip("mkdocs", reason="mkdocs-material is not installed: run make site")
markdown = pytest.importorskip("markdown")
site_hooks = pytest.importorskip("tools.site_hooks")

STEPS = """\
1. Write a file:

   ```ini
   [Unit]

     a = 1
   ```

2. Start it.
   Then wait.

   - a nested item

     with a second paragraph

Text after it:

```sh
- not an item
   here
```
"""


def test_steps_with_code_between_them_are_one_list():
    html = markdown.markdown(
        site_hooks.indented_by_four(STEPS), extensions=["sane_lists", "pymdownx.superfences"]
    )
    assert (html.count("<ol>"), html.count("<ul>"), html.count("<li>")) == (1, 1, 3)
    assert html.index("Then wait") < html.index("</ol>") < html.index("Text after it")


def test_code_stays_as_it_is():
    lines = site_hooks.indented_by_four(STEPS).splitlines()
    assert lines[2:7] == ["    ```ini", "    [Unit]", "", "      a = 1", "    ```"]
    assert lines[-3:-1] == ["- not an item", "   here"]


@pytest.mark.parametrize("text", ["a\n", "- a\n- b\n", "| a |\n|---|\n", "a\n\n    code\n"])
def test_other_text_stays_as_it_is(text):
    assert site_hooks.indented_by_four(text) == text
