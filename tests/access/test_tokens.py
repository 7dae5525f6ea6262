# SPDX-License-Identifier: Apache-2.0
import hmac
import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gateway.access import tokens as module
from gateway.access.tokens import (
    TokenFileError,
    Tokens,
    digest_of,
    from_json,
    is_name,
    make_token,
    to_json,
)

NOW = "2026-01-02T03:04:05+00:00"


def some(count: int) -> tuple[list[str], Tokens]:
    made = [make_token(f"t{number}", "operator", NOW) for number in range(count)]
    return [text for text, _ in made], Tokens(tuple(token for _, token in made))


def test_a_token_is_found_by_its_text_alone():
    texts, tokens = some(3)
    for number, text in enumerate(texts):
        found = tokens.find(text)
        assert found is not None
        assert found.name == f"t{number}"
    assert tokens.find(texts[0] + "x") is None
    assert tokens.find(texts[0][:-1]) is None
    assert tokens.find("") is None


def test_a_token_has_256_random_bits_and_fits_a_header_and_a_subprotocol():
    texts = [make_token("t", "viewer", NOW)[0] for _ in range(100)]
    assert len(set(texts)) == 100
    for text in texts:
        assert text.startswith("r2g_")
        assert len(text) == 4 + 43  # base64 of 32 bytes
        assert text.replace("-", "").replace("_", "").isalnum()


def test_a_token_itself_is_kept_nowhere():
    text, token = make_token("tablet", "operator", NOW)
    written = to_json(Tokens((token,)))
    assert text.encode() not in written
    assert text.removeprefix("r2g_") not in repr(token)


@given(st.text() | st.text(st.characters(categories=["Cs", "Cc", "Lo"])))
def test_any_text_is_compared_and_is_not_a_token(text):
    _, tokens = some(2)
    assert tokens.find(text) is None


def test_a_text_longer_than_any_token_is_not_even_hashed(monkeypatch):
    _, tokens = some(1)
    hashed: list[int] = []
    digest_of = module.digest_of
    monkeypatch.setattr(
        module, "digest_of", lambda text: hashed.append(len(text)) or digest_of(text)
    )
    assert [tokens.find("x" * length) for length in (256, 257)] == [None, None]
    assert hashed == [256]


def test_every_known_hash_is_compared_whole_whichever_fits(monkeypatch):
    texts, tokens = some(5)
    compared = []
    compare_digest = hmac.compare_digest  # which takes as long wherever the two differ

    def compare(one: bytes, other: bytes) -> bool:
        compared.append((one, other))
        return compare_digest(one, other)

    monkeypatch.setattr(module.hmac, "compare_digest", compare)
    for text in (texts[0], texts[4], "wrong"):
        compared.clear()
        tokens.find(text)
        assert compared == [(each.digest, digest_of(text)) for each in tokens.known]


def test_the_file_reads_as_it_was_written():
    _, tokens = some(3)
    assert from_json(to_json(tokens)) == tokens
    assert from_json(to_json(Tokens())) == Tokens()


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        (b"", "the text: invalid json"),
        (b"[]", "the text: input should be an object"),
        (b'{"version":2,"tokens":[]}', "version: input should be 1"),
        (b'{"version":1,"tokens":[{"name":"a"}]}', r"tokens\.0\.role: field required"),
        (b'{"version":1,"tokens":[],"more":1}', "more: extra inputs are not permitted"),
        (b'{"version":1,"tokens":\xff}', "the text: invalid json"),
    ],
)
def test_a_file_with_other_content_is_refused_with_the_place(text, reason):
    with pytest.raises(TokenFileError, match=reason):
        from_json(text)


@pytest.mark.parametrize(
    ("key", "value"), [("role", "root"), ("sha256", "00"), ("name", "a b"), ("name", "-rf")]
)
def test_a_value_that_does_not_fit_is_refused_without_being_repeated(key, value):
    entry = {"name": "a", "role": "viewer", "created": NOW, "sha256": "0" * 64, key: value}
    with pytest.raises(TokenFileError, match=rf"tokens\.0\.{key}"):
        from_json(json.dumps({"version": 1, "tokens": [entry]}).encode())


def test_names_and_hashes_are_unique():
    _, tokens = some(1)
    (token,) = tokens.known
    other = token.model_copy(update={"name": "other"})
    again = make_token(token.name, "viewer", NOW)[1]
    for pair, reason in (((token, other), "hash"), ((token, again), "name")):
        with pytest.raises(TokenFileError, match=f"two tokens have the {reason}"):
            from_json(to_json(Tokens(pair)))


def test_adding_and_removing_leave_the_others():
    _, tokens = some(3)
    new = make_token("new", "admin", NOW)[1]
    more = tokens.added(new)
    assert more.known == (*tokens.known, new)
    assert more.without("new") == tokens
    assert more.with_digest(new.digest) == new
    with pytest.raises(TokenFileError, match="named new exists"):
        more.added(new)
    with pytest.raises(TokenFileError, match="no token is named new"):
        tokens.without("new")


def test_the_number_of_tokens_is_bounded():
    _, tokens = some(999)
    tokens = tokens.added(make_token("the-last", "viewer", NOW)[1])
    with pytest.raises(TokenFileError, match="there are 1000 tokens already"):
        tokens.added(make_token("one-more", "viewer", NOW)[1])


@pytest.mark.parametrize(
    ("text", "is_one"),
    [("tablet", True), ("lab-2.left_hand", True), ("", False), ("-a", False), ("a" * 65, False)],
)
def test_a_name_is_letters_digits_and_a_few_signs(text, is_one):
    assert is_name(text) is is_one
    assert is_name(text + "\n") is False
