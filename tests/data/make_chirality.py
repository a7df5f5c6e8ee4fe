#!/usr/bin/env python3
"""Writes the chirality phantom in every format whose voxels lie one after the other:  tests/data/make_chirality.py

5 x 4 x 3 voxels of int16 (the XML side-car: uint8). Voxel x, y, z holds x + 10 y + 100 z - 99, so that any mirrored or
exchanged axis shows. Nothing of the engine is used: the bytes are packed here, from the formats' own descriptions.
"""
import struct
import zlib
from pathlib import Path

FOLDER = Path(__file__).resolve().parent / "chirality"
VALUES = [x + 10 * y + 100 * z - 99 for z in range(3) for y in range(4) for x in range(5)]
LITTLE = struct.pack("<60h", *VALUES)
BIG = struct.pack(">60h", *VALUES)
SLICES = [LITTLE[40 * z:40 * z + 40] for z in range(3)]


def reversed_along(axis):
    """The voxels as a file holds them whose axis runs the other way."""
    size = (5, 4, 3)
    order = [[range(n), range(n - 1, -1, -1)][i == axis] for i, n in enumerate(size)]
    return struct.pack("<60h", *(VALUES[x + 5 * (y + 4 * z)] for z in order[2] for y in order[1] for x in order[0]))


def deflated(data, wrapping):
    """Behind zlib (15) or gzip (31); the same bytes in every year."""
    packer = zlib.compressobj(9, zlib.DEFLATED, wrapping)
    return packer.compress(data) + packer.flush()


def gzip(data):
    return deflated(data, 31)


NRRD = "NRRD0004\n# chirality phantom\ntype: short\ndimension: 3\nsizes: 5 4 3\n{}encoding: raw\n"
DIRECTIONS = "space: left-posterior-superior\nspace directions: (0.5,0,0) (0,0.5,0) (0,0,1.25)\n"
UNITS = 'space units: "mm" "mm" "mm"\n'
PLAIN = 'endian: little\nspacings: 0.5 0.5 1.25\nunits: "mm" "mm" "mm"\n'
GZIP = NRRD.replace("encoding: raw", "encoding: gzip")
# The first voxel of the phantom lies at 10, 20, 30 in each of these.
FLIPPED_Y = ("endian: little\nspace: LPS\nspace directions: (0.5,0,0) (0,-0.5,0) (0,0,1.25)\nspace origin: (10,21.5,30)\n")
LEFT = ("endian: little\nspace: left-anterior-superior\nspace directions: (0.5,0,0) (0,0.5,0) (0,0,1.25)\n"
        "space origin: (-12,20,30)\n")
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

# Columns of the sforms: the phantom lies straight in RAS, its first voxel at 10, 20, 30.
STRAIGHT = ((0.5, 0, 0, 10), (0, 0.5, 0, 20), (0, 0, 1.25, 30))
RADIOLOGICAL = ((-0.5, 0, 0, 12), (0, 0.5, 0, 20), (0, 0, 1.25, 30))  # x runs from right to left, as most scanners write


def nifti(order, magic, offset, sform=None, quaternion=None, qfac=1.0, version=1, slope=0.0, intercept=0.0):
    """A header, filled up to `offset`; `order` is < or >."""
    dim, pixdim = (3, 5, 4, 3, 1, 1, 1, 1), (qfac, 0.5, 0.5, 1.25, 0, 0, 0, 0)
    codes = (1 if quaternion else 0, 1 if sform else 0)
    qform = (*(quaternion or (0, 0, 0)), 10, 20, 30)
    rows = [number for row in sform or ((0,) * 4,) * 3 for number in row]
    if version == 1:
        header = struct.pack(f"{order}i36x8h14xhhh8ffff3xB24x80x24xhh6f12f16x4s", 348, *dim, 4, 16, 0, *pixdim, offset,
                             slope, intercept, 2, *codes, *qform, *rows, magic.encode())
        return header.ljust(int(offset), b"\0")
    header = struct.pack(f"{order}i8shh8q24x8dqdd48x80x24xii6d12d4xii16xB15x", 540, magic.encode() + b"\0\r\n\x1a\n", 4, 16,
                         *dim, *pixdim, offset, slope, intercept, *codes, *qform, *rows, 2, 0, 0)
    return header.ljust(int(offset), b"\0")


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
    "gzip.nrrd": GZIP.format("endian: big\n" + DIRECTIONS + UNITS).encode() + b"\n" + gzip(BIG),
    "gzip.nhdr": GZIP.format(PLAIN).encode() + b"line skip: 1\nbyte skip: 3\ndata file: gzip.voxels\n",
    "gzip.voxels": b"one line\n" + gzip(b"..." + LITTLE),
    "zlib.mha": META.replace("Data = False", "Data = True").format("True", "LOCAL").encode() + deflated(BIG, 15),
    "zlib.mhd": META.replace("Data = False", "Data = True").format("False", "zlib.zraw").encode(),
    "zlib.zraw": deflated(LITTLE, 15),
    **{f"slice{z + 1:02}.voxels": b"head" + SLICES[z] for z in range(3)},
    **{f"slice.{z + 9}.gz": gzip(SLICES[z]) for z in range(3)},
    "pattern.nhdr": NRRD.format(PLAIN).encode() + b"byte skip: 4\ndata file: slice%02d.voxels 1 3 1\n",
    "list.nhdr": NRRD.format(PLAIN).encode() + b"byte skip: -1\ndata file: LIST 2\n"
    + b"".join(b"slice%02d.voxels\n" % z for z in (1, 2, 3)),
    "pattern_gzip.nhdr": GZIP.format(PLAIN).encode() + b"data file: slice.%d.gz 9 11 1 2\n",
    "pattern.mhd": META.format("False", "slice%02d.voxels 1 3 1").replace("DimSize", "HeaderSize = 4\nDimSize").encode(),
    "list.mhd": META.format("False", "LIST\nslice01.voxels\nslice02.voxels\nslice03.voxels")
    .replace("DimSize", "HeaderSize = -1\nDimSize").encode(),
    "flipped_y.nrrd": NRRD.format(FLIPPED_Y + UNITS).encode() + b"\n" + reversed_along(1),
    "left_handed.nrrd": NRRD.format(LEFT + UNITS).encode() + b"\n" + reversed_along(0),
    "flipped_z.mha": META.format("False", "LOCAL").replace("0 0 1\nOffset = 0 0 0", "0 0 -1\nOffset = 10 20 32.5")
    .encode() + reversed_along(2),
    "sform.nii": nifti("<", "n+1", 352, STRAIGHT) + LITTLE,
    "big.nii": nifti(">", "n+1", 352, STRAIGHT) + BIG,
    "gzip.nii.gz": gzip(nifti("<", "n+1", 368, STRAIGHT) + LITTLE),
    "radiological.nii": nifti("<", "n+1", 352, RADIOLOGICAL) + reversed_along(0),
    # Rotated by 180 degrees about y, with z mirrored: only x runs backwards.
    "qform.nii": nifti("<", "n+1", 352, quaternion=(0, 1, 0), qfac=-1.0).replace(
        struct.pack("<f", 10), struct.pack("<f", 12)) + reversed_along(0),
    "pair.hdr": nifti(">", "ni1", 0, STRAIGHT),
    "pair.img": BIG,
    "pair_gzip.hdr.gz": gzip(nifti("<", "ni1", 0, STRAIGHT)),
    "pair_gzip.img.gz": gzip(LITTLE),
    "version2.nii": nifti("<", "n+2", 544, STRAIGHT, version=2) + LITTLE,
    "version2_big.nii": nifti(">", "n+2", 544, quaternion=(0, 0, 0), version=2) + BIG,
}

if __name__ == "__main__":
    FOLDER.mkdir(exist_ok=True)
    for name, content in FILES.items():
        (FOLDER / name).write_bytes(content)
