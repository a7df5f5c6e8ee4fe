#!/usr/bin/env python3
"""Writes the chirality phantom in every format that holds bare voxels:  tests/data/make_chirality.py

5 x 4 x 3 voxels of int16 (the XML side-car: uint8). Voxel x, y, z holds x + 10 y + 100 z - 99, so that any mirrored or
exchanged axis shows. Nothing of the engine is used: the bytes are packed here, from the formats' own descriptions.
"""
import struct
from pathlib import Path

FOLDER = Path(__file__).resolve().parent / "chirality"
VALUES = [x + 10 * y + 100 * z - 99 for z in range(3) for y in range(4) for x in range(5)]
LITTLE = struct.pack("<60h", *VALUES)
BIG = struct.pack(">60h", *VALUES)

NRRD = "NRRD0004\n# chirality phantom\ntype: short\ndimension: 3\nsizes: 5 4 3\n{}encoding: raw\n"
DIRECTIONS = "space: left-posterior-superior\nspace directions: (0.5,0,0) (0,0.5,0) (0,0,1.25)\n"
UNITS = 'space units: "mm" "mm" "mm"\n'
META = """ObjectType = Image
NDims = 3
BinaryData = True
BinaryDataByteOrderMSB = {}
CompressedData = False
TransformMatrix = 1 0 0 0 1 0 0 0 1
Offset = 0 0 0
ElementSpacing = 0.5 0.5 1.25
DimSize = 5 4 3
ElementType = MET_SHORT
ElementDataFile = {}
"""
JSON = '{"size": [5, 4, 3], "type": "int16", "endian": "big", "offset": 4, "spacing": [0.5, 0.5, 1.25], "unit": "mm"}\n'
NSI = "ObjectFileName: nsi.raw\nResolution:     5 4 3\nSliceThickness: 0.5 0.5 1.25\nFormat:         SHORT\n"

FILES = {
    "attached.nrrd": NRRD.format("endian: big\n" + DIRECTIONS + UNITS).encode() + b"\n" + BIG,
    "detached.nhdr": NRRD.format('endian: little\nspacings: 0.5 0.5 1.25\nunits: "mm" "mm" "mm"\n').encode()
    + b"line skip: 2\nbyte skip: 3\ndata file: detached.voxels\n",
    "detached.voxels": b"two lines\nand three bytes\n..." + LITTLE,
    "tail.nhdr": NRRD.format("endian: big\n" + DIRECTIONS).encode() + b"byte skip: -1\ndata file: tail.voxels\n",
    "tail.voxels": b"a header of unknown length" + BIG,
    "local.mha": META.format("True", "LOCAL").encode() + BIG,
    "detached.mhd": META.format("False", "detached_mhd.voxels").encode(),
    "detached_mhd.voxels": LITTLE,
    "tail.mhd": META.format("True", "tail.voxels").replace("DimSize", "HeaderSize = -1\nDimSize").encode(),
    "side_car.raw": b"skip" + BIG,
    "side_car.json": JSON.encode(),
    "nsi.raw": LITTLE,
    "nsi.dat": NSI.encode(),
    "named_5x4x3_int16le.raw": LITTLE,
}

if __name__ == "__main__":
    FOLDER.mkdir(exist_ok=True)
    for name, content in FILES.items():
        (FOLDER / name).write_bytes(content)
