# SPDX-License-Identifier: Apache-2.0
from collections.abc import Iterator

import pytest

from tests import dds_domain


@pytest.fixture(scope="module", autouse=True)
def own_domain() -> Iterator[None]:
    """Keep away from the robots and drivers that other tests of this process leave running."""
    with pytest.MonkeyPatch.context() as environment:
        environment.setenv("ROS_DOMAIN_ID", str(dds_domain.claim()))
        yield
