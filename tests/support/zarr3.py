"""Zarr version 3 and zip archives in plain Python, after their specifications alone: a second opinion on the engine's.

https://zarr-specs.readthedocs.io/en/latest/v3/core/, .../codecs/sharding-indexed/, PKWARE's APPNOTE 6.3.10. Values are
kept in a dictionary, key -> bytes. Needs numpy and numcodecs (Debian's python3-numcodecs), for compressors only.
"""
import gzip
import itertools
import json
import struct
import zlib
from pathlib import Path

import numcodecs
import numpy

ABSENT = 2 ** 64 - 1
SHUFFLES = {"noshuffle": 0, "shuffle": 1, "bitshuffle": 2}


def crc32c(data):
    """Bit by bit: slow, and hard to get wrong."""
    crc = 0xFFFFFFFF
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = crc >> 1 ^ (0x82F63B78 if crc & 1 else 0)
    return crc ^ 0xFFFFFFFF


# ---- Codecs ---------------------------------------------------------------------------------------------------------


def codec(name, **configuration):
    return {"name": name, "configuration": configuration} if configuration else {"name": name}


def little(data_type="<u2"):
    return codec("bytes", endian="little")


def name_of(one):
    return one if isinstance(one, str) else one["name"]


def configuration_of(one):
    return {} if isinstance(one, str) else one.get("configuration", {})


def compressor(name, configuration):
    name = name.removeprefix("numcodecs.")
    if name == "gzip":
        return GZip(configuration.get("level", 5))
    if name == "zlib":
        return numcodecs.Zlib(configuration.get("level", 5))
    if name == "zstd":
        return numcodecs.Zstd(configuration.get("level", 0))
    assert name == "blosc", name
    return numcodecs.Blosc(configuration["cname"], configuration["clevel"], SHUFFLES[configuration["shuffle"]],
                           configuration["blocksize"])


class GZip:
    """Without the time, which numcodecs puts into the header."""

    def __init__(self, level):
        self.level = level

    def encode(self, data):
        return gzip.compress(bytes(data), self.level, mtime=0)

    def decode(self, data):
        return gzip.decompress(data)


def with_endian(dtype, configuration):
    return dtype.newbyteorder({"little": "<", "big": ">"}[configuration.get("endian", "little")])


def encode(array, codecs, fill):
    data = array
    for one in codecs:
        name, configuration = name_of(one), configuration_of(one)
        if name == "transpose":
            data = data.transpose(configuration["order"])
        elif name == "bytes":
            data = data.astype(with_endian(data.dtype, configuration)).tobytes("C")
        elif name == "sharding_indexed":
            data = encode_shard(data, configuration, fill)
        elif name == "crc32c":
            data += struct.pack("<I", crc32c(data))
        else:
            # Blosc shuffles elements of the size that its buffer has.
            size = configuration.get("typesize", 1) if name.endswith("blosc") else 1
            data = bytes(compressor(name, configuration).encode(numpy.frombuffer(data, f"V{size}" if size > 1 else "u1")))
    return data


def decode(data, codecs, shape, dtype, fill):
    """`shape` and `dtype` of the array before the first codec."""
    shapes = [tuple(shape)]
    for one in codecs:
        order = configuration_of(one)["order"] if name_of(one) == "transpose" else range(len(shape))
        shapes.append(tuple(shapes[-1][axis] for axis in order))
    for position, one in reversed(list(enumerate(codecs))):
        name, configuration = name_of(one), configuration_of(one)
        if name == "transpose":
            data = data.transpose(numpy.argsort(configuration["order"]))
        elif name == "bytes":
            data = numpy.frombuffer(data, with_endian(dtype, configuration)).reshape(shapes[position]).astype(dtype)
        elif name == "sharding_indexed":
            data = decode_shard(data, configuration, shapes[position], dtype, fill)
        elif name == "crc32c":
            assert struct.unpack("<I", data[-4:])[0] == crc32c(data[:-4]), "a checksum that does not hold"
            data = data[:-4]
        else:
            data = bytes(compressor(name, {"cname": "lz4", "clevel": 1, "shuffle": "shuffle", "blocksize": 0,
                                           **configuration}).decode(data))
    return data


def inner_chunks(shape, chunk):
    for at in itertools.product(*(range(side // part) for side, part in zip(shape, chunk))):
        yield at, tuple(slice(i * part, (i + 1) * part) for i, part in zip(at, chunk))


def equals(array, fill):
    return bool(numpy.all((array == fill) | ((array != array) & (fill != fill))))


def index_bytes(configuration, count):
    return 16 * count + 4 * sum(name_of(one) == "crc32c" for one in configuration["index_codecs"])


def encode_shard(array, configuration, fill, reverse=False, gap=0, share=False):
    """The chunks in their order or in reverse, with unused bytes between them; equal ones stored once, where shared."""
    chunk = configuration["chunk_shape"]
    parts = list(inner_chunks(array.shape, chunk))
    index = numpy.full([side // part for side, part in zip(array.shape, chunk)] + [2], ABSENT, "u8")
    start = configuration.get("index_location", "end") == "start"
    base = index_bytes(configuration, len(parts)) if start else 0
    body, known = b"", {}
    for at, slices in reversed(parts) if reverse else parts:
        if equals(array[slices], fill):
            continue
        encoded = encode(array[slices], configuration["codecs"], fill)
        if not share or encoded not in known:
            body += b"\xee" * gap
            known[encoded] = base + len(body)
            body += encoded
        index[at] = known[encoded], len(encoded)
    stored = encode(index, configuration["index_codecs"], fill)
    assert len(stored) == index_bytes(configuration, len(parts))
    return stored + body if start else body + stored


def decode_shard(data, configuration, shape, dtype, fill):
    chunk = configuration["chunk_shape"]
    counts = [side // part for side, part in zip(shape, chunk)]
    size = index_bytes(configuration, int(numpy.prod(counts)))
    start = configuration.get("index_location", "end") == "start"
    index = decode(data[:size] if start else data[-size:], configuration["index_codecs"], counts + [2],
                   numpy.dtype("u8"), 0)
    array = numpy.full(shape, fill, dtype)
    for at, slices in inner_chunks(shape, chunk):
        offset, length = map(int, index[at])
        if (offset, length) != (ABSENT, ABSENT):
            assert offset + length <= len(data)
            array[slices] = decode(data[offset:offset + length], configuration["codecs"], chunk, dtype, fill)
    return array


# ---- Arrays and groups ----------------------------------------------------------------------------------------------


def key_of(metadata, at):
    encoding = metadata["chunk_key_encoding"]
    prefix = ["c"] if name_of(encoding) == "default" else []
    separator = configuration_of(encoding).get("separator", "/" if prefix else ".")
    return separator.join(prefix + [str(i) for i in at])


def fill_of(metadata):
    dtype, fill = numpy.dtype(metadata["data_type"]), metadata["fill_value"]
    if isinstance(fill, str) and fill.startswith("0x"):
        return numpy.frombuffer(int(fill, 16).to_bytes(dtype.itemsize, "little"), dtype.newbyteorder("<"))[0]
    if isinstance(fill, str):
        return dtype.type({"NaN": "nan", "Infinity": "inf", "-Infinity": "-inf"}[fill])
    return dtype.type(0 if fill is None else fill)


def chunks_of(metadata):
    """Number along each axis, and the part of the array, of every chunk; parts reach beyond the array's end."""
    chunk = metadata["chunk_grid"]["configuration"]["chunk_shape"]
    counts = [-(-side // part) for side, part in zip(metadata["shape"], chunk)]
    for at in itertools.product(*map(range, counts)):
        yield at, tuple(slice(i * part, (i + 1) * part) for i, part in zip(at, chunk))


def write_array(values, path, data, chunk, codecs, fill=0, keys=None, skip=(), shard=None, indent=2, **more):
    """`skip`: chunks that are not stored. `shard`: another way to encode one (encode_shard)."""
    data = numpy.asarray(data)
    metadata = {"zarr_format": 3, "node_type": "array", "shape": list(data.shape), "data_type": data.dtype.name,
                "chunk_grid": codec("regular", chunk_shape=list(chunk)),
                "chunk_key_encoding": keys or codec("default", separator="/"), "codecs": codecs, "fill_value": fill,
                **more}
    prefix = path + "/" if path else ""
    values[prefix + "zarr.json"] = json.dumps(metadata, indent=indent).encode()
    filling = fill_of(metadata)
    for at, slices in chunks_of(metadata):
        part = data[slices]
        whole = numpy.full(chunk, filling, data.dtype.newbyteorder("="))
        whole[tuple(slice(0, side) for side in part.shape)] = part
        if at in skip:
            continue
        values[prefix + key_of(metadata, at)] = (
            shard(whole, codecs[0]["configuration"], filling) if shard else encode(whole, codecs, filling))
    return values


def read_array(values, path=""):
    prefix = path + "/" if path else ""
    metadata = json.loads(values[prefix + "zarr.json"])
    assert (metadata["zarr_format"], metadata["node_type"]) == (3, "array")
    dtype, filling = numpy.dtype(metadata["data_type"]), fill_of(metadata)
    array = numpy.full(metadata["shape"], filling, dtype)
    chunk = metadata["chunk_grid"]["configuration"]["chunk_shape"]
    for at, slices in chunks_of(metadata):
        stored = values.get(prefix + key_of(metadata, at))
        if stored is None:
            continue
        whole = decode(stored, metadata["codecs"], chunk, dtype, filling)
        part = array[slices]
        part[...] = whole[tuple(slice(0, side) for side in part.shape)]
    return array, metadata


def write_group(values, path, attributes, indent=2, **more):
    document = {"attributes": attributes, "zarr_format": 3, "node_type": "group", **more}
    values[(path + "/" if path else "") + "zarr.json"] = json.dumps(document, indent=indent).encode()
    return values


def read_group(values, path=""):
    metadata = json.loads(values[(path + "/" if path else "") + "zarr.json"])
    assert (metadata["zarr_format"], metadata["node_type"]) == (3, "group")
    return metadata.get("attributes", {})


# ---- Where values are kept ------------------------------------------------------------------------------------------


def write_folder(values, folder):
    for key, value in values.items():
        file = Path(folder) / key
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes(value)


def read_folder(folder):
    return {file.relative_to(folder).as_posix(): file.read_bytes() for file in Path(folder).rglob("*")
            if file.is_file()}


def metadata_first(values):
    """As RFC-9 recommends: the root's zarr.json, then the others, breadth first, then the chunks."""
    return sorted(values, key=lambda key: (not key.endswith("zarr.json"), key.count("/"), key))


def zip_bytes(values, names=None, deflate=False, zip64=False, stream=False, comment=b"", flags=0, method=None):
    """`names` may repeat a name. `zip64`: all sizes and offsets in 64 bits. `stream`: sizes follow the entries."""
    out, directory, seen = b"", b"", {}
    names = list(names or metadata_first(values))
    for name in names:
        value = values[name]
        value = value.pop(0) if isinstance(value, list) else value  # one for each time the name occurs
        stored, kind = value, 0
        if deflate:
            packer = zlib.compressobj(9, zlib.DEFLATED, -15)
            stored, kind = packer.compress(value) + packer.flush(), 8
        kind = kind if method is None else method
        crc, at, encoded = zlib.crc32(value), len(out), name.encode()
        bits = flags | (8 if stream else 0)
        sizes = (0xFFFFFFFF, 0xFFFFFFFF) if zip64 else (len(stored), len(value))
        extra = struct.pack("<HHQQ", 1, 16, len(value), len(stored)) if zip64 else b""
        local = (0, 0, 0) if stream else (crc, *sizes)
        out += struct.pack("<IHHHHHIIIHH", 0x04034B50, 45, bits, kind, 0, 33, *local, len(encoded), len(extra))
        out += encoded + extra + stored
        if stream:
            out += struct.pack("<IIQQ" if zip64 else "<IIII", 0x08074B50, crc, len(stored), len(value))
        extra = struct.pack("<HHQQQ", 1, 24, len(value), len(stored), at) if zip64 else b""
        directory += struct.pack("<IHHHHHHIIIHHHHHII", 0x02014B50, 45, 45, bits, kind, 0, 33, crc, *sizes, len(encoded),
                                 len(extra), 0, 0, 0, 0, 0xFFFFFFFF if zip64 else at) + encoded + extra
    at = len(out)
    count, size, offset = len(names), len(directory), at
    out += directory
    if zip64:
        end = len(out)
        out += struct.pack("<IQHHIIQQQQ", 0x06064B50, 44, 45, 45, 0, 0, count, count, size, offset)
        out += struct.pack("<IIQI", 0x07064B50, 0, end, 1)
        count, size, offset = 0xFFFF, 0xFFFFFFFF, 0xFFFFFFFF
    return out + struct.pack("<IHHHHIIH", 0x06054B50, 0, 0, count, count, size, offset, len(comment)) + comment
