# SPDX-License-Identifier: Apache-2.0
"""Patterns of resolved names."""

import re
from collections.abc import Iterable
from itertools import groupby

_ANY_SEGMENT = "/[^/]+"
_SEGMENT_ENDS = "(?![^/])"


def compile_globs(globs: Iterable[str]) -> re.Pattern[str] | None:
    """Return a pattern whose `fullmatch` accepts the names that any of the globs accepts.

    ``*`` stands for any characters of one segment. ``**`` is a segment by itself: between others
    it stands for any number of segments, also none, and at the end for one or more. Return
    ``None`` if there are no globs: nothing matches.
    """
    patterns = [_pattern(glob) for glob in globs]
    return re.compile("|".join(patterns)) if patterns else None


def _pattern(glob: str) -> str:
    """Translate a glob.

    The text between two wildcards matches at its first place, which is never wrong. The groups
    are atomic, so that the cost of a name is proportional to its length.
    """
    segments = ("/**" if glob == "**" else glob).split("/")[1:]
    runs = [(is_deep, list(run)) for is_deep, run in groupby(segments, lambda each: each == "**")]
    pattern = ""
    for number, (is_deep, run) in enumerate(runs):
        is_last = number == len(runs) - 1
        if is_deep:
            pattern += f"(?:{_ANY_SEGMENT})+" if is_last else ""
            continue
        text = "".join(f"/{_segment(each)}{_SEGMENT_ENDS}" for each in run)
        if number == 0:
            pattern += text
        elif is_last:
            pattern += f"(?:{_ANY_SEGMENT})*{text}"
        else:
            pattern += f"(?>(?:{_ANY_SEGMENT})*?{text})"
    return pattern


def _segment(segment: str) -> str:
    first, *others = map(re.escape, re.split(r"\*+", segment))
    if not others:
        return first
    between = "".join(f"(?>[^/]*?{text})" for text in others[:-1])
    return f"{first}{between}[^/]*{others[-1]}"
