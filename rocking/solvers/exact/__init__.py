"""The linear Method 1 in closed form between impacts.

`solver` is what the entry point names; `batch` carries a million blocks from arrays of numbers, `jax_batch` does so on
a device of JAX, a GPU above all.
"""
