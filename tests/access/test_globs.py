# SPDX-License-Identifier: Apache-2.0
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from gateway.access.permissions import compile_globs

SEGMENTS = st.text("abs", min_size=1, max_size=4)
NAMES = st.lists(SEGMENTS, min_size=1, max_size=6).map(lambda parts: "/" + "/".join(parts))
GLOB_SEGMENTS = st.just("**") | st.text("ab*", min_size=1, max_size=4).filter(
    lambda segment: "**" not in segment
)
GLOBS = st.just("**") | st.lists(GLOB_SEGMENTS, min_size=1, max_size=5).map(
    lambda parts: "/" + "/".join(parts)
)


def takes(glob: str, name: str) -> bool:
    """Say what the documentation says, one character and one segment at a time."""
    if glob == "**":
        return True
    return takes_segments(glob.split("/")[1:], name.split("/")[1:])


def takes_segments(globs: list[str], names: list[str]) -> bool:
    if not globs:
        return not names
    if globs == ["**"]:
        return bool(names)
    if globs[0] == "**":
        if globs[1] == "**":  # as often as it is written, it is one
            return takes_segments(globs[1:], names)
        return any(takes_segments(globs[1:], names[count:]) for count in range(len(names) + 1))
    return bool(names) and takes_text(globs[0], names[0]) and takes_segments(globs[1:], names[1:])


def takes_text(glob: str, text: str) -> bool:
    if not glob:
        return not text
    if glob[0] == "*":
        return any(takes_text(glob[1:], text[count:]) for count in range(len(text) + 1))
    return bool(text) and glob[0] == text[0] and takes_text(glob[1:], text[1:])


def matches(globs: list[str], name: str) -> bool:
    pattern = compile_globs(globs)
    return pattern is not None and pattern.fullmatch(name) is not None


@given(st.lists(GLOBS, max_size=3), NAMES)
@example(["/**/a/**/b"], "/a/a/b")
@example(["/**/a*/b/**"], "/a/ab/b/b")
@example(["/*a*b"], "/ab")
def test_globs_take_what_a_slow_reading_of_the_documentation_takes(globs, name):
    assert matches(globs, name) == any(takes(glob, name) for glob in globs)


@pytest.mark.parametrize(
    ("glob", "taken", "not_taken"),
    [
        ("/odom", ["/odom"], ["/odom2", "/a/odom", "/odom/a", "/ODOM"]),
        ("/*", ["/a", "/abc"], ["/a/b"]),
        ("/cam*/image", ["/cam/image", "/camera/image"], ["/cam/a/image", "/acam/image"]),
        ("/a/**", ["/a/b", "/a/b/c"], ["/a", "/ab", "/ab/c"]),
        ("/**/x", ["/x", "/a/x", "/a/b/x"], ["/ax", "/x/a"]),
        ("/a/**/x", ["/a/x", "/a/b/c/x"], ["/x", "/ax"]),
        ("**", ["/a", "/a/b"], []),
        ("/a.b", [], ["/axb"]),
    ],
)
def test_a_glob_takes_these_names_and_not_those(glob, taken, not_taken):
    assert [name for name in taken if not matches([glob], name)] == []
    assert [name for name in not_taken if matches([glob], name)] == []


def test_no_globs_take_nothing():
    assert compile_globs([]) is None


def test_a_name_made_to_be_tried_in_every_way_is_decided_at_once():
    # with groups that are not atomic these take longer than the test may
    assert not matches(["/**/a" * 12 + "/**/b"], "/a" * 100)
    assert not matches(["/" + "*a" * 12 + "b"], "/" + "a" * 199)
