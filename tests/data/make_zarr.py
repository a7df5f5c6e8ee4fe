#!/usr/bin/env python3
"""Writes the chirality phantom as Zarr arrays and OME-Zarr images:  tests/data/make_zarr.py

Needs Debian's python3-zarr and python3-numcodecs, which wrote every chunk here: nothing of the engine is used. The phantom
is that of make_chirality.py: 5 x 4 x 3 voxels, voxel x, y, z holds x + 10 y + 100 z - 99 (unsigned types: + 1).
"""
import json
import shutil
from pathlib import Path

import numcodecs
import numpy
import zarr

FOLDER = Path(__file__).resolve().parent / "zarr"
Z, Y, X = numpy.mgrid[0:3, 0:4, 0:5]
PHANTOM = (X + 10 * Y + 100 * Z - 99).astype("<i2")

TYPES = ["|u1", "|i1", "<u2", ">u2", "<i2", ">i2", "<u4", ">u4", "<i4", ">i4", "<f4", ">f4", "<f8", ">f8"]
BLOSC = {f"blosc_{name}_{shuffle}": numcodecs.Blosc(name, 5, shuffle)
         for name in ("blosclz", "lz4", "lz4hc", "zlib", "zstd", "snappy") for shuffle in (0, 1, 2)
         if name in numcodecs.blosc.list_compressors()}
COMPRESSORS = {"none": None, "zstd": numcodecs.Zstd(3), "zlib": numcodecs.Zlib(6), "gzip": numcodecs.GZip(6), **BLOSC}


def array(name, data, chunks=(3, 4, 3), **options):
    options.setdefault("compressor", None)
    zarr.create(data.shape, chunks=chunks, dtype=data.dtype, store=zarr.DirectoryStore(str(FOLDER / name)),
                overwrite=True, **options)[...] = data


def drop(name):
    """Removes a chunk, which then is the fill value."""
    (FOLDER / name / "0.0.1").unlink()


def values(data_type):
    """The phantom in a type that may not hold it: as many of its low bits as fit."""
    shift = 1 if data_type[1] == "u" else 0
    return (PHANTOM.astype("i8") + shift).astype(data_type)


def make_arrays():
    for data_type in TYPES:
        byte_order = {"<": "little_", ">": "big_", "|": ""}[data_type[0]]
        array(f"type_{byte_order}{data_type[1:]}", values(data_type), compressor=numcodecs.Zlib(1))
    for name, compressor in COMPRESSORS.items():
        # Blosc leaves small chunks as they are.
        array(f"compressor_{name}", PHANTOM, (8, 16, 16), compressor=compressor)
    array("order_f", PHANTOM, order="F")
    array("slashes", PHANTOM, (2, 3, 4), dimension_separator="/")
    array("dots", PHANTOM, (2, 3, 4))
    for name, chunks in {"one": (1, 1, 1), "whole": (3, 4, 5), "larger": (7, 8, 9)}.items():
        array(f"chunks_{name}", PHANTOM, chunks)
    array("leading_axes", PHANTOM[None, None], (1, 1, 2, 3, 4))
    array("delta_filter", PHANTOM, filters=[numcodecs.Delta("<i2")])
    array("lz4_alone", PHANTOM, compressor=numcodecs.LZ4())

    # A chunk that is not there is the fill value.
    for name, data, fill in [("fill_number", PHANTOM, -7), ("fill_null", PHANTOM, None),
                             ("fill_nan", PHANTOM.astype("<f4"), float("nan")),
                             ("fill_infinity", PHANTOM.astype(">f8"), float("-inf"))]:
        array(name, data, fill_value=fill)
        drop(name)


def image(name, axes, levels, transformations, multiscale=None, attributes=None, version="0.4"):
    group = zarr.group(store=zarr.DirectoryStore(str(FOLDER / name)), overwrite=True)
    datasets = []
    for level, (data, steps) in enumerate(zip(levels, transformations)):
        chunks = tuple(min(side, 4) for side in data.shape)
        zarr.create(data.shape, chunks=chunks, dtype=data.dtype, store=zarr.NestedDirectoryStore(
            str(FOLDER / name / str(level))), overwrite=True, compressor=numcodecs.Zlib(1))[...] = data
        datasets.append({"path": str(level), **({"coordinateTransformations": steps} if steps else {})})
    entry = {"version": version, "name": name, "datasets": datasets, **(multiscale or {})}
    if axes is not None:
        entry["axes"] = axes
    group.attrs.put({"multiscales": [entry], **(attributes or {})})


def space(names, unit="millimeter"):
    return [{"name": name, "type": "space", "unit": unit} for name in names]


def scale(*numbers):
    return {"type": "scale", "scale": list(numbers)}


def move(*numbers):
    return {"type": "translation", "translation": list(numbers)}


def half(data):
    """Mean of the voxels there are in 2 x 2 x 2, ties to even."""
    size = [(side + 1) // 2 for side in data.shape]
    result = numpy.zeros(size, data.dtype)
    for at in numpy.ndindex(*size):
        block = data[tuple(slice(2 * i, 2 * i + 2) for i in at)]
        result[at] = numpy.round(block.astype("f8").mean())
    return result


def make_images(write_series=True):
    one = half(PHANTOM)
    two = half(one)
    spacing = [1.25, 0.5, 0.5]
    exact = [[scale(*[2 ** level * s for s in spacing]), move(*[0.5 * (2 ** level - 1) * s for s in spacing])]
             for level in range(3)]
    image("image_04", space("zyx"), [PHANTOM, one, two], exact)
    image("image_no_translations", space("zyx"), [PHANTOM, one], [[steps[0]] for steps in exact[:2]])
    image("image_floor", space("zyx"), [PHANTOM, one[:1, :2, :2]], exact[:2])
    image("image_off_by_half", space("zyx"), [PHANTOM, one],
          [exact[0], [exact[1][0], move(-0.625, -0.25, -0.25)]])
    image("image_flat_levels", space("zyx"), [PHANTOM, PHANTOM[:, ::2, ::2]], [[scale(*spacing)], [scale(1.25, 1, 1)]])
    image("image_group_scale", space("zyx"), [PHANTOM, one], [[scale(1, 1, 1)], [scale(2, 2, 2), move(.5, .5, .5)]],
          {"coordinateTransformations": [scale(*spacing), move(10.0, 20.0, 30.0)]})
    image("image_axes_xzy", space("xzy"), [PHANTOM.transpose(2, 0, 1)], [[scale(0.5, 1.25, 0.5)]])
    image("image_mixed_units", [{"name": "z", "type": "space", "unit": "micrometer"},
                                {"name": "y", "type": "space", "unit": "millimeter"},
                                {"name": "x", "type": "space", "unit": "millimeter"}],
          [PHANTOM], [[scale(1250, 0.5, 0.5)]])
    image("image_2d", space("yx"), [PHANTOM[0]], [[scale(1, 1)]])

    several = numpy.stack([numpy.stack([PHANTOM + 1000 * t + 500 * c for c in range(3)]) for t in range(2)])
    axes = [{"name": "t", "type": "time"}, {"name": "c", "type": "channel"}] + space("zyx")
    image("image_tczyx", axes, [several.astype("<i2")], [[scale(1, 1, *spacing)]],
          attributes={"omero": {"channels": [{"label": "DAPI"}, {"label": "GFP"}, {}]}})
    image("image_03", ["c", "z", "y", "x"], [PHANTOM[None]], [None], version="0.3")
    image("image_01", None, [PHANTOM[None, None]], [None], version="0.1")
    image("image_05", space("zyx"), [PHANTOM], [[scale(*spacing)]], version="0.5")
    if not write_series:
        return
    zarr.group(store=zarr.DirectoryStore(str(FOLDER / "series")), overwrite=True).attrs.put(
        {"bioformats2raw.layout": 3})
    image("series/0", space("zyx"), [PHANTOM], [[scale(*spacing)]])

    three = FOLDER / "version_3"
    three.mkdir()
    (three / "zarr.json").write_text(json.dumps({"zarr_format": 3, "node_type": "group"}) + "\n")


if __name__ == "__main__":
    shutil.rmtree(FOLDER, ignore_errors=True)
    FOLDER.mkdir()
    make_arrays()
    make_images()
