#!/usr/bin/env python3
"""Writes tests/data/zarr3: the arrays and images of make_zarr.py as Zarr version 3, and zipped; and what version 3 alone
has:  tests/data/make_zarr3.py

No package of Debian 12 writes version 3: tests/support/zarr3.py does, which shares nothing with the engine. Where a
name is that of a program, the files are laid out as that program lays them out.
"""
import json
import shutil
import struct
import sys
from functools import partial
from pathlib import Path

import numpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import make_zarr as version_2  # noqa: E402
from make_zarr import PHANTOM, half, move, scale, space  # noqa: E402
from zarr3 import codec, crc32c, encode_shard, little, metadata_first, write_array, write_folder, write_group, zip_bytes  # noqa: E402

FOLDER = Path(__file__).resolve().parent / "zarr3"
SPACING = [1.25, 0.5, 0.5]
SHUFFLES = ["noshuffle", "shuffle", "bitshuffle"]
made = []


def keep(name, values):
    """As a folder, and as an archive: stored, deflated, in 64 bits and streamed in turn."""
    write_folder(values, FOLDER / name)
    form = len(made) % 4
    comment = json.dumps({"ome": {"version": "0.5", "zipFile": {"centralDirectory": {"jsonFirst": True}}}}).encode()
    (FOLDER / f"{name}.ozx").write_bytes(
        zip_bytes(values, deflate=form == 1, zip64=form == 2, stream=form == 3, comment=comment if form == 0 else b""))
    made.append(name)


# ---- The arrays of make_zarr.py, again ------------------------------------------------------------------------------


def codec_of(compressor):
    """The codec of version 3 that makes the same bytes."""
    if compressor is None:
        return []
    settings = compressor.get_config()
    name = settings.pop("id")
    if name == "blosc":
        return [codec("blosc", cname=settings["cname"], clevel=settings["clevel"], shuffle=SHUFFLES[settings["shuffle"]],
                      typesize=2, blocksize=0)]
    return [codec({"zlib": "numcodecs.zlib"}.get(name, name), level=settings["level"])]


def json_fill(fill):
    fill = 0 if fill is None else fill
    special = {"nan": "NaN", "inf": "Infinity", "-inf": "-Infinity"}
    return special.get(str(fill), fill)


def array(name, data, chunks=(3, 4, 3), compressor=None, order="C", dimension_separator=".", fill_value=0, filters=None):
    if filters or getattr(compressor, "codec_id", "") == "lz4":
        return  # version 3 has no such codecs
    codecs = [codec("transpose", order=list(range(data.ndim))[::-1])] if order == "F" else []
    codecs.append(codec("bytes", endian="big" if data.dtype.byteorder == ">" else "little"))
    native = data.astype(data.dtype.newbyteorder("="))
    skip = [(0, 0, 1)] if name.startswith("fill_") else []
    keep(name, write_array({}, "", native, chunks, codecs + codec_of(compressor), json_fill(fill_value),
                           codec("default", separator=dimension_separator), skip))


def image_values(axes, levels, transformations, multiscale=None, attributes=None, codecs=None, **more):
    values, datasets = {}, []
    for level, (data, steps) in enumerate(zip(levels, transformations)):
        write_array(values, str(level), data.astype(data.dtype.newbyteorder("=")), [min(side, 4) for side in data.shape],
                    codecs or [little(), codec("zstd", level=0, checksum=False)],
                    dimension_names=[axis["name"] for axis in axes], **more)
        datasets.append({"path": str(level), **({"coordinateTransformations": steps} if steps else {})})
    ome = {"version": "0.5", "multiscales": [{"axes": axes, "datasets": datasets, **(multiscale or {})}],
           **(attributes or {})}
    return write_group(values, "", {"ome": ome})


def image(name, axes, levels, transformations, multiscale=None, attributes=None, version="0.4"):
    if version == "0.4" and "/" not in name:
        keep(name, image_values(axes, levels, transformations, multiscale, attributes))


def repeat_version_2():
    version_2.array, version_2.image, version_2.drop = array, image, lambda name: None
    version_2.make_arrays()
    version_2.make_images(write_series=False)


# ---- Features of version 3 alone ------------------------------------------------------------------------------------

INDEX = [codec("bytes", endian="little"), codec("crc32c")]


def sharded(chunk, inner=None, index=None, **more):
    return codec("sharding_indexed", chunk_shape=list(chunk), codecs=inner or [little(), codec("zstd", level=1)],
                 index_codecs=index or INDEX, **more)


def make_shards():
    """Shards of 4 x 4 x 6 voxels in chunks of 2 x 4 x 3 or, where axes are transposed, the same in their order."""
    shard, chunk = (4, 4, 6), (2, 4, 3)
    keep("shard_end", write_array({}, "", PHANTOM, shard, [sharded(chunk, index_location="end")]))
    keep("shard_start", write_array({}, "", PHANTOM, shard, [sharded(chunk, index_location="start")]))
    keep("shard_usual", write_array({}, "", PHANTOM, shard, [sharded(chunk)]))
    keep("shard_small", write_array({}, "", PHANTOM, (2, 2, 2), [sharded((1, 1, 2), [little()])]))
    keep("shard_index_big", write_array({}, "", PHANTOM, shard, [sharded(chunk, index=[codec("bytes", endian="big")])]))
    keep("shard_checksums", write_array({}, "", PHANTOM, shard, [
        sharded(chunk, [little(), codec("crc32c")], INDEX + [codec("crc32c")], index_location="start")]))
    keep("shard_transposed", write_array({}, "", PHANTOM, shard, [
        codec("transpose", order=[2, 0, 1]), sharded((3, 2, 4), [codec("transpose", order=[1, 2, 0]), little()])]))
    keep("shard_reversed", write_array({}, "", PHANTOM, shard, [sharded(chunk)],
                                       shard=partial(encode_shard, reverse=True, gap=5)))
    flat = numpy.zeros((4, 4, 6), "<i2") + 7
    keep("shard_shared", write_array({}, "", flat, (4, 4, 6), [sharded((2, 2, 3))],
                                     shard=partial(encode_shard, share=True)))
    # The chunks with x below 4 are fill value and have no place in their shard; of x from 4 on there is no shard.
    sparse = PHANTOM.copy()
    sparse[:, :, :2] = -7
    keep("shard_sparse", write_array({}, "", sparse, (4, 4, 4), [sharded((2, 2, 2))], fill=-7, skip=[(0, 0, 1)]))


def make_forms():
    for name, keys in {"keys_default": codec("default"), "keys_short": "default", "keys_v2": codec("v2"),
                       "keys_v2_slash": codec("v2", separator="/")}.items():
        keep(name, write_array({}, "", PHANTOM, (2, 3, 4), [little()], keys=keys))
    zstd = codec("zstd", level=3)
    for name, codecs in {"checksum_after": [little(), zstd, codec("crc32c")],
                         "checksum_before": [little(), codec("crc32c"), zstd],
                         "checksum_alone": [little(), "crc32c"],
                         "transpose_twice": [codec("transpose", order=[1, 2, 0]), codec("transpose", order=[2, 0, 1]),
                                             codec("transpose", order=[2, 1, 0]), little()]}.items():
        keep(name, write_array({}, "", PHANTOM, (2, 3, 4), codecs))
    keep("needless_keys", write_array({}, "", PHANTOM, (2, 3, 4), [little()], note={"must_understand": False},
                                      storage_transformers=[], attributes={"a": 1}, dimension_names=None))
    keep("axes_named", write_array({}, "", PHANTOM.transpose(2, 0, 1)[:, None], (2, 1, 3, 4), [little()],
                                   dimension_names=["X", "c", "z", "y"]))
    keep("short_names", write_array({}, "", (PHANTOM + 100).astype("u1"), (2, 3, 4), ["bytes"]))
    floats = PHANTOM.astype("<f4")
    for name, data, fill in [("hex_nan", floats, "0x7fc00001"), ("hex_number", floats, "0xc0e00000"),
                             ("hex_double", PHANTOM.astype("<f8"), "0x401c000000000000"),
                             ("positive_infinity", floats, "Infinity"), ("null", PHANTOM, None)]:
        keep(f"fills_{name}", write_array({}, "", data, (3, 4, 3), [little()], fill, skip=[(0, 0, 1)]))


def pyramid():
    one = half(PHANTOM)
    return [PHANTOM, one, half(one)], [[scale(*[2 ** level * s for s in SPACING]),
                                        move(*[0.5 * (2 ** level - 1) * s for s in SPACING])] for level in range(3)]


def make_layouts():
    levels, exact = pyramid()
    axes = space("zyx")
    # zarr-python 3 and ngff-zarr: shards, consolidated metadata.
    values = {}
    for level, data in enumerate(levels):
        write_array(values, f"scale{level}/image", data, (4, 4, 4), [sharded((2, 2, 2), [
            little(), codec("zstd", level=0, checksum=False)], index_location="end")], attributes={},
            storage_transformers=[], dimension_names=list("zyx"))
        write_group(values, f"scale{level}", {})
    datasets = [{"path": f"scale{level}/image", "coordinateTransformations": steps} for level, steps in enumerate(exact)]
    inline = {key.removesuffix("/zarr.json"): json.loads(value) for key, value in values.items() if key.endswith(".json")}
    write_group(values, "", {"ome": {"version": "0.5", "multiscales": [
        {"axes": axes, "datasets": datasets, "name": "image", "@type": "ngff:Image"}]}},
        consolidated_metadata={"kind": "inline", "must_understand": False, "metadata": inline})
    keep("layout_ngff_zarr", values)

    # tensorstore: compact, no defaults, blosc.
    values = {}
    blosc = codec("blosc", cname="lz4", clevel=5, shuffle="bitshuffle", typesize=2, blocksize=0)
    for level, data in enumerate(levels):
        write_array(values, f"s{level}", data, (4, 4, 8), [sharded((4, 4, 4), [little(), blosc], index_location="end")],
                    keys=codec("default"), indent=None, dimension_names=list("zyx"))
    datasets = [{"path": f"s{level}", "coordinateTransformations": steps} for level, steps in enumerate(exact)]
    write_group(values, "", {"ome": {"version": "0.5", "multiscales": [{"axes": axes, "datasets": datasets}]}}, indent=None)
    keep("layout_tensorstore", values)

    # bioformats2raw: five axes, images in 0, 1, ..., listed in OME.
    values = {}
    lz4 = codec("blosc", cname="lz4", clevel=5, shuffle="shuffle", typesize=2, blocksize=0)
    five = [{"name": "t", "type": "time"}, {"name": "c", "type": "channel"}, *axes]
    for level, data in enumerate(levels):
        write_array(values, f"0/{level}", data[None, None], (1, 1, 1, 4, 4), [little(), lz4],
                    dimension_names=list("tczyx"))
    datasets = [{"path": str(level), "coordinateTransformations": [scale(1, 1, *steps[0]["scale"]),
                                                                    move(0, 0, *steps[1]["translation"])]}
                for level, steps in enumerate(exact)]
    write_group(values, "0", {"ome": {"version": "0.5", "multiscales": [{"axes": five, "datasets": datasets, "name": ""}],
                                      "omero": {"channels": [{"label": "CT"}]}}})
    write_group(values, "OME", {"ome": {"version": "0.5", "series": ["0"]}})
    values["OME/METADATA.ome.xml"] = b"<OME/>"
    write_group(values, "", {"ome": {"version": "0.5", "bioformats2raw.layout": 3}})
    keep("series", values)


def make_labels():
    levels, exact = pyramid()
    label = {"version": "0.5", "colors": [{"label-value": 3, "rgba": [255, 128, 0, 128]}],
             "properties": [{"label-value": 3, "name": "vessel"}]}
    values = image_values(space("zyx"), levels, exact)
    inner = image_values(space("zyx"), [(PHANTOM > 100).astype("u1") * 3], [exact[0]], attributes={"image-label": label})
    values.update({f"labels/cells/{key}": value for key, value in inner.items()})
    write_group(values, "labels", {"ome": {"version": "0.5", "labels": ["cells"]}})
    keep("with_labels", values)


def make_archives():
    """Archives that are unusual, or wrong."""
    levels, exact = pyramid()
    values = image_values(space("zyx"), levels, exact)
    first = metadata_first(values)
    old = json.loads(values["zarr.json"])
    old["attributes"] = {}

    def keep_zip(name, content):
        (FOLDER / f"zip_{name}").write_bytes(content)
    # zarr-python appends an entry of the same name where attributes change.
    twice = {**values, "zarr.json": [json.dumps(old).encode(), values["zarr.json"]]}
    keep_zip("twice.ozx", zip_bytes(twice, first + ["zarr.json"]))
    climbing = {**values, "../climbed": b"x", "/absolute": b"x", "0/": b""}
    keep_zip("climbing.ozx", zip_bytes(climbing, first + ["../climbed", "/absolute", "0/"]))
    keep_zip("in_a_folder.ozx", zip_bytes({f"scan.zarr/{key}": value for key, value in values.items()}))
    keep_zip("encrypted.ozx", zip_bytes(values, flags=1))
    keep_zip("bzip2.ozx", zip_bytes(values, method=12))
    keep_zip("empty.ozx", zip_bytes({}))
    keep_zip("no_zarr.zip", zip_bytes({"readme.txt": b"hello"}))
    version_2_files = {file.relative_to(FOLDER.parent / "zarr/image_04").as_posix(): file.read_bytes()
                       for file in sorted((FOLDER.parent / "zarr/image_04").rglob("*")) if file.is_file()}
    keep_zip("version_2.zip", zip_bytes(version_2_files, deflate=True))
    both = image_values(space("zyx"), levels[:1], [exact[0]])
    inner = image_values(space("zyx"), levels, exact)
    both = {f"{number}/{key}": value for number in (0, 1) for key, value in inner.items()}
    write_group(both, "", {"ome": {"version": "0.5", "bioformats2raw.layout": 3}})
    keep_zip("two_images.ozx", zip_bytes(both))
    # 4 MiB of zeros where a chunk has 120 bytes; and the same with a directory that says so.
    bomb = write_array({}, "", PHANTOM, (3, 4, 5), [little()])
    bomb["c/0/0/0"] = bytes(1 << 22)
    whole = zip_bytes(bomb, deflate=True)
    keep_zip("bomb.ozx", whole)
    keep_zip("bomb_that_lies.ozx", whole.replace(struct.pack("<I", 1 << 22), struct.pack("<I", 120)))


def make_refused():
    """OME-Zarr of other versions; and attributes where 0.4 has them."""
    levels, exact = pyramid()
    for name, change in {"later": lambda ome: {"ome": {**ome, "version": "0.6"}},
                         "unknown": lambda ome: {"ome": {key: ome[key] for key in ome if key != "version"}},
                         "not_in_ome": lambda ome: ome}.items():
        values = image_values(space("zyx"), levels[:1], [exact[0]])
        document = json.loads(values["zarr.json"])
        document["attributes"] = change(document["attributes"]["ome"])
        values["zarr.json"] = json.dumps(document).encode()
        keep(f"version_{name}", values)


if __name__ == "__main__":
    assert crc32c(b"123456789") == 0xE3069283
    shutil.rmtree(FOLDER, ignore_errors=True)
    FOLDER.mkdir()
    repeat_version_2()
    make_shards()
    make_forms()
    make_layouts()
    make_labels()
    make_archives()
    make_refused()
