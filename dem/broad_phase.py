"""Pairs of bodies whose boxes come near each other: a hashed grid, so that the cost grows with the number of bodies.

Source  Ericson, Real-time collision detection (2005), ch. 7 (hashed grids); a pair is met in the cell of the lower left
        corner of what the boxes share, so each is found once
Status  the same pairs as by comparing all (tests)
"""

from __future__ import annotations

import math

import numpy as np

from dem import arrays as q
from dem.compiled import inner


@inner
def _hash(i, k, mask):
    return (i * 73856093 ^ k * 19349663) & mask


@inner
def boxes_of(outline, finite, margin, box):
    """Boxes of the first `finite` bodies, grown by margin: x and z from, x and z to, shape (body, 4)."""
    for b in range(finite):
        low_x, low_z, high_x, high_z = np.inf, np.inf, -np.inf, -np.inf
        for c in range(outline.span[q.FROM, b], outline.span[q.FROM, b] + outline.span[q.COUNT, b]):
            low_x, high_x = min(low_x, outline.place[q.AT_X, c]), max(high_x, outline.place[q.AT_X, c])
            low_z, high_z = min(low_z, outline.place[q.AT_Z, c]), max(high_z, outline.place[q.AT_Z, c])
        box[b, 0], box[b, 1], box[b, 2], box[b, 3] = low_x - margin, low_z - margin, high_x + margin, high_z + margin


@inner
def _overlap(box, a, b):
    return (
        box[a, 0] <= box[b, 2] and box[b, 0] <= box[a, 2] and box[a, 1] <= box[b, 3] and box[b, 1] <= box[a, 3]
    )  # fmt: skip


@inner
def _fill_grid(box, finite, cell, heads, entries):
    """Enter each box in the buckets of the cells it covers; number of entries, or -1 if there is no room."""
    mask = heads.size - 2
    heads[:] = 0
    for turn in range(2):  # count, then place
        for b in range(finite):
            for i in range(math.floor(box[b, 0] / cell), math.floor(box[b, 2] / cell) + 1):
                for k in range(math.floor(box[b, 1] / cell), math.floor(box[b, 3] / cell) + 1):
                    h = _hash(i, k, mask)
                    if turn == 0:
                        heads[h] += 1
                    else:
                        heads[h] -= 1
                        n = heads[h]
                        entries[n, 0], entries[n, 1], entries[n, 2] = b, i, k
        if turn == 0:
            total = 0
            for h in range(heads.size):
                total += heads[h]
                heads[h] = total
            if total > entries.shape[0]:
                return -1
    return heads[heads.size - 1]


@inner
def near_pairs(box, finite, movable, cell, heads, entries, found):
    """Pairs (a < b, a movable) whose boxes overlap, each once, into `found`; their number, or -1 without room.

    heads: int64, shape (2**n + 1,); entries: int64, shape (room, 3); found: int64, shape (room, 2)
    """
    if _fill_grid(box, finite, cell, heads, entries) < 0:
        return -1
    count = 0
    for h in range(heads.size - 1):
        for m in range(heads[h], heads[h + 1]):
            for n in range(heads[h], m):
                a, b = min(entries[m, 0], entries[n, 0]), max(entries[m, 0], entries[n, 0])
                i, k = entries[m, 1], entries[m, 2]
                if a == b or a >= movable or entries[n, 1] != i or entries[n, 2] != k or not _overlap(box, a, b):
                    continue
                low_x, low_z = max(box[a, 0], box[b, 0]), max(box[a, 1], box[b, 1])
                if math.floor(low_x / cell) != i or math.floor(low_z / cell) != k:
                    continue
                if count == found.shape[0]:
                    return -1
                found[count, 0], found[count, 1] = a, b
                count += 1
    return count


@inner
def floor_pairs(box, movable, floor, found, count):
    """Append the pairs of the floor (z = 0) with the bodies near it; their number, or -1 without room."""
    for b in range(movable):
        if box[b, 1] <= 0.0:
            if count == found.shape[0]:
                return -1
            found[count, 0], found[count, 1] = b, floor
            count += 1
    return count


@inner
def in_order(found, count, row, first, second):
    """Sort the pairs by (first, second) into `first`, `second`; row[b]: where those of b begin."""
    row[:] = 0
    for m in range(count):
        row[found[m, 0] + 1] += 1
    for b in range(row.size - 1):
        row[b + 1] += row[b]
    for m in range(count):  # row[a] is the next free place of a, and in the end where a + 1 begins
        a = found[m, 0]
        first[row[a]], second[row[a]] = a, found[m, 1]
        row[a] += 1
    for b in range(row.size - 1, 0, -1):
        row[b] = row[b - 1]
    row[0] = 0
    for b in range(row.size - 1):
        for m in range(row[b] + 1, row[b + 1]):
            value, n = second[m], m
            while n > row[b] and second[n - 1] > value:
                second[n] = second[n - 1]
                n -= 1
            second[n] = value
