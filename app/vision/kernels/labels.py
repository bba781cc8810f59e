"""Connected blobs of marked pixels with their moments, row by row."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.compiled import compiled
from app.vision.kernels.peaks import TILE_COLUMNS, TILE_ROWS, mark_upper_half, room_for_tiles

Array = npt.NDArray[np.float64]
Indices = npt.NDArray[np.int64]
Pixels = npt.NDArray[np.uint8]
Words = npt.NDArray[np.uint64]

MOMENTS = 6
START, END, LABEL = 0, 1, 2
PIXELS_PER_WORD = 8
LAST_BYTE = 56  # bits before it
ONE_PER_BYTE = np.uint64(0x0101010101010101)
FIRST_LABELS = 4096  # room to begin with; it doubles as needed


@compiled("int64(int64[::1], int64)")
def _root(parents: Indices, label: int) -> int:
    """The first label of a blob's; the way there is halved."""
    while parents[label] != label:
        parents[label] = parents[parents[label]]
        label = parents[label]
    return label


@compiled("int64(uint64)")
def _bytes_below(bit: np.uint64) -> int:
    """How many whole bytes of a number lie below a bit: their lowest bits, added up by a product."""
    return int((((bit - np.uint64(1)) & ONE_PER_BYTE) * ONE_PER_BYTE) >> np.uint64(LAST_BYTE))


@compiled("int64(uint64[::1], int64[:, ::1], int64, int64[:, ::1])")
def _find_runs(words: Words, spans: Indices, span_count: int, runs: Indices) -> int:
    """The runs of marked pixels of a row within spans of columns, whole numbers of tiles, written; their number.

    A word holds eight pixels, a byte each, 1 where marked: only pixels that differ from the one before are visited.
    """
    count, one = 0, np.uint64(1)
    for span in range(span_count):
        before, place = np.uint64(0), START
        for word in range(spans[span, START] // PIXELS_PER_WORD, spans[span, END] // PIXELS_PER_WORD):
            changes = words[word] ^ ((words[word] << np.uint64(8)) | before)
            before = words[word] >> np.uint64(LAST_BYTE)
            while changes != 0:
                bit = changes & (~changes + one)
                runs[count, place] = PIXELS_PER_WORD * word + _bytes_below(bit)
                count, place = count + (place == END), END - place
                changes ^= bit
        if place == END:
            runs[count, END] = spans[span, END]
            count += 1
    return count


@compiled("int64(int64[:, ::1], int64, int64[:, ::1], int64, int64[::1], int64)")
def _join(above: Indices, above_count: int, runs: Indices, count: int, parents: Indices, labels: int) -> int:
    """Give each run the label of the runs that it touches above, corners included, or a new one; the labels in use."""
    first = 0
    for run in range(count):
        start, end = runs[run, START], runs[run, END]
        while first < above_count and above[first, END] < start:
            first += 1
        label, other = -1, first
        while other < above_count and above[other, START] <= end:
            root = _root(parents, above[other, LABEL])
            if label < 0:
                label = root
            elif root != label:
                least = min(root, label)
                parents[max(root, label)] = least
                label = least
            other += 1
        if label < 0:
            label = labels
            parents[label] = label
            labels += 1
        runs[run, LABEL] = label
    return labels


@compiled("void(int64[:, ::1], int64, int64, float64[:, ::1])")
def _add_moments(runs: Indices, count: int, y: int, moments: Array) -> None:
    """Add runs of pixels in row ``y`` to the moments of their labels."""
    for run in range(count):
        start, end, label = runs[run, START], runs[run, END], runs[run, LABEL]
        number = float(end - start)
        middle = 0.5 * (start + end - 1)
        moments[label, 0] += number
        moments[label, 1] += number * middle
        moments[label, 2] += number * y
        moments[label, 3] += number * (middle * middle + (number * number - 1.0) / 12.0)
        moments[label, 4] += number * y * y
        moments[label, 5] += number * middle * y


@compiled("int64(uint8[::1], int64[:, ::1])")
def _find_spans(hot: Pixels, spans: Indices) -> int:
    """Spans of columns of pixels, shape (columns, 2), under neighbouring tiles of one row of tiles; their number."""
    count = 0
    for column in range(len(hot)):
        if not hot[column]:
            continue
        if count and spans[count - 1, END] == column * TILE_COLUMNS:
            spans[count - 1, END] += TILE_COLUMNS
        else:
            spans[count, START], spans[count, END] = column * TILE_COLUMNS, (column + 1) * TILE_COLUMNS
            count += 1
    return count


@compiled("float64[:, ::1](float64[:, ::1], int64[::1], int64)")
def _merged(moments: Array, parents: Indices, labels: int) -> Array:
    """Moments of all labels of a blob together, blob by blob."""
    blobs = np.empty(labels, dtype=np.int64)
    found = 0
    for label in range(labels):
        root = _root(parents, label)  # never greater than the label
        if root == label:
            blobs[label] = found
            moments[found] = moments[label]
            found += 1
        else:
            moments[blobs[root]] += moments[label]
    return moments[:found]


@compiled("float64[:, ::1](uint8[:, ::1], uint8[:, ::1], uint8)")
def label_blobs(redness: Pixels, hot: Pixels, floor: np.uint8) -> Array:
    """Moments, shape (N, 6), of the blobs of pixels above half their peak: count, x, y, xx, yy, xy.

    Parameters
    ----------
    redness : ndarray of shape (H, W), uint8
    hot : ndarray of shape (ceil(H / 16), ceil(W / 64)), uint8
        Tiles that can hold marked pixels.
    floor : int
        Least average redness of a marked pixel, grey values.
    """
    height, width = redness.shape
    wide = hot.shape[1] * TILE_COLUMNS
    marked, spans = np.zeros((TILE_ROWS, wide), dtype=np.uint8), np.empty((hot.shape[1], 2), dtype=np.int64)
    words = marked.view(np.uint64)
    above, runs = np.empty((wide, 3), dtype=np.int64), np.empty((wide, 3), dtype=np.int64)
    parents, moments = np.empty(FIRST_LABELS, dtype=np.int64), np.zeros((FIRST_LABELS, MOMENTS))
    above_count, labels, room = 0, 0, room_for_tiles()
    for y in range(height):
        inner = y % TILE_ROWS
        if inner == 0:
            span_count = _find_spans(hot[y // TILE_ROWS], spans)
            for span in range(span_count):
                for left in range(spans[span, START], spans[span, END], TILE_COLUMNS):
                    mark_upper_half(redness, floor, (y, left), room, marked)
            marked[:, width:] = 0
        count = _find_runs(words[inner], spans, span_count, runs)
        while labels + count > len(parents):
            parents = np.concatenate((parents, np.empty(len(parents), dtype=np.int64)))
            moments = np.concatenate((moments, np.zeros(moments.shape)))
        labels = _join(above, above_count, runs, count, parents, labels)
        _add_moments(runs, count, y, moments)
        above, runs, above_count = runs, above, count
    return _merged(moments, parents, labels)
