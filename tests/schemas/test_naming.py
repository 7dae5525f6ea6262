# SPDX-License-Identifier: Apache-2.0
"""The attributes of messages."""

import keyword
import re
import string

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import BaseModel

from schemas.naming import attribute, constant_attribute

# [a-z](_?[a-z0-9]+)*_? of up to 12 characters. st.from_regex spends seconds on it
names_of_fields = st.builds(
    lambda first, rest: re.sub("_+", "_", first + rest),
    st.sampled_from(string.ascii_lowercase),
    st.text(string.ascii_lowercase + string.digits + "_", max_size=11),
)
taken_names = st.sampled_from(["from", "from_", "copy", "copy_", *keyword.kwlist])
field_names = names_of_fields | taken_names


@pytest.mark.parametrize("name", ["x", "frame_id", "header", "type", "id", "range", "ros_time"])
def test_an_ordinary_field_keeps_its_name(name):
    assert attribute(name) == name


@pytest.mark.parametrize(
    "name", ["from", "class", "copy", "json", "schema", "model_x", "list", "ros_type", "Point"]
)
def test_a_taken_name_gets_a_trailing_underscore(name):
    assert attribute(name) == f"{name}_"


def test_no_public_attribute_of_the_base_class_can_be_hidden():
    public = [name for name in dir(BaseModel) if not name.startswith("_")]

    assert all(attribute(name) != name for name in public)


@given(st.lists(field_names, unique=True))
def test_different_fields_get_different_attributes(names):
    assert len({attribute(name) for name in names}) == len(names)


@given(field_names)
def test_an_attribute_is_an_identifier_and_no_keyword(name):
    assert attribute(name).isidentifier()
    assert not keyword.iskeyword(attribute(name))


def test_a_constant_keeps_its_capitals_unless_python_owns_the_name():
    assert constant_attribute("POINTS") == "POINTS"
    assert constant_attribute("None") == "None_"
