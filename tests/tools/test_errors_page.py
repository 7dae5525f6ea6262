# SPDX-License-Identifier: Apache-2.0
"""The page of error codes."""

from typing import get_args

from gateway.core import errors
from gateway.transport import close_codes
from tools.reference_pages import error_codes


def test_every_code_is_explained():
    sent = [code for code in vars(close_codes).values() if isinstance(code, int)]
    assert set(errors.EXPLANATIONS) == set(get_args(errors.StatusCode))
    assert set(close_codes.EXPLANATIONS) == set(sent)
    assert set(error_codes().split("\n")) >= {f"### {each}" for each in sent}


def test_an_explanation_is_a_few_whole_sentences():
    explanations = [*errors.EXPLANATIONS.values(), *close_codes.EXPLANATIONS.values()]
    texts = [text for explanation in explanations for text in explanation]
    assert [text for text in texts if not text.endswith(".") or len(text.split()) > 40] == []
