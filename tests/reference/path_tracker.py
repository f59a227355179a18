"""The path tracker on a path cut into millimetres."""

import numpy as np


def length_at(path):
    return np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(path, axis=0).T))])


def progress(path, k, s, x, cut):
    """(segment, progress) of x, downhill from segment k and progress s."""
    corner = length_at(path)
    last = len(path) - 2
    while True:
        along = (path[k + 1] - path[k]) / (corner[k + 1] - corner[k])
        t = (x - path[k]) @ along
        s = max(s, corner[k] + np.clip(t, 0.0, corner[k + 1] - corner[k]))
        if k == last:
            return k, s
        near = np.hypot(*(x - path[k + 1])) <= cut
        past = t >= corner[k + 1] - corner[k]
        onward = (x - path[k + 1]) @ (path[k + 2] - path[k + 1]) > 0.0
        if not (near or (past and onward)):
            return k, s
        k += 1
        s = max(s, corner[k])


def target(path, k, s, x, lookahead, cut, step=1e-3):
    """The farthest point of the path whose straight way from x keeps near the corners between.

    k is the segment that progress s is on: corners up to it are passed.
    """
    corner = length_at(path)
    best = None
    for ahead in np.append(np.arange(s, min(s + lookahead, corner[-1]), step), s + lookahead):
        ahead = min(ahead, corner[-1])
        point = np.array([np.interp(ahead, corner, path[:, axis]) for axis in (0, 1)])
        for j in range(k + 1, len(path)):
            if corner[j] > ahead - 1e-12:
                break
            d = point - x
            t = np.clip((path[j] - x) @ d / max(d @ d, 1e-300), 0.0, 1.0)
            if np.hypot(*(x + t * d - path[j])) > cut:
                return best
        best = point
    return best
