# SPDX-License-Identifier: Apache-2.0
"""The base of all sections of the configuration."""

from typing import ClassVar

from pydantic import BaseModel, ConfigDict


class Section(BaseModel):
    """Settings that belong together. The first paragraph of the docstring is in the reference."""

    model_config: ClassVar[ConfigDict] = ConfigDict(
        frozen=True, strict=True, extra="forbid", validate_default=True
    )
