# SPDX-License-Identifier: Apache-2.0
import pytest
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from schemas.installed import InstalledDefinitions

WITH_WSTRINGS = ("test_msgs/msg/WStrings", "idl_msgs/msg/Track")


@pytest.fixture(scope="session")
def rosbags_store():
    """All installed types in rosbags, which shares no code with rclpy and knows no wstring."""
    definitions = InstalledDefinitions()
    types = {}
    for name in definitions.names():
        if name not in WITH_WSTRINGS:
            types.update(get_types_from_msg(definitions.get(name).text, name))
    store = get_typestore(Stores.EMPTY)
    store.register(types)
    return store
