"""Drawings of signs, made by code before the pages are read: docs/_made/*.svg.

The block of a drawing is placed with the same formulas as the text states, so that a drawing cannot show another sign.
"""

# Points are arrays: "+" adds, it does not join.
# ruff: noqa: RUF005

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Arc, Polygon, Rectangle
from sphinx.application import Sphinx

INK, WOOD, FLOOR, RED, BLUE = "#3a3a3a", "#e8d5b0", "#9a9a9a", "#c0392b", "#1f5f99"
B, H = 0.45, 1.0
plt.rcParams["svg.hashsalt"] = "rocking-blocks"
ARROW = {"arrowstyle": "-|>", "lw": 1.4, "shrinkA": 0, "shrinkB": 0, "mutation_scale": 11}


def corners(theta: float, x: float = 0.0, lift: float = 0.0, s: float = 1.0) -> np.ndarray:
    """Corners of the block that stands on its corner s at (x + s B/2, lift), turned clockwise by theta."""
    flat = np.array([[-B / 2, 0.0], [B / 2, 0.0], [B / 2, H], [-B / 2, H]]) - [s * B / 2, 0.0]
    cos, sin = math.cos(theta), math.sin(theta)
    turned = np.column_stack([flat[:, 0] * cos + flat[:, 1] * sin, -flat[:, 0] * sin + flat[:, 1] * cos])
    return turned + [x + s * B / 2, lift]


def arrow(ax: Axes, start: Any, end: Any, colour: str = INK, text: str = "", at: Any = None, **how: Any) -> None:
    """An arrow with a label beside its head."""
    ax.annotate("", end, start, arrowprops=ARROW | {"color": colour})
    if text:
        ax.text(*(end if at is None else at), text, color=colour, fontsize=12, **how)


def floor(ax: Axes, left: float, right: float, z: float = 0.0) -> None:
    """The base, hatched below."""
    ax.add_patch(Rectangle((left, z - 0.07), right - left, 0.07, facecolor="none", edgecolor=FLOOR, hatch="////", lw=0))
    ax.plot([left, right], [z, z], color=INK, lw=1.2)


def block(ax: Axes, theta: float = 0.0, **where: float) -> np.ndarray:
    """Draw the block; its corners."""
    shape = corners(theta, **where)
    ax.add_patch(Polygon(shape, facecolor=WOOD, edgecolor=INK, lw=1.3))
    return shape


def _bare(ax: Axes, x: tuple[float, float], z: tuple[float, float]) -> None:
    ax.set_xlim(*x)
    ax.set_ylim(*z)
    ax.set_aspect("equal")
    ax.axis("off")


def frame_and_signs() -> Any:
    """Frame, rotation, carrying corner, base motion."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(8.6, 4.6))
    floor(left, -0.75, 0.85)
    theta = 0.22
    shape = block(left, theta)
    left.add_patch(Polygon(corners(0.0), facecolor="none", edgecolor=FLOOR, ls=":", lw=1.0))
    foot, centre = np.array([B / 2, 0.0]), shape.mean(axis=0)
    left.plot(*np.transpose([foot, centre]), color=BLUE, lw=1.2)
    left.text(centre[0] - 0.06, centre[1] - 0.25, "$R$", color=BLUE, fontsize=12)
    left.plot(*centre, "o", color=INK, ms=4)
    left.text(centre[0] - 0.06, centre[1] + 0.05, "c", fontsize=12)
    left.plot([foot[0]] * 2, [0.0, 1.25], color=FLOOR, lw=0.8, ls="--")
    edge = math.degrees(math.pi / 2 - theta)
    left.add_patch(Arc(foot, 1.9, 1.9, theta1=edge, theta2=90.0, color=RED, lw=1.4))
    left.text(foot[0] + 0.06, 1.0, r"$\theta>0$", color=RED, fontsize=12)
    to_centre = math.degrees(math.atan2(*(centre - foot)[::-1]))
    left.add_patch(Arc(foot, 0.62, 0.62, theta1=90.0, theta2=to_centre, color=BLUE, lw=1.2))
    left.text(foot[0] + 0.02, 0.3, r"$\psi$", color=BLUE, fontsize=12)
    arrow(left, (-0.7, 0.35), (-0.4, 0.35), INK, "$x$", (-0.38, 0.32))
    arrow(left, (-0.7, 0.35), (-0.7, 0.65), INK, "$z$", (-0.73, 0.68))
    arrow(left, (-0.35, -0.2), (0.15, -0.2), RED, "$a_x>0$", (0.18, -0.225))
    arrow(left, (0.6, -0.3), (0.6, -0.1), RED, "$a_z>0$", (0.63, -0.23))
    left.text(foot[0] + 0.03, 0.03, "$s=+1$", fontsize=11)
    left.set_title("leans to $+x$: $\\theta>0$, carried by $s=+1$", fontsize=11)
    _bare(left, (-0.8, 0.95), (-0.35, 1.35))

    floor(right, -0.75, 0.75)
    block(right)
    right.plot([-B / 2, 0.0], [0.0, H / 2], color=BLUE, lw=1.2)
    right.plot(0.0, H / 2, "o", color=INK, ms=4)
    right.text(0.03, H / 2, "c", fontsize=12)
    right.text(-0.12, 0.21, "$R$", color=BLUE, fontsize=12)
    right.add_patch(Arc((-B / 2, 0.0), 0.9, 0.9, theta1=90 - math.degrees(math.atan2(B, H)), theta2=90, color=BLUE))
    right.text(-0.195, 0.475, r"$\alpha$", color=BLUE, fontsize=12)
    right.annotate("", (-B / 2, -0.13), (B / 2, -0.13), arrowprops={"arrowstyle": "<->", "color": INK})
    right.text(-0.02, -0.24, "$b$", fontsize=12)
    right.annotate("", (B / 2 + 0.08, 0.0), (B / 2 + 0.08, H), arrowprops={"arrowstyle": "<->", "color": INK})
    right.text(B / 2 + 0.11, H / 2, "$h$", fontsize=12)
    right.text(-B / 2 - 0.24, 0.03, "$s=-1$", fontsize=11)
    right.text(B / 2 + 0.13, 0.03, "$s=+1$", fontsize=11)
    right.set_title("upright: sizes", fontsize=11)
    _bare(right, (-0.75, 0.75), (-0.35, 1.35))
    return figure


def accelerometer_signs() -> Any:
    """The block frame and what a sensor on a standing block reads."""
    figure, ax = plt.subplots(figsize=(4.4, 4.2))
    floor(ax, -0.7, 0.7)
    theta = 0.2
    block(ax, theta)
    cos, sin = math.cos(theta), math.sin(theta)
    foot = np.array([B / 2, 0.0])

    def at(X: float, Z: float) -> np.ndarray:
        return foot + [(X - B / 2) * cos + Z * sin, -(X - B / 2) * sin + Z * cos]

    arrow(ax, at(0, 0), at(0.3, 0), RED, "$X$", at(0.32, 0.02))
    arrow(ax, at(0, 0), at(0, 0.3), RED, "$Z$", at(0.03, 0.3))
    ax.plot(*at(0.12, 0.85), "s", color=BLUE, ms=8)
    arrow(ax, at(0.12, 0.85), at(0.42, 0.85), BLUE, "sensitive axis $(d_X, d_Z)$", at(-0.1, 1.1))
    arrow(ax, (-0.5, 0.9), (-0.5, 0.6), INK, "$g$", (-0.47, 0.68))
    _bare(ax, (-0.75, 1.05), (-0.15, 1.3))
    return figure


def six_modes() -> Any:
    """Ishiyama's six modes."""
    figure, axes = plt.subplots(2, 3, figsize=(8.6, 5.4))
    modes = (
        ("rest", {}, 0.0, 0.0), ("slide", {}, 0.22, 0.0), ("rotation", {"theta": 0.2}, 0.0, 0.0),
        ("slide rotation", {"theta": 0.2}, 0.22, 0.0), ("translation jump", {}, 0.18, 0.14),
        ("rotation jump", {"theta": 0.2}, 0.18, 0.14),
    )  # fmt: skip
    for ax, (name, turned, slide, lift) in zip(axes.flat, modes, strict=True):
        floor(ax, -0.55, 0.95)
        if slide or turned or lift:
            ax.add_patch(Polygon(corners(0.0), facecolor="none", edgecolor=FLOOR, ls=":"))
        block(ax, turned.get("theta", 0.0), x=slide, lift=lift)
        if slide and not lift:
            arrow(
                ax, (B / 2 + slide + 0.02, 0.05), (B / 2 + slide + 0.22, 0.05), RED, "$u$", (B / 2 + slide + 0.24, 0.02)
            )
        if turned:
            x = B / 2 + slide
            bent = ARROW | {"color": RED, "connectionstyle": "arc3,rad=-0.2"}
            ax.annotate("", (x + 0.42, lift + 0.8), (x + 0.02, lift + 0.92), arrowprops=bent)
            ax.text(x + 0.26, lift + 0.93, r"$\omega$", color=RED, fontsize=12)
        ax.set_title(name, fontsize=11)
        _bare(ax, (-0.55, 0.95), (-0.1, 1.32))
    figure.tight_layout()
    return figure


def corner_forces() -> Any:
    """Forces and velocities at the carrying corner."""
    figure, ax = plt.subplots(figsize=(5.0, 4.6))
    floor(ax, -0.6, 0.9)
    shape = block(ax, 0.22)
    foot, centre = np.array([B / 2, 0.0]), shape.mean(axis=0)
    arrow(ax, centre, foot, BLUE, r"$\mathbf{r}=(s R\sin\psi,\,-R\cos\psi)$", (0.46, 0.55))
    ax.plot(*centre, "o", color=INK, ms=4)
    arrow(ax, foot, foot + [0.0, 0.32], RED, "$N$", foot + [0.03, 0.26])
    arrow(ax, foot, foot + [0.32, 0.0], RED, "$F$", foot + [0.34, 0.03])
    arrow(ax, foot + [-0.05, -0.14], foot + [0.3, -0.14], INK, "$u$ slip", foot + [0.32, -0.16])
    arrow(ax, centre, centre - [0.0, 0.3], INK, "$m(g+a_z)$", centre + [-0.66, -0.24])
    arrow(ax, centre, centre - [0.3, 0.0], INK, "$m a_x$", centre + [-0.42, 0.04])
    _bare(ax, (-0.6, 1.05), (-0.25, 1.2))
    return figure


def contact_of_elements() -> Any:
    """A corner on an edge: spring, dashpot, slider, overlap."""
    figure, ax = plt.subplots(figsize=(6.4, 4.0))
    ax.add_patch(Rectangle((-1.0, -0.5), 2.0, 0.5, facecolor="#dde3e8", edgecolor=INK))
    corner = np.array([0.0, -0.12])
    ax.add_patch(Polygon([corner, corner + [0.75, 0.62], corner + [0.1, 1.05], corner + [-0.7, 0.45]],
                         facecolor=WOOD, edgecolor=INK, alpha=0.85))  # fmt: skip
    ax.text(-0.95, -0.42, "body B", fontsize=11)
    ax.text(-0.1, 0.5, "body A", fontsize=11)
    ax.annotate("", (-0.35, 0.0), (-0.35, -0.12), arrowprops={"arrowstyle": "<->", "color": BLUE})
    ax.text(-0.68, -0.13, r"$\delta>0$", color=BLUE, fontsize=12)
    ax.plot([-0.4, 0.0], [-0.12, -0.12], color=BLUE, lw=0.8, ls=":")
    arrow(ax, corner, corner + [0.0, 0.42], RED, r"$N\geq0$", (0.04, 0.24))
    arrow(ax, corner, corner + [0.45, 0.0], RED, r"$|F|\leq\mu N$", (0.47, -0.16))
    arrow(ax, (-0.8, 0.0), (-0.8, 0.28), INK, r"$\mathbf{n}$", (-0.77, 0.2))
    z = np.linspace(0.0, 1.0, 60)
    ax.plot(1.25 + 0.06 * np.where((z > 0.15) & (z < 0.85), np.sign(np.sin(z * 40)), 0.0), -0.5 + z, color=INK, lw=1.1)
    ax.text(1.2, -0.62, "$k_n$", fontsize=11)
    ax.plot([1.55, 1.55], [-0.5, -0.1], color=INK, lw=1.1)
    ax.plot([1.47, 1.47, 1.63, 1.63], [0.15, -0.1, -0.1, 0.15], color=INK, lw=1.1)
    ax.plot([1.49, 1.61], [0.05, 0.05], color=INK, lw=2.2)
    ax.plot([1.55, 1.55], [0.05, 0.5], color=INK, lw=1.1)
    ax.text(1.52, -0.62, "$c$", fontsize=11)
    ax.text(1.12, 0.58, "normal", fontsize=10)
    ax.text(2.0, 0.58, "shear", fontsize=10)
    x = np.linspace(0.0, 1.0, 60)
    ax.plot(
        1.8 + 0.6 * x, 0.2 + 0.06 * np.where((x > 0.2) & (x < 0.8), np.sign(np.sin(x * 40)), 0.0), color=INK, lw=1.1
    )
    ax.text(2.05, 0.3, "$k_s$", fontsize=11)
    ax.plot([1.8, 2.05], [-0.15, -0.15], color=INK, lw=1.1)
    ax.plot([2.0, 2.2, 2.2, 2.0], [-0.08, -0.08, -0.22, -0.22], color=INK, lw=1.1)
    ax.plot([2.1, 2.1], [-0.2, -0.1], color=INK, lw=2.2)
    ax.plot([2.1, 2.4], [-0.15, -0.15], color=INK, lw=1.1)
    ax.text(2.08, -0.4, "$c$", fontsize=11)
    ax.plot([2.4, 2.4], [-0.15, 0.2], color=INK, lw=1.1)
    ax.plot([1.8, 1.8], [-0.15, 0.2], color=INK, lw=1.1)
    ax.plot([2.4, 2.62], [0.02, 0.02], color=INK, lw=1.1)
    ax.plot([2.55, 2.85], [0.08, 0.08], color=INK, lw=1.1)
    ax.plot([2.62, 2.92], [0.02, 0.02], color=INK, lw=1.1)
    ax.text(2.65, 0.14, r"$\mu$", fontsize=11)
    _bare(ax, (-1.05, 2.95), (-0.72, 1.0))
    return figure


DRAWINGS = {
    "frame_and_signs": frame_and_signs,
    "accelerometer_signs": accelerometer_signs,
    "six_modes": six_modes,
    "corner_forces": corner_forces,
    "contact_of_elements": contact_of_elements,
}


def make(folder: Path) -> None:
    """Write all drawings that are not there or older than this file."""
    folder.mkdir(exist_ok=True)
    for name, draw in DRAWINGS.items():
        path = folder / f"{name}.svg"
        if not path.exists() or path.stat().st_mtime < Path(__file__).stat().st_mtime:
            figure = draw()
            # Letters as outlines and a white ground: the same on every screen, dark ones too.
            figure.savefig(path, facecolor="white", bbox_inches="tight", metadata={"Date": None})
            plt.close(figure)


def setup(app: Sphinx) -> dict[str, Any]:
    app.connect("builder-inited", lambda app: make(Path(app.srcdir) / "_made"))
    return {"parallel_read_safe": True, "parallel_write_safe": True}


if __name__ == "__main__":
    # For a look without a build: python docs/_ext/sign_drawings.py FOLDER
    import sys

    target = Path(sys.argv[1])
    for name, draw in DRAWINGS.items():
        draw().savefig(target / f"{name}.png", facecolor="white", bbox_inches="tight", dpi=80)
