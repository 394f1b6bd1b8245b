#!/usr/bin/env python3
"""Copies an RGB-D sequence and makes holes in the depth of the copy, in a pattern that a name says.

punch_holes.py PATTERN FROM TO       e.g. punch_holes.py grid:5 scenes/101 /tmp/grid5/101

All files but the depth images (16-bit PNGs in a folder `depth`, or named *.depth.png) become symbolic links. Patterns, with
the number after the colon as n:
  grid:N            every n-th row and column is zero
  rows:N, columns:N every n-th row, column is zero
  keep:N            only every n-th column is left
  dots:N            only every n-th pixel of every n-th row is left
  checkerboard      every second pixel is zero
  blocks:N          of every 2n x 2n pixels, a block of n x n is zero
  diagonal:N        every n-th diagonal is zero
  salt:P            P percent of the pixels are zero, at random
  clusters:P        P percent of the image is covered by holes of 1 to 4 pixels a side, at random
Needs numpy and OpenCV (python3-numpy, python3-opencv).
"""
import pathlib
import sys


def pattern(name, n, rows, columns, rng):
    """Where pixels become zero, as an image of booleans."""
    import numpy as np
    v, u = np.mgrid[0:rows, 0:columns]
    if name == 'clusters':
        mask = np.zeros((rows, columns), bool)
        # A hole has 6.25 pixels on average.
        for _ in range(int(-np.log(1 - n / 100) * rows * columns / 6.25)):
            y, x = rng.integers(0, rows), rng.integers(0, columns)
            mask[y:y + rng.integers(1, 5), x:x + rng.integers(1, 5)] = True
        return mask
    return {
        'grid': lambda: (v % n == 0) | (u % n == 0),
        'rows': lambda: v % n == 0,
        'columns': lambda: u % n == 0,
        'keep': lambda: u % n != 0,
        'dots': lambda: (u % n != 0) | (v % n != 0),
        'checkerboard': lambda: (u + v) % 2 == 0,
        'blocks': lambda: (u // n % 2 == 0) & (v // n % 2 == 0),
        'diagonal': lambda: (u + v) % n == 0,
        'salt': lambda: rng.random((rows, columns)) < n / 100,
    }[name]()


def main():
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    import cv2
    import numpy as np
    name, _, number = sys.argv[1].partition(':')
    source, target = (pathlib.Path(path).resolve() for path in sys.argv[2:])
    rng = np.random.default_rng(1)
    for path in sorted(source.rglob('*')):
        copy = target / path.relative_to(source)
        if path.is_dir():
            copy.mkdir(parents=True, exist_ok=True)
            continue
        copy.parent.mkdir(parents=True, exist_ok=True)
        if path.suffix != '.png' or (path.parent.name != 'depth' and not path.name.endswith('.depth.png')):
            copy.symlink_to(path)
            continue
        depth = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
        depth[pattern(name, int(number or 0), *depth.shape, rng)] = 0
        cv2.imwrite(str(copy), depth)
    intrinsics = source.parent / 'intrinsic'
    if intrinsics.is_dir() and not (target.parent / 'intrinsic').exists():
        (target.parent / 'intrinsic').symlink_to(intrinsics)


if __name__ == '__main__':
    main()
