#!/usr/bin/env python3
"""Writes TIFFs as other writers lay them out, old ones among them, and libtiff never does:  tests/data/make_tiff_layouts.py

One page of 5 x 4 pixels each, voxel x, y holding x + 10 y + 100; the bilevel ones hold BITS. Nothing but TIFF 6.0's own
description is used (and that of TIFF 4 for what its writers left out).
"""
import struct
from pathlib import Path

FOLDER = Path(__file__).resolve().parent / "tiff_layouts"
GREY = bytes(x + 10 * y + 100 for y in range(4) for x in range(5))
BITS = bytes([0b10100000, 0b01000000, 0b11100000, 0b00010000])  # rows are filled up to a byte
BYTE, SHORT, LONG, RATIONAL = 1, 3, 4, 5
CODES = {BYTE: "B", SHORT: "H", LONG: "I", RATIONAL: "I"}
VOXELS = (LONG, [8])  # they begin behind the header
PAGE = {256: (SHORT, [5]), 257: (SHORT, [4]), 258: (SHORT, [8]), 262: (SHORT, [1]), 273: VOXELS, 278: (SHORT, [4]),
        279: (LONG, [20])}
OLD = {256: (SHORT, [5]), 257: (SHORT, [4]), 273: VOXELS}  # all else has a default: 1 bit, one sample, one strip


def tiff(fields, voxels=GREY, order="<", next_bytes=4):
    """Header, voxels, directory and what does not fit into it. `next_bytes`: how much is there of the last offset."""
    directory_at = 8 + len(voxels)
    values_at = directory_at + 2 + 12 * len(fields) + 4
    directory, values = struct.pack(order + "H", len(fields)), b""
    for tag, (kind, numbers) in sorted(fields.items()):
        packed = struct.pack(f"{order}{len(numbers)}{CODES[kind]}", *numbers)
        if len(packed) > 4:
            packed, values = struct.pack(order + "I", values_at + len(values)), values + packed
        count = len(numbers) // (2 if kind == RATIONAL else 1)
        directory += struct.pack(order + "HHI", tag, kind, count) + packed.ljust(4, b"\0")
    header = (b"II" if order == "<" else b"MM") + struct.pack(order + "HI", 42, directory_at)
    return header + voxels + directory + struct.pack(order + "I", 0)[:next_bytes] + values


def without(*tags):
    return {tag: field for tag, field in PAGE.items() if tag not in tags}


def palette(red, green, blue):
    return {**PAGE, 262: (SHORT, [3]), 320: (SHORT, [*red, *green, *blue])}


RAMP = [257 * i for i in range(256)]
FILES = {
    # Directories
    "directory_cut.tif": tiff(PAGE, next_bytes=0),
    "odd_offset.tif": tiff(PAGE, GREY + b"\0"),
    # Old monochrome writers
    "bilevel_bare.tif": tiff(OLD, BITS),
    "bilevel_bare_big_endian.tif": tiff(OLD, BITS, ">"),
    "bilevel_old_white.tif": tiff({**OLD, 255: (SHORT, [1]), 259: (SHORT, [1]), 262: (SHORT, [0]), 263: (SHORT, [1])}, BITS),
    "bilevel_low_bit_first.tif": tiff({**OLD, 262: (SHORT, [1]), 266: (SHORT, [2])},
                                      bytes(int(f"{row:08b}"[::-1], 2) for row in BITS)),
    "no_byte_counts.tif": tiff(without(279)),
    "no_photometric.tif": tiff(without(262), order=">"),
    "no_rows_per_strip.tif": tiff(without(278)),
    "byte_counts_0.tif": tiff({**PAGE, 279: (LONG, [0])}),
    "byte_counts_too_large.tif": tiff({**PAGE, 279: (LONG, [4000])}),
    "rows_without_end.tif": tiff({**PAGE, 278: (LONG, [0xffffffff])}),
    "sides_in_bytes.tif": tiff({**PAGE, 256: (BYTE, [5]), 257: (BYTE, [4]), 258: (LONG, [8])}),
    "old_subfile.tif": tiff({**PAGE, 255: (SHORT, [2])}),
    "resolution_0.tif": tiff({**PAGE, 282: (RATIONAL, [0, 0]), 283: (RATIONAL, [0, 0])}),
    # Palettes
    "palette_grey.tif": tiff(palette(RAMP, RAMP, RAMP)),
    "palette_grey_of_8_bits.tif": tiff(palette(range(256), range(256), range(256))),
    "palette_inverted.tif": tiff(palette(RAMP[::-1], RAMP[::-1], RAMP[::-1])),
    "palette_colours.tif": tiff(palette(RAMP, RAMP[::-1], RAMP)),
}

if __name__ == "__main__":
    FOLDER.mkdir(exist_ok=True)
    for name, content in FILES.items():
        (FOLDER / name).write_bytes(content)
