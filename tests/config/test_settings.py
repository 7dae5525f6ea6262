# SPDX-License-Identifier: Apache-2.0
"""The sources of the configuration, their order, and the texts of mistakes."""

from pathlib import Path

import pytest

from gateway.config.files import Given
from gateway.config.model import Config
from gateway.config.settings import load, settings, to_toml
from gateway.errors import ConfigError
from schemas.backports import tomllib


def toml(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "gateway.toml"
    path.write_text(text, encoding="utf-8")
    return path


def problems(*args, **kwargs) -> tuple[str, ...]:
    with pytest.raises(ConfigError) as caught:
        load(*args, **kwargs)
    return caught.value.problems


def test_without_sources_everything_is_default():
    loaded = load()
    assert loaded.config == Config()
    assert set(loaded.origins.values()) == {"default"}


def test_a_flag_beats_the_environment_which_beats_the_file_which_beats_the_default(tmp_path):
    path = toml(tmp_path, 'port = 1\nhost = "file"\n[limits]\nmax_clients = 3\n')
    environment = {"ROS2_GATEWAY_PORT": "2", "ROS2_GATEWAY_HOST": "environment"}
    config, origins, *_ = load([Given("port", "4", "--port")], environment, path)
    assert (config.port, config.host, config.limits.max_clients) == (4, "environment", 3)
    assert config.path == "/"
    assert origins["port"] == "--port"
    assert origins["host"] == "ROS2_GATEWAY_HOST"
    assert origins["limits.max_clients"] == f"{path}:4"
    assert origins["path"] == "default"


def test_the_environment_names_the_file_unless_a_flag_does(tmp_path):
    path = toml(tmp_path, "port = 1")
    other = tmp_path / "other.toml"
    other.write_text("port = 2")
    environment = {"ROS2_GATEWAY_CONFIG": str(path)}
    assert load(environment=environment).config.port == 1
    assert load(environment=environment, file=other).config.port == 2


@pytest.mark.parametrize("value", ["10.0.0.1/8", "proxy.example", "10.0.0.0/40", "x"])
def test_a_trusted_proxy_is_an_address_or_a_network(value):
    with pytest.raises(ConfigError) as caught:
        load([Given("trusted_proxies", value, "--set")])
    assert "expected addresses or networks such as 10.0.0.0/8" in str(caught.value)
    wanted = ("10.0.0.0/8", "::1", "192.0.2.1")
    assert (
        load([Given("trusted_proxies", ",".join(wanted), "--set")]).config.trusted_proxies == wanted
    )


def test_variables_of_other_programs_are_ignored():
    assert load(environment={"ROS_DOMAIN_ID": "x", "PORT": "y"}).config == Config()


@pytest.mark.parametrize(
    ("key", "text", "value"),
    [
        ("ros.use_sim_time", "true", True),
        ("ros.domain_id", "42", 42),
        ("limits.frames_per_s", "0", 0),
        ("limits.ping_interval_s", "2.5", 2.5),
        ("log.level", "debug", "debug"),
        ("ros.namespace", "/robot1/arm", "/robot1/arm"),
    ],
)
def test_text_is_read_as_the_type_of_its_key(key, text, value):
    section, name = key.split(".")
    config = load([Given(key, text, "--set")]).config
    assert getattr(getattr(config, section), name) == value


def test_a_list_is_an_array_in_toml_and_has_commas_in_text(tmp_path):
    wanted = ("https://a.example", "http://b.example:8080")
    path = toml(tmp_path, f"allowed_origins = {list(wanted)}")
    assert load(file=path).config.allowed_origins == wanted
    for text in (", ".join(wanted), f' ["{wanted[0]}", "{wanted[1]}"]'):
        environment = {"ROS2_GATEWAY_ALLOWED_ORIGINS": text}
        assert load(environment=environment).config.allowed_origins == wanted
    assert load(environment={"ROS2_GATEWAY_ALLOWED_ORIGINS": ""}).config.allowed_origins == ()


@pytest.mark.parametrize("text", ['["https://a.example"', "[https://a.example]", "[1]", "[[]]"])
def test_a_list_that_is_not_of_texts_is_refused(text):
    (problem,) = problems([Given("allowed_origins", text, "--set")])
    assert problem.startswith("--set: got")


@pytest.mark.parametrize(
    "value", ['["https://a.example/"]', '["a.example"]', "[0]", '"https://a.example"', "{a=1}"]
)
def test_an_invalid_origin_is_refused(tmp_path, value):
    (problem,) = problems(file=toml(tmp_path, f"allowed_origins = {value}"))
    assert problem.endswith("expected origins such as https://ui.example, null, or *")


def test_every_key_can_be_set_by_its_variable():
    loaded = load()
    table = tomllib.loads(to_toml(loaded))
    for setting in settings():
        *sections, name = setting.key.split(".")
        value = table
        for section in sections:
            value = value[section]
        if name not in value:
            continue  # unset by default
        text = ",".join(value[name]) if isinstance(value[name], list) else str(value[name]).lower()
        origins = load(environment={setting.variable: text}).origins
        assert origins[setting.key] == setting.variable


def test_a_wrong_value_is_named_with_its_file_and_key_and_what_was_expected(tmp_path):
    path = toml(tmp_path, 'port = "x"\n[limits]\nopen_timeout_s = 0\n[ros]\nuse_sim_time = 1\n')
    assert problems(file=path) == (
        f"{path}:1: port: got 'x', expected an integer from 0 to 65535",
        f"{path}:3: limits.open_timeout_s: got 0, expected a number above 0 and up to 3600",
        f"{path}:5: ros.use_sim_time: got 1, expected true or false",
    )


def test_a_wrong_value_is_named_with_its_variable():
    assert problems(environment={"ROS2_GATEWAY_LOG__LEVEL": "loud"}) == (
        "ROS2_GATEWAY_LOG__LEVEL: got 'loud', expected debug, info, warning or error",
    )


def test_a_long_wrong_value_is_shortened():
    (problem,) = problems([Given("port", "7" * 10_000, "--port")])
    assert problem.startswith("--port: got '777777")
    assert len(problem) < 100


def test_a_wrong_value_is_named_with_its_flag():
    assert problems([Given("port", "70000", "--port")]) == (
        "--port: got '70000', expected an integer from 0 to 65535",
    )


@pytest.mark.parametrize("value", ["nan", "inf", "-1", "", "1 s"])
def test_a_rate_is_a_finite_number(value):
    assert (
        "expected a number of at least 0"
        in problems([Given("limits.frames_per_s", value, "--set")])[0]
    )


@pytest.mark.parametrize("value", ["/", "/a", "/a/b_1"])
def test_a_namespace_is_accepted(value):
    assert load([Given("ros.namespace", value, "--namespace")]).config.ros.namespace == value


@pytest.mark.parametrize("value", ["", "a", "//", "/a/", "/1", "/a b", "/a\n", "/a\0", "/{node}"])
def test_an_invalid_namespace_is_refused(value):
    assert (
        "expected a namespace such as"
        in problems([Given("ros.namespace", value, "--namespace")])[0]
    )


def test_an_unknown_key_is_refused_with_the_closest_one(tmp_path):
    path = toml(
        tmp_path,
        "prt = 3\nmax_clients = 3\n[limits]\nmax_client = 3\n[sauce]\nx = 1\n[image]\nx = 1\n",
    )
    assert problems(file=path) == (
        f"{path}:1: unknown setting prt, did you mean port",
        f"{path}:2: unknown setting max_clients, did you mean limits.max_clients",
        f"{path}:4: unknown setting limits.max_client, did you mean limits.max_clients",
        f"{path}:5: unknown setting sauce",
        f"{path}:7: unknown setting image, did you mean images",
    )


def test_an_unknown_variable_is_refused_with_the_closest_one():
    assert problems(environment={"ROS2_GATEWAY_PROT": "1"}) == (
        "unknown environment variable ROS2_GATEWAY_PROT, did you mean ROS2_GATEWAY_PORT",
    )


def test_the_token_of_a_client_is_not_a_setting():
    assert load(environment={"ROS2_GATEWAY_TOKEN": "r2g_x"}).origins["port"] == "default"


def test_a_value_in_the_place_of_a_table_is_refused(tmp_path):
    path = toml(tmp_path, "limits = 3\n")
    assert problems(file=path) == (f"{path}:1: limits: got 3, expected a table",)


def test_mistakes_of_all_sources_are_reported_at_once(tmp_path):
    path = toml(tmp_path, "prt = 3\n")
    found = problems([Given("port", "x", "--port")], {"ROS2_GATEWAY_X": "1"}, path)
    assert len(found) == 3


def test_a_missing_or_invalid_file_is_one_sentence(tmp_path):
    missing = tmp_path / "none.toml"
    assert problems(file=missing) == (f"cannot read {missing}, no such file or directory",)
    assert problems(file=tmp_path) == (f"cannot read {tmp_path}, is a directory",)
    (broken,) = problems(file=toml(tmp_path, "port 3"))
    assert broken.startswith(f"{tmp_path / 'gateway.toml'} is not valid TOML: ")
    latin = tmp_path / "latin.toml"
    latin.write_bytes(b'host = "\xe4"')
    (undecodable,) = problems(file=latin)
    assert undecodable.startswith(f"{latin} is not valid TOML: ")


def test_a_printed_configuration_reads_back_as_the_same(tmp_path):
    given = [Given("port", "80", "--port"), Given("ros.namespace", "/a", "--namespace")]
    loaded = load(given, {"ROS2_GATEWAY_ROS__DOMAIN_ID": "7"})
    printed = to_toml(loaded)
    assert "port = 80  # --port\n" in printed
    assert "domain_id = 7  # ROS2_GATEWAY_ROS__DOMAIN_ID\n" in printed
    assert load(file=toml(tmp_path, printed)).config == loaded.config


def test_an_unset_value_is_printed_as_a_comment():
    assert "# domain_id =  # default\n" in to_toml(load())
