"""Values as JSON has them: it knows neither NaN nor infinities.

Source   RFC 8259, section 6
Status   strictly read back (tests)
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any


def json_values(value: Any, infinite: Callable[[float], Any] = lambda number: None) -> Any:
    """The same, all through mappings, lists and tuples, with null for NaN, which stands for what is not known or given.

    infinite: what is said for an infinity; null if not given.
    """
    if isinstance(value, Mapping):
        return {key: json_values(one, infinite) for key, one in value.items()}
    if isinstance(value, list | tuple):
        return [json_values(one, infinite) for one in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None if math.isnan(value) else infinite(value)
    return value
