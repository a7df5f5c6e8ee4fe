#!/usr/bin/python3
"""Labels the components of a file of bytes with scipy.ndimage.label, or with cc3d, to compare SHVR with: voxels at or above a
threshold, joined over faces. Prints one JSON line.

tools/peers/label.py FILE SIDE THRESHOLD [--with scipy|cc3d] [-o LABELS.raw]

Needs Debian's python3-scipy; cc3d is optional and not in Debian.
"""
import argparse
import json
import os
import time

import numpy


def labelled(mask, program):
    if program == "cc3d":
        import cc3d
        return cc3d.connected_components(mask, connectivity=6, return_N=True)
    from scipy import ndimage
    return ndimage.label(mask)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("file")
    parser.add_argument("side", type=int)
    parser.add_argument("threshold", type=int)
    parser.add_argument("--with", dest="program", choices=("scipy", "cc3d"), default="scipy")
    parser.add_argument("-o", dest="output")
    arguments = parser.parse_args()
    labelled(numpy.zeros((2, 2, 2), dtype=bool), arguments.program)  # imports

    begin = time.perf_counter()
    voxels = numpy.fromfile(arguments.file, dtype=numpy.uint8).reshape((arguments.side,) * 3)
    labels, count = labelled(voxels >= arguments.threshold, arguments.program)
    label_seconds = time.perf_counter() - begin
    if arguments.output:
        with open(arguments.output, "wb") as file:
            labels.tofile(file)
            file.flush()
            os.fsync(file.fileno())
    print(json.dumps({"components": int(count), "label_seconds": label_seconds,
                      "seconds": time.perf_counter() - begin}))


if __name__ == "__main__":
    main()
