#!/usr/bin/env python3
"""Writes TIFFs in forms that libtiff does not write:  tests/data/make_tiff.py  (needs Debian's python3-tifffile)

imagej_long_*.tif is the form in which ImageJ keeps stacks above 4 GiB, here small: classic TIFF, one directory, all slices
one after the other. The voxels are those of the chirality phantom (make_chirality.py), as unsigned numbers plus the
offset that ImageJ uses for signed ones.
"""
from pathlib import Path

import numpy
import tifffile

FOLDER = Path(__file__).resolve().parent / "tiff"
Z, Y, X = numpy.mgrid[0:3, 0:4, 0:5]
VALUES = (X + 10 * Y + 100 * Z - 99 + 32768).astype("uint16")
CALIBRATION = {"cf": 0, "c0": -32768.0, "c1": 1.0, "vunit": "Gray Value"}

if __name__ == "__main__":
    FOLDER.mkdir(exist_ok=True)
    for name, order in (("big", ">"), ("little", "<")):
        tifffile.imwrite(FOLDER / f"imagej_long_{name}_endian.tif", VALUES.astype(order + "u2"), byteorder=order,
                         imagej=True, truncate=True, resolution=(2.0, 2.0),
                         metadata={"axes": "ZYX", "spacing": 1.25, "unit": "mm", **CALIBRATION})
