# SPDX-License-Identifier: Apache-2.0
"""Errors about unknown frames."""

import difflib

import pytest

from gateway.codec.error_text import MAX_ECHO
from gateway.tf.errors import InvalidTransformError, UnknownFrameError

LINKS = {f"robot_{robot}/arm/finger_{n}_link" for robot in range(5) for n in range(100)}


@pytest.mark.parametrize(
    ("asked", "meant"),
    [
        ("robot_3/arm/finger_42_lnk", "robot_3/arm/finger_42_link"),
        ("obot_3/arm/finger_42_link", "robot_3/arm/finger_42_link"),
        ("robot_3/amr/finger_42_link", "robot_3/arm/finger_42_link"),
        ("Base_link", "base_link"),
    ],
)
def test_of_hundreds_of_frames_the_one_that_was_meant_is_told(asked, meant):
    error = UnknownFrameError(asked, LINKS | {"base_link", "base_laser"})
    assert str(error) == f"frame {asked!r} is unknown; did you mean {meant}?"


def test_a_hint_costs_a_few_comparisons_of_names_that_are_cut(monkeypatch: pytest.MonkeyPatch):
    compared = []

    def compare(asked, names, n):
        compared.append((len(asked), len(names)))
        return []

    monkeypatch.setattr(difflib, "get_close_matches", compare)
    assert str(UnknownFrameError("x" * 1000, LINKS)).endswith("is unknown")
    assert compared == [(MAX_ECHO, 8)]


def test_the_name_of_a_frame_that_is_refused_is_cut():
    error = InvalidTransformError("x" * 1000, "it is odd")
    assert str(error) == f"frame '{'x' * (MAX_ECHO - 3)}...': it is odd"
