# SPDX-License-Identifier: Apache-2.0
from tests.transport.conftest import no_blocking_calls, pytest_asyncio_loop_factories, serve

__all__ = ["no_blocking_calls", "pytest_asyncio_loop_factories", "serve"]
