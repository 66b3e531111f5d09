"""On what device a batch runs: this package's compiled code on the CPU's cores, or a device of JAX.

- "cpu": the compiled code, on all cores (where a solver has such);
- "gpu": the first GPU that JAX finds;
- "jax-cpu": the program of the GPU on the CPU, which is slow: to test it, and to see what a GPU would give.

Nothing falls back on something else: what is asked for and is not there is refused, and a result says where it was
made.
"""

from __future__ import annotations

from importlib.metadata import entry_points
from importlib.util import find_spec
from typing import Any

DEVICES = ("cpu", "gpu", "jax-cpu")

PRECISIONS = ("float64", "float32")

LEAST_RUNS = 1_000_000
"""A GPU is taken unasked for as many runs or more: compiling takes 5 to 20 s, in which two cores carry most of a
million (`benchmarks/maps_on_device.py`)."""


def has_gpu() -> bool:
    """Whether JAX finds a GPU; JAX is asked only where one of its plugins for other devices is installed."""
    if find_spec("jax_plugins") is None and not entry_points(group="jax_plugins"):
        return False
    import jax

    return any(device.platform == "gpu" for device in jax.devices())


def jax_device(name: str) -> Any:
    """The device of JAX for "gpu" or "jax-cpu".

    Raises:
        ValueError: JAX finds none, or the name is another.
    """
    if name not in ("gpu", "jax-cpu"):
        raise ValueError(f"device={name!r}: want one of {', '.join(DEVICES)}")
    import jax

    try:
        return jax.devices("cpu" if name == "jax-cpu" else "gpu")[0]
    except RuntimeError as error:
        raise ValueError(f"device={name!r}: JAX finds none here ({error})") from error


def chosen(name: str | None, runs: int) -> Any:
    """The device of JAX to use for so many runs, or None for the compiled code: as asked, or a GPU if there is one.

    Raises:
        ValueError: as of `jax_device`.
    """
    if name == "cpu":
        return None
    if name is not None:
        return jax_device(name)
    return jax_device("gpu") if runs >= LEAST_RUNS and has_gpu() else None


def checked_precision(precision: str, device: Any) -> Any:
    """The device (one of JAX, or None for the compiled code), if it calculates in this precision; else ValueError."""
    if precision not in PRECISIONS:
        raise ValueError(f"precision={precision!r}: want one of {', '.join(PRECISIONS)}")
    if device is None and precision != "float64":
        raise ValueError(
            f"precision={precision!r}: the compiled code of the CPU knows float64 alone; want device='gpu' or 'jax-cpu'"
        )
    return device


def label(device: Any, precision: str = "float64") -> str:
    """What a result says of where it was made, and of the precision where it is not double."""
    if device is None:
        return "cpu"
    name = f"jax-cpu: {device.device_kind}" if device.platform == "cpu" else f"{device.platform}: {device.device_kind}"
    return name if precision == "float64" else f"{name}, {precision}"
