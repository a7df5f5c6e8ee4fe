#!/usr/bin/env python3
"""Writes tests/fuzz/seeds:  SHVR=build/dev/shvr tests/fuzz/make_seeds.py

Needs Debian's libtiff-tools (tiffcp) for TIFFs that are compressed, and the built program for a project. Seeds not made
here, mostly regressions, are kept: they have other names. A seed named "claims_..." claims to be far larger than it is.
"""
import json
import os
import struct
import subprocess
import tempfile
import zlib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SEEDS = ROOT / "tests/fuzz/seeds"
CHIRALITY = ROOT / "tests/data/chirality"
ZARR = ROOT / "tests/data/zarr"
ZARR3 = ROOT / "tests/data/zarr3"


def seed(target, name, *files):
    """Bytes, or (name, bytes) for a file beside the main one."""
    content = b""
    for file in files:
        name_inside, data = file if isinstance(file, tuple) else (None, file)
        if name_inside:
            content += (b"\n" if content else b"") + b"@@FILE " + name_inside.encode() + b"\n"
        content += data.encode() if isinstance(data, str) else data
    path = SEEDS / target / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(content)


def phantom(name):
    return (name, (CHIRALITY / name).read_bytes())


# ---- Headers and voxels ---------------------------------------------------------------------------------------------

PARTS = ["slice01.voxels", "slice02.voxels", "slice03.voxels"]
NRRD = {"attached.nrrd": [], "detached.nhdr": ["detached.voxels"], "tail.nhdr": ["tail.voxels"], "gzip.nrrd": [],
        "gzip.nhdr": ["gzip.voxels"], "pattern.nhdr": PARTS, "list.nhdr": PARTS,
        "pattern_gzip.nhdr": ["slice.9.gz", "slice.10.gz", "slice.11.gz"], "flipped_y.nrrd": [],
        "left_handed.nrrd": []}
MHD = {"local.mha": [], "detached.mhd": ["detached_mhd.voxels"], "tail.mhd": ["tail.voxels"], "zlib.mha": [],
       "zlib.mhd": ["zlib.zraw"], "pattern.mhd": PARTS, "list.mhd": PARTS, "flipped_z.mha": []}
NIFTI = {"sform.nii": [], "qform.nii": [], "radiological.nii": [], "big.nii": [], "version2.nii": [],
         "version2_big.nii": [], "gzip.nii.gz": []}
HUGE = "1048576 1048576 1048576"


def make_headers():
    for target, headers in {"nrrd": NRRD, "mhd": MHD, "nifti": NIFTI}.items():
        for name, others in headers.items():
            seed(target, name, phantom(name)[1], *(phantom(other) for other in others))
    seed("nifti", "pair.hdr", phantom("pair.hdr")[1], ("scan.img", phantom("pair.img")[1]))
    seed("nifti", "pair_gzip.hdr", phantom("pair_gzip.hdr.gz")[1], ("scan.img.gz", phantom("pair_gzip.img.gz")[1]))

    nrrd = "NRRD0005\ntype: {}\ndimension: {}\nsizes: {}\nendian: little\nencoding: {}\n"
    seed("nrrd", "rgb_frames.nrrd", nrrd.format("uchar", 5, "3 5 4 1 2", "raw") + "kinds: RGB-color domain domain domain time\n\n" + "v" * 120)
    seed("nrrd", "line_skip.nhdr", nrrd.format("uchar", 3, "5 4 3", "raw") + "line skip: 2\nbyte skip: 3\n"
         "key:=value\nspace: RAS\nspace directions: (0,1,0) (1,0,0) (0,0,2)\nspace origin: (1,2,3)\n"
         "space units: \"um\" \"um\" \"um\"\ndata file: a.voxels\n", ("a.voxels", "a\nb\nccc" + "v" * 60))
    seed("nrrd", "claims_raw", nrrd.format("double", 3, HUGE, "raw") + "\n" + "v" * 60)
    seed("nrrd", "claims_gzip", nrrd.format("double", 3, "1048576 1048576 1", "gzip").encode() + b"\n" +
         zlib.compress(b"v" * 60, wbits=31))
    seed("nrrd", "claims_axes", nrrd.format("uchar", 1000000, "1 1 1", "raw") + "\n" + "v" * 60)
    seed("nrrd", "missing_parts", nrrd.format("uchar", 3, "5 4 500", "raw") + "data file: a%d.voxels 1 500 1\n")
    seed("nrrd", "claims_skip", nrrd.format("uchar", 3, "5 4 3", "gzip") + "byte skip: 9223372036854775800\n\n" +
         "v" * 60)
    mhd = "ObjectType = Image\nNDims = 3\nBinaryData = True\nCompressedData = {}\nElementSpacing = 1 2 3\nDimSize = {}\nElementType = {}\n"
    seed("mhd", "channels.mha", mhd.format("False", "5 4 2", "MET_UCHAR") + "ElementNumberOfChannels = 3\n"
         "ElementDataFile = LOCAL\n" + "v" * 120)
    seed("mhd", "claims_raw", mhd.format("False", HUGE, "MET_DOUBLE") + "ElementDataFile = LOCAL\n" + "v" * 60)
    seed("mhd", "claims_zlib", (mhd.format("True", "1048576 1048576 1", "MET_DOUBLE") + "ElementDataFile = LOCAL\n").encode() +
         zlib.compress(b"v" * 60))
    seed("mhd", "claims_channels", mhd.format("False", "5 4 3", "MET_UCHAR") +
         "ElementNumberOfChannels = 1000000000000\nElementDataFile = LOCAL\n" + "v" * 60)
    nifti = bytearray(phantom("sform.nii")[1])
    nifti[42:48] = struct.pack("<3h", 32767, 32767, 32767)
    seed("nifti", "claims_raw", bytes(nifti))
    seed("nifti", "claims_gzip", zlib.compress(bytes(nifti), wbits=31))
    nifti = bytearray(phantom("version2.nii")[1])
    nifti[24:48] = struct.pack("<3q", 1 << 20, 1 << 20, 1 << 20)
    seed("nifti", "claims_version2", bytes(nifti))
    nifti = bytearray(phantom("sform.nii")[1])
    nifti[108:112] = struct.pack("<f", 9e18)
    seed("nifti", "claims_offset", bytes(nifti))


def make_raw():
    raw = ("scan.raw", phantom("side_car.raw")[1])
    seed("raw_side_car", "own.json", phantom("side_car.json")[1], raw)
    seed("raw_side_car", "nsi.dat", phantom("nsi.dat")[1].replace(b"nsi.raw", b"scan.raw"), raw)
    seed("raw_side_car", "inviwo.dat", "Rawfile: scan.raw\nResolution: 5 4 3\nFormat: USHORT\nByteOffset: 4\n"
         "ByteOrder: BigEndian\nBasisVector1: 1 0 0\nBasisVector2: 0 1 0\nBasisVector3: 0 0 1\nUnit: mm\n", raw)
    seed("raw_side_car", "dragonfly.dat", '<?xml version="1.0"?>\n<RAWFileData>\n<Version>0.0</Version>\n'
         '<ObjectFileName>scan.raw</ObjectFileName>\n<Format>SHORT</Format>\n<DataSlope>1</DataSlope>\n'
         '<Resolution X="5" Y="4" Z="3" T="1"/>\n<Spacing X="0.001" Y="0.001" Z="0.002"/>\n'
         '<Orientation X0="1" X1="0" X2="0" Y0="0" Y1="1" Y2="0" Z0="0" Z1="0" Z2="-1"/>\n</RAWFileData>\n', raw)
    seed("raw_side_car", "claims_json", '{"size": [1048576, 1048576, 1048576], "type": "float64"}', raw)
    seed("raw_side_car", "claims_offset", '{"size": [5, 4, 3], "type": "uint8", "offset": 9223372036854775807}', raw)
    seed("raw_side_car", "claims_nsi", "Resolution: 1048576 1048576 1048576\nFormat: DOUBLE\nObjectFileName: scan.raw\n",
         raw)
    seed("raw_side_car", "scanner.vgi", "{volume1}\n[representation]\nsize = 5 4 3\ndatatype = unsigned integer\n"
         "bitsperelement = 16\n[file1]\nRegionOfInterestStart = 0 0 0\nFileFormat = raw\nSize = 5 4 3\n"
         "Name = C:\\scans\\scan.raw\nDatatype = unsigned integer\nBitsPerElement = 16\n{volumeprimitive12}\n"
         "[geometry]\nresolution = 0.02 0.02 0.03\nunit = mm\n", raw)
    seed("raw_side_car", "scanner.xtekct", "[XTekCT]\nName=scan\nVoxelsX=5\nVoxelSizeX=0.025\nVoxelsY=4\n"
         "VoxelSizeY=0.025\nVoxelsZ=3\nVoxelSizeZ=0.025\n", raw)
    seed("raw_side_car", "scanner.info", "! PyHST_SLAVE VOLUME INFO FILE\nNUM_X =  5\nNUM_Y =  4\nNUM_Z =  3\n"
         "voxelSize =  1.4\nBYTEORDER = HIGHBYTEFIRST\n", ("scan.raw", "v" * 240))
    seed("raw_side_car", "claims_vgi", "{volume1}\n[file1]\nFileFormat = raw\nSize = 1048576 1048576 1048576\n"
         "Name = scan.raw\nDatatype = float\nBitsPerElement = 32\n", raw)
    for name in ["named_5x4x3_int16le.raw", "scan_5x4x3_16bit.raw", "scan_5x4x6.raw", "5x4x3x2.raw", "head.1"]:
        seed("raw_name", name, name)
    for number, text in enumerate(["5x4x3:int16:big:0", "5x4x3:uint8", "3x4x5:int16:0", "2x2x2:float64:little:8"]):
        seed("raw_name", f"layout_{number}", text)
    seed("raw_name", "claims_name", "scan_1048576x1048576x1048576_float64.raw")
    seed("raw_name", "claims_layout", "1048576x1048576x1048576:float64")
    seed("raw_name", "claims_offset", "5x4x3:uint8:9223372036854775807")


# ---- TIFF -----------------------------------------------------------------------------------------------------------


def tiff(pages, big=False, order="<"):
    """pages: dicts of tag -> value or list; tag "data": list of strips (or tiles)."""
    word, word_type = ("Q", 16) if big else ("I", 4)
    sizes = {2: 1, 3: 2, 4: 4, 5: 8, 16: 8}
    out = bytearray(b"II" if order == "<" else b"MM")
    out += struct.pack(order + ("HHHQ" if big else "HI"), *((43, 8, 0, 0) if big else (42, 0)))
    link = 8 if big else 4
    for page in pages:
        strips = page["data"]
        offsets = []
        for strip in strips:
            offsets.append(len(out))
            out += strip
        tiles = 322 in page
        fields = {tag: value for tag, value in page.items() if tag != "data"}
        fields.setdefault(324 if tiles else 273, (word_type, offsets))
        fields.setdefault(325 if tiles else 279, (word_type, [len(strip) for strip in strips]))
        entries = b""
        for tag, value in sorted(fields.items()):
            kind, values = value if isinstance(value, tuple) else (3, value if isinstance(value, list) else [value])
            if kind == 2:
                data, count = values, len(values)
            elif kind == 5:
                data, count = b"".join(struct.pack(order + "II", *pair) for pair in values), len(values)
            else:
                letter = {3: "H", 4: "I", 16: "Q"}[kind]
                data, count = struct.pack(order + letter * len(values), *values), len(values)
            assert len(data) == count * sizes[kind]
            if len(data) > (8 if big else 4):
                at = len(out)
                out += data
                data = struct.pack(order + word, at)
            entries += struct.pack(order + "HH" + word, tag, kind, count) + data.ljust(8 if big else 4, b"\0")
        directory = len(out)
        out += struct.pack(order + ("Q" if big else "H"), len(fields)) + entries
        out[link:link + (8 if big else 4)] = struct.pack(order + word, directory)
        link = len(out)
        out += struct.pack(order + word, 0)
    return bytes(out)


def page(z=0, width=5, height=4, bits=16, order="<", **more):
    samples = [x + 10 * y + 100 * z for y in range(height) for x in range(width)]
    letter = {8: "B", 16: "H", 32: "I"}[bits]
    data = struct.pack(order + letter * len(samples), *(value & (1 << bits) - 1 for value in samples))
    fields = {256: width, 257: height, 258: bits, 259: 1, 262: 1, 277: 1, 278: height, "data": [data]}
    return fields | {int(tag[1:]): value for tag, value in more.items() if tag != "data"} | \
        {key: value for key, value in more.items() if key == "data"}


def ome(attributes, inside=""):
    text = ('<?xml version="1.0" encoding="UTF-8"?><OME xmlns="http://www.openmicroscopy.org/Schemas/OME/2016-06">'
            '<Image ID="Image:0"><Pixels ID="Pixels:0" Type="uint16" SizeX="5" SizeY="4" ' + attributes + ">" + inside +
            "</Pixels></Image></OME>")
    return (2, text.encode() + b"\0")


def tiffcp(source, *options):
    with tempfile.TemporaryDirectory() as folder:
        before, after = Path(folder) / "a.tif", Path(folder) / "b.tif"
        before.write_bytes(source)
        subprocess.run(["tiffcp", *options, before, after], check=True)
        return after.read_bytes()


def make_tiff():
    three = [page(z) for z in range(3)]
    resolution = {"_282": (5, [(20, 1)]), "_283": (5, [(20, 1)]), "_296": 3}
    imagej = (2, b"ImageJ=1.53k\nimages=3\nslices=3\nunit=mm\nspacing=1.25\nloop=false\n\0")
    channels = (2, b"ImageJ=1.53k\nimages=4\nchannels=2\nslices=2\nhyperstack=true\nmode=grayscale\n\0")
    plain = tiff(three)
    files = {
        "plain": plain,
        "big_endian": tiff([page(z, order=">") for z in range(3)], order=">"),
        "bigtiff": tiff(three, big=True),
        "bigtiff_big_endian": tiff([page(z, order=">") for z in range(3)], big=True, order=">"),
        "imagej": tiff([page(0, _270=imagej, **resolution), page(1), page(2)]),
        "imagej_channels": tiff([page(0, _270=channels), page(1), page(2), page(3)]),
        "ome": tiff([page(0, _270=ome('SizeZ="3" SizeC="1" SizeT="1" DimensionOrder="XYZCT" PhysicalSizeX="0.5" '
                                      'PhysicalSizeXUnit="mm" PhysicalSizeZ="1.25"', '<TiffData IFD="0" PlaneCount="3"/>')),
                     page(1), page(2)]),
        "ome_channels": tiff([page(0, _270=ome('SizeZ="1" SizeC="3" SizeT="1" DimensionOrder="XYCZT"',
                                               '<Channel ID="Channel:0" Name="red dye"/>')), page(1), page(2)]),
        "signed": tiff([page(z, _339=2) for z in range(2)]),
        "float": tiff([page(z, bits=32, _339=3) for z in range(2)]),
        "rgb": tiff([page(0, bits=8, _258=[8, 8, 8], _262=2, _277=3, data=[bytes(range(60))])]),
        "planar": tiff([page(0, bits=8, _258=[8, 8, 8], _262=2, _277=3, _284=2, data=[bytes(range(20))] * 3)]),
        "palette": tiff([page(0, bits=8, _262=3, _320=[i * 256 for i in range(256)] * 3)]),
        "minimum_is_white": tiff([page(0, bits=8, _262=0)]),
        "bits_12": tiff([page(0, _258=12, data=[bytes(32)])]),
        "bit": tiff([page(0, _258=1, data=[b"\xa8\x50\xa8\x50"])]),
        "strips": tiff([page(0, _278=1, data=[struct.pack("<5H", *range(y, y + 5)) for y in range(4)])]),
        "tiles": tiff([page(0, bits=8, _322=16, _323=16, data=[bytes(256)])]),
        "thumbnail": tiff([page(0), page(0, width=2, height=2, _254=(4, [1])), page(1)]),
        "deflate": tiff([page(0, _259=8, data=[zlib.compress(bytes(40))])]),
        "packbits": tiff([page(0, _259=32773, data=[b"\xd9\0"])]),
        "rotated": tiff([page(z, _274=3) for z in range(2)]),
    }
    for name in ["lzw", "lzw:2", "zip:2", "packbits", "zstd", "lzma"]:
        files[name.replace(":", "_predictor_")] = tiffcp(plain, "-c", name)
    floats = tiff([page(z, bits=32, _339=3) for z in range(2)])
    files["zip_predictor_3"] = tiffcp(floats, "-c", "zip:3")
    files["jpeg"] = tiffcp(tiff([page(0, width=16, height=16, bits=8)]), "-c", "jpeg")
    files["tiled_lzw"] = tiffcp(plain, "-t", "-w", "16", "-l", "16", "-c", "lzw")
    files["fax"] = tiffcp(tiff([page(0, _258=1, data=[b"\xa8\x50\xa8\x50"])]), "-c", "g4")
    for name in ["imagej_long_big_endian", "imagej_long_little_endian"]:
        files[name] = (ROOT / f"tests/data/tiff/{name}.tif").read_bytes()
    wide = (4, [1 << 20])
    files["claims_side"] = tiff([page(0, _256=wide, _257=wide, _278=wide)])
    files["claims_deflate"] = tiff([page(0, _256=wide, _257=wide, _278=wide, _259=8, data=[zlib.compress(bytes(40))])])
    files["claims_tile"] = tiff([page(0, _322=(4, [1 << 20]), _323=(4, [1 << 20]), _259=8,
                                      data=[zlib.compress(bytes(40))])])
    files["claims_samples"] = tiff([page(0, _277=65535)])
    files["claims_offset"] = tiff([page(0, _273=(4, [0xfffffff0]))])
    files["claims_imagej"] = tiff([page(0, _270=(2, b"ImageJ=1.53k\nimages=1000000\nslices=1000000\n\0"))])
    files["claims_ome"] = tiff([page(0, _270=ome('SizeZ="1048576" SizeC="1" SizeT="1" DimensionOrder="XYZCT"'))])
    loop = bytearray(plain)
    loop[-4:] = plain[4:8]
    files["loop"] = bytes(loop)
    for name, content in files.items():
        seed("tiff", name, content)
    slices = [(f"slice{z}.tif", tiff([page(z, **resolution)])) for z in (1, 2, 10)]
    seed("slices", "three", *slices)
    seed("slices", "two_sizes", *slices, ("slice3.tif", tiff([page(0, width=6)])))
    seed("slices", "bare", plain)
    seed("slices", "series", *((f"s{z}_c{c}.tif", tiff([page(z)])) for z in range(2) for c in range(2)))
    seed("slices", "claims_side", files["claims_side"])
    seed("slices", "lzw", files["lzw"])


# ---- DICOM ----------------------------------------------------------------------------------------------------------


class Dicom:
    def __init__(self, syntax="1.2.840.10008.1.2.1"):
        self.syntax, self.elements = syntax, {}

    def text(self, tag, kind, value):
        value = value.encode()
        self.elements[tag] = (kind, value + (b"\0" if kind == "UI" else b" ") * (len(value) % 2))
        return self

    def numbers(self, **values):
        for tag, value in values.items():
            self.elements[int(tag[1:], 16)] = ("US", struct.pack("<H", value))
        return self

    def element(self, tag, kind, value, explicit=True):
        start = struct.pack("<HH", tag >> 16, tag & 0xffff)
        length = 0xffffffff if value.startswith(b"\xfe\xff\x00\xe0") and tag == 0x7fe00010 else len(value)
        if not explicit:
            return start + struct.pack("<I", length) + value
        if kind in ("OW", "OB", "SQ", "UN"):
            return start + kind.encode() + b"\0\0" + struct.pack("<I", length) + value
        return start + kind.encode() + struct.pack("<H", length) + value

    def file(self):
        meta = b"".join(self.element(tag, "UI", value + b"\0" * (len(value) % 2)) for tag, value in
                        [(0x20002, b"1.2.840.10008.5.1.4.1.1.2"), (0x20003, b"1.2.3"), (0x20010, self.syntax.encode())])
        body = b"".join(self.element(tag, *value, self.syntax != "1.2.840.10008.1.2")
                        for tag, value in sorted(self.elements.items()))
        return bytes(128) + b"DICM" + self.element(0x20000, "UL", struct.pack("<I", len(meta))) + meta + body


def dicom_slice(z, syntax="1.2.840.10008.1.2.1", pixels=None):
    dicom = Dicom(syntax)
    dicom.text(0x00080016, "UI", "1.2.840.10008.5.1.4.1.1.2").text(0x00080018, "UI", f"1.2.3.{z + 1}")
    dicom.text(0x00080060, "CS", "CT").text(0x0020000d, "UI", "1.2.8").text(0x0020000e, "UI", "1.2.9")
    dicom.text(0x00200013, "IS", str(z + 1)).text(0x00280004, "CS", "MONOCHROME2")
    dicom.text(0x00200032, "DS", f"10\\20\\{30 + 1.25 * z}").text(0x00200037, "DS", "1\\0\\0\\0\\1\\0")
    dicom.text(0x00280030, "DS", "0.5\\0.5").text(0x00281052, "DS", "-1024").text(0x00281053, "DS", "1")
    dicom.numbers(_00280002=1, _00280010=4, _00280011=5, _00280100=16, _00280101=16, _00280102=15, _00280103=1)
    dicom.elements[0x7fe00010] = ("OW", pixels or struct.pack("<20h", *range(20)))
    return dicom


def item(data):
    return b"\xfe\xff\x00\xe0" + struct.pack("<I", len(data)) + data


def make_dicom():
    seed("dicom", "one", dicom_slice(0).file())
    seed("dicom", "implicit", dicom_slice(0, "1.2.840.10008.1.2").file())
    seed("dicom", "no_preamble", dicom_slice(0).file()[132:])
    seed("dicom", "three", *((f"{z}.dcm", dicom_slice(z).file()) for z in range(3)))
    frames = dicom_slice(0, pixels=struct.pack("<60h", *range(60))).text(0x00280008, "IS", "3")
    frames.text(0x00180050, "DS", "1.25")
    seed("dicom", "frames", frames.file())
    rle = struct.pack("<16I", 2, 64, 66, *[0] * 13) + b"\xed\0" + b"\xed\1"
    encapsulated = item(b"") + item(rle) + b"\xfe\xff\xdd\xe0\0\0\0\0"
    coded = dicom_slice(0, "1.2.840.10008.1.2.5", encapsulated)
    coded.elements[0x7fe00010] = ("OB", encapsulated)
    seed("dicom", "rle", coded.file())
    deflated = dicom_slice(0, "1.2.840.10008.1.2.4.50", item(b"") + item(b"\xff\xd8\xff\xd9") + b"\xfe\xff\xdd\xe0\0\0\0\0")
    deflated.elements[0x7fe00010] = ("OB", deflated.elements[0x7fe00010][1])
    seed("dicom", "jpeg", deflated.file())
    seed("dicom", "claims_rows", dicom_slice(0).numbers(_00280010=65535, _00280011=65535).file())
    seed("dicom", "claims_frames", dicom_slice(0).text(0x00280008, "IS", "2147483647").file())
    whole = bytearray(dicom_slice(0).file())
    whole[-44:-40] = struct.pack("<I", 0x7ffffff0)
    seed("dicom", "claims_length", bytes(whole))
    whole = bytearray(coded.file())
    at = whole.rindex(item(rle)[:8])
    whole[at + 4:at + 8] = struct.pack("<I", 0x7ffffff0)
    seed("dicom", "claims_fragment", bytes(whole))


# ---- Slices as pictures ---------------------------------------------------------------------------------------------


def png_slice(width, height, rows, bits=8, kind=0, palette=b"", interlaced=0):
    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, bits, kind, 0, 0, interlaced)) +
            (chunk(b"PLTE", palette) if palette else b"") +
            chunk(b"IDAT", zlib.compress(b"".join(b"\0" + row for row in rows))) + chunk(b"IEND", b""))


def bmp_slice(width, bits, palette, rows):
    pixels = b"".join(row + bytes(-len(row) % 4) for row in reversed(rows))
    offset = 54 + len(palette)
    return (b"BM" + struct.pack("<IIIIiiHHIIIIII", offset + len(pixels), 0, offset, 40, width, len(rows), 1, bits, 0,
                                len(pixels), 0, 0, len(palette) // 4, 0) + palette + pixels)


def jpeg_slice(width, height, scan=b"\x3f"):
    """One grey block of 8 x 8 pixels, of code lengths 1: no difference, end of block."""
    table = b"\1" + bytes(15) + b"\0"
    return (b"\xff\xd8\xff\xdb\0\x43\0" + b"\1" * 64 + b"\xff\xc0\0\x0b\x08" + struct.pack(">HH", height, width) +
            b"\1\1\x11\0" + b"\xff\xc4\0\x14\0" + table + b"\xff\xc4\0\x14\x10" + table +
            b"\xff\xda\0\x08\1\1\0\0\x3f\0" + scan + b"\xff\xd9")


def make_pictures():
    rows = [bytes(range(10 * y, 10 * y + 5)) for y in range(4)]
    wide = [bytes(range(10 * y, 10 * y + 10)) for y in range(4)]
    grey = b"".join(bytes([i, i, i, 0]) for i in range(64))
    seed("slices", "grey.png", png_slice(5, 4, rows))
    seed("slices", "sixteen.png", png_slice(5, 4, wide, bits=16))
    seed("slices", "one_bit.png", png_slice(5, 4, [bytes([0xa8])] * 4, bits=1))
    seed("slices", "palette.png", png_slice(5, 4, rows, kind=3, palette=bytes(range(192))))
    seed("slices", "alpha.png", png_slice(5, 4, wide, kind=4))
    seed("slices", "color.png", png_slice(1, 4, [row[:3] for row in rows], kind=2))
    seed("slices", "interlaced.png", png_slice(1, 1, [b"a"], interlaced=1))
    seed("slices", "grey.bmp", bmp_slice(5, 8, grey, rows))
    seed("slices", "color.bmp", bmp_slice(1, 24, b"", [row[:3] for row in rows]))
    seed("slices", "grey.jpg", jpeg_slice(8, 8))
    seed("slices", "folder", ("scan_8.5.png", png_slice(5, 4, rows)), ("scan_9.0.png", png_slice(5, 4, rows)),
         ("scan_spr.png", png_slice(1, 1, [b"a"])), ("scan.log", "[Reconstruction]\nPixel Size (um)=17.5\n"
                                               "Section to Section Step=2\nResult Image Width (pixels)=5\n"))
    seed("slices", "claims_png", png_slice(1 << 20, 1 << 20, rows))
    seed("slices", "claims_interlaced", png_slice(20000, 20000, rows, interlaced=1))
    seed("slices", "claims_bmp", bmp_slice(1 << 20, 8, grey, rows))
    seed("slices", "claims_jpeg", jpeg_slice(65535, 65535))


# ---- Zarr and projects ----------------------------------------------------------------------------------------------


# ---- Journals -------------------------------------------------------------------------------------------------------

def number(value):
    out = b""
    while value > 127:
        out += bytes([value % 128 + 128])
        value //= 128
    return out + bytes([value])


def record(kind, content=b"", about=0):
    return struct.pack("<BBH", kind, about, len(content)) + content


def make_journals():
    STATE, COMMAND, EXTENSION, UNDO, REDO, SAVING, SAVED, LATER = 2, 3, 4, 5, 6, 7, 8, 200
    mask = bytes([1]) + number(1) + number(2) + bytes([3, 4, 0, 7]) + number(200) + bytes([1, 0, 8])
    more = bytes([1]) + number(1) + number(1) + bytes([3, 2, 7, 0])
    density = bytes([2]) + number(0) + number(1) + bytes([9, 0]) + struct.pack("<ii", 0, 60)
    node = lambda n, x: bytes([3]) + number(n) + bytes([2]) + struct.pack("<dddd", x, 2, 3, 1.5) + bytes([1])
    link = bytes([4]) + number(0) + bytes([2]) + number(0) + number(1) + bytes([1])
    size = bytes([5]) + number(1) + bytes([2]) + struct.pack("<d", 0.5)
    selects = bytes([6]) + number(0) + number(0) + number(1) + number(1) + number(0)
    nothing = number(0) + number(0)
    files = bytes(27)
    seed("journal", "paints", b"\1" + record(COMMAND, mask) + record(EXTENSION, more) + record(UNDO) + record(REDO))
    seed("journal", "traces", b"\1" + record(COMMAND, node(0, 1.0) + node(1, 5.0) + link + size + selects) +
         record(UNDO) + record(COMMAND, density))
    seed("journal", "states", b"\1" + record(COMMAND, mask) + record(STATE, nothing + mask, 2) + record(COMMAND, density) +
         record(SAVING) + record(SAVED, files) + record(UNDO) + record(UNDO) + record(LATER, b"later"))
    seed("journal", "does_not_fit", b"\1" + record(COMMAND, mask) + record(COMMAND, mask) + record(UNDO))
    header = b"SHVRJRNL" + struct.pack("<II", 1, 0)
    seed("journal", "length_beyond_the_end", b"\0" + header + struct.pack("<IHHQQQQ", 1, 0, 0, 1 << 60, 1 << 60, 0, 0) + bytes(64))
    with tempfile.TemporaryDirectory() as folder:
        session, script = Path(folder, "a.json"), Path(folder, "a.jsonl")
        session.write_text(json.dumps({"shvr_session": 1, "volume": {"procedural": "sphere", "size": [40, 24, 24]},
                                       "annotation": {"mask": "a.mask", "density": "a.offset"}}))
        brush = {"brush": "fill", "threshold": 0, "radius": 4, "path": [[12, 12, 12], [30, 12, 12]]}
        script.write_text("\n".join(json.dumps(line) for line in [
            {"op": "paint", "group": 3, **brush}, {"op": "density", "offset": 20, "falloff": "distance", **brush},
            {"op": "node", "at": [3, 4, 5]}, {"op": "node", "at": [9, 4, 5]}, {"op": "save"}, {"op": "undo", "count": 2}]))
        subprocess.run([os.environ["SHVR"], "annotate", session, "--script", script, "--quiet"], check=True)
        seed("journal", "version_1", b"\0" + Path(folder, "a.journal").read_bytes())
    seed("journal", "runs_beyond_the_end", b"\1" + record(COMMAND, bytes([1]) + number(0) + number(1 << 40)))


def packed(folder):
    return [(str(file.relative_to(folder)), file.read_bytes()) for file in sorted(folder.rglob("*")) if file.is_file()]


def zarray(**changes):
    metadata = {"chunks": [3, 4, 5], "compressor": None, "dtype": "|u1", "fill_value": 0, "filters": None, "order": "C",
                "shape": [3, 4, 5], "zarr_format": 2} | changes
    return json.dumps(metadata)


def make_zarr():
    for name in ["type_u1", "type_big_i2", "type_big_f8", "type_little_f4", "order_f", "slashes", "fill_nan",
                 "chunks_larger", "leading_axes", "compressor_blosc_lz4_1", "compressor_blosc_zstd_2",
                 "compressor_blosc_zlib_0", "compressor_blosc_blosclz_1", "compressor_gzip", "compressor_zlib",
                 "compressor_zstd", "delta_filter", "version_3", "image_01", "image_04", "image_05", "image_2d",
                 "image_axes_xzy", "image_floor", "image_group_scale", "image_mixed_units", "image_tczyx", "series"]:
        seed("zarr", name, *packed(ZARR / name))
    blosc = {"id": "blosc", "cname": "lz4", "clevel": 5, "shuffle": 1, "blocksize": 0}
    # The header claims that this chunk unpacks to two gigabytes.
    header = struct.pack("<BBBBIII", 2, 1, 0x21, 1, 0x7fffffff, 0x7fffffff, 64) + bytes(48)
    seed("zarr", "claims_blosc", (".zarray", zarray(compressor=blosc, shape=[1 << 20, 1 << 20, 1 << 20],
                                                    chunks=[1 << 20, 1 << 20, 1 << 20])), ("0.0.0", header))
    seed("zarr", "blosc_says_more", (".zarray", zarray(compressor=blosc)), ("0.0.0", header))
    seed("zarr", "claims_chunk", (".zarray", zarray(chunks=[1 << 20, 1 << 20, 1 << 20], shape=[1 << 20] * 3)),
         ("0.0.0", "v"))
    seed("zarr", "claims_axes", (".zarray", zarray(chunks=[1] * 2000, shape=[1] * 2000)))
    for name, compressor in {"zlib": {"id": "zlib", "level": 1}, "gzip": {"id": "gzip", "level": 1}}.items():
        bomb = zlib.compress(bytes(1 << 22), 9, 31 if name == "gzip" else 15)
        seed("zarr", f"bomb_{name}", (".zarray", zarray(compressor=compressor)), ("0.0.0", bomb))
    seed("zarr", "sparse", (".zarray", zarray(shape=[1 << 20] * 3, chunks=[64, 64, 64])))


def make_zarr3():
    for name in ["type_u1", "type_big_i2", "order_f", "dots", "slashes", "fill_nan", "chunks_larger", "leading_axes",
                 "compressor_zlib", "compressor_gzip", "shard_start", "shard_sparse", "shard_transposed",
                 "shard_checksums", "keys_v2", "checksum_before", "checksum_after", "transpose_twice", "needless_keys",
                 "short_names", "fills_hex_nan", "fills_hex_double", "image_04", "image_tczyx", "layout_ngff_zarr",
                 "layout_tensorstore", "series", "version_later", "version_not_in_ome"]:
        seed("zarr3", name, *packed(ZARR3 / name))
    whole = json.loads((ZARR3 / "shard_end" / "zarr.json").read_text())
    grid, sharding = whole["chunk_grid"]["configuration"], whole["codecs"][0]["configuration"]
    whole["shape"] = [1 << 20] * 3
    for name, shard, chunk in {("index_says_more", (1 << 11, 1 << 11, 1), (1, 1, 1)),
                               ("claims_chunk", (1 << 20, 1 << 20, 1 << 20), (1 << 20, 1 << 20, 1 << 20)),
                               ("claims_shard", (1 << 20, 1 << 20, 1 << 20), (64, 64, 64))}:
        grid["chunk_shape"], sharding["chunk_shape"] = list(shard), list(chunk)
        seed("zarr3", name, ("zarr.json", json.dumps(whole)), ("c/0/0/0", "v" * 60))

    def index(*entries, order="<"):
        return b"".join(struct.pack(order + "QQ", *entry) for entry in entries) + bytes(4)
    none = (2 ** 64 - 1, 2 ** 64 - 1)
    seed("zarr_shard", "plain", b"\0" + bytes(range(32)) + index((0, 16), (16, 16), *[none] * 6))
    seed("zarr_shard", "first", b"\1" + index((132, 16), *[none] * 7) + bytes(range(16)))
    seed("zarr_shard", "first_big", b"\3" + index((132, 16), *[none] * 7, order=">") + bytes(range(16)))
    seed("zarr_shard", "big", b"\2" + bytes(range(32)) + index((0, 16), (16, 16), *[none] * 6, order=">"))
    seed("zarr_shard", "unsigned", b"\4" + bytes(range(32)) + index((0, 16), *[none] * 7))
    packed_chunk = zlib.compress(bytes(range(16)), wbits=31)
    seed("zarr_shard", "gzip", b"\x18" + packed_chunk + index((0, len(packed_chunk)), *[none] * 7))
    seed("zarr_shard", "shared", b"\0" + bytes(range(32)) + index(*[(0, 16)] * 7, (8, 16)))
    seed("zarr_shard", "far", b"\0" + bytes(16) + index((1 << 62, 1 << 62), (0, 1 << 40), *[none] * 6))


def make_remote_store():
    """Servers: what they have, and before that what they answer instead (remote_store.cpp)."""
    for name in ["image_04", "type_u1", "series", "chunks_larger", "claims"]:
        if name == "claims":
            whole = [(".zarray", zarray(shape=[1 << 20] * 3, chunks=[1 << 20] * 3)), ("0.0.0", "v")]
            seed("remote_store", "claims_chunk", *whole)
        else:
            seed("remote_store", name, *packed(ZARR / name))
    for name in ["shard_start", "shard_sparse", "image_tczyx"]:
        seed("remote_store", f"v3_{name}", *packed(ZARR3 / name))
    shard = packed(ZARR3 / "shard_sparse")
    chunk = next(name for name, _ in shard if name.startswith("c/"))
    answers = {
        "refuses": f"{chunk} 403 - - -\n", "hides": f"{chunk} 404 - - -\n", "redirects": f"{chunk} 302 - - - ../zarr.json\n",
        "leads_in_circles": f"{chunk} 307 - - - {chunk}\n", "leads_elsewhere": f"{chunk} 301 - - - file:///etc/passwd\n",
        "is_unreached": f"{chunk} 0 - - - unreached\n", "breaks_off": f"{chunk} 0 - - - -\n", "is_busy": f"{chunk} 503 - - -\n",
        "sends_other_parts": f"{chunk} 206 7 - -\n", "states_too_much": f"{chunk} 206 - 9223372036854775807 -\n",
        "states_too_little": f"{chunk} 206 - 1 -\n", "states_less_than_nothing": f"{chunk} 206 -5 -7 -\n",
        "says_unchanged": f"{chunk} 304 - - \"1\"\n", "sends_all": f"{chunk} 200 - - -\n",
        "has_no_metadata": "zarr.json 403 - - -\n.zattrs 403 - - -\n"}
    for name, lines in answers.items():
        seed("remote_store", name, lines.rstrip("\n"), *shard)


def make_ozx():
    for name in ["image_04", "image_group_scale", "image_floor", "image_flat_levels", "shard_end", "shard_start",
                 "shard_small", "series", "zip_twice", "zip_climbing", "zip_two_images", "zip_encrypted", "zip_bzip2",
                 "zip_empty", "zip_bomb", "zip_bomb_that_lies", "zip_in_a_folder"]:
        seed("ozx", name, (ZARR3 / f"{name}.ozx").read_bytes())
    whole = (ZARR3 / "image_04.ozx").read_bytes()
    end = whole.rfind(b"PK\5\6")
    seed("ozx", "claims_entries", whole[:end + 8] + b"\xff" * 4 + whole[end + 12:])
    entry = whole.find(b"PK\1\2")
    seed("ozx", "claims_bytes", whole[:entry + 20] + b"\xf0\xff\xff\x7f" * 2 + whole[entry + 28:])


def frame_of(claimed_bytes):
    """The beginning of a zstd frame, which states the unpacked size."""
    return b"\x28\xb5\x2f\xfd\xe0" + struct.pack("<Q", claimed_bytes)


def make_states():
    seed("import_state", "written", b"wone and another")
    seed("import_state", "empty", b"w")
    for name, claimed in {"claims_state": 1 << 39, "claims_memory": 1 << 30}.items():
        seed("import_state", name, b"SHVRIMP1" + struct.pack("<QQ", claimed, 0) + frame_of(claimed))
    # The table of brick ranges of this volume takes two gigabytes.
    side = 1 << 15
    table = (b"SHVRTAB1" + b"ranges\0\0" + struct.pack("<iI3qQQ", 0, 2, *[side // 32] * 3, 13, 0) + frame_of(1 << 31))
    record = {"shvr_volume": 1, "source": "", "preparation": "", "size": [side] * 3, "type": "uint8",
              "spacing": [1, 1, 1], "unit": "um", "directions": [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
              "origin": [0, 0, 0], "frame": "", "levels": 1, "content_hash": "0",
              "statistics": {"min": 0, "max": 1, "mean": 0, "not_finite": 0, "histogram": [0] * 256}, "warnings": []}
    attributes = {"multiscales": [{"version": "0.4", "axes": [{"name": axis, "type": "space", "unit": "micrometer"}
                                                              for axis in "zyx"],
                                   "datasets": [{"path": "0", "coordinateTransformations": [
                                       {"type": "scale", "scale": [1, 1, 1]}]}]}]}
    seed("zarr", "huge_table", (".zgroup", '{"zarr_format": 2}'), (".zattrs", json.dumps(attributes)),
         ("0/.zarray", zarray(shape=[side] * 3, chunks=[64, 64, 64])), ("shvr/volume.json", json.dumps(record)),
         ("shvr/ranges-0", table), ("shvr/session.json", "{}"))


def make_label_looks():
    colors = [{"label-value": 1, "rgba": [255, 0, 8, 255]}, {"label-value": 255, "rgba": [1, 2, 3, 0]},
              {"label-value": 300, "rgba": [9, 9, 9, 9]}]
    properties = [{"label-value": 2, "name": "phloem \u00fc", "area": 12.5}, {"label-value": 1, "name": ""}]
    image = {"version": "0.4", "colors": colors, "properties": properties, "source": {"image": "../../"}}
    for name, content in {
            "both": image, "colors": {"colors": colors}, "properties": {"properties": properties}, "empty": {},
            "twice": {"colors": colors[:1] * 2}, "not_lists": {"colors": {}, "properties": "x"},
            "not_entries": {"colors": [1, {"label-value": 1.5, "rgba": [0, 0, 0]}, {"rgba": [256, -1, 0, 0]}],
                            "properties": [{"label-value": "1", "name": 5}]}}.items():
        seed("label_looks", name, json.dumps({"image-label": content}))
    seed("label_looks", "no_image", "{}")
    header = ["NRRD0005", "# made elsewhere", "Segment3_LabelValue:=1", "Segment3_Tags:=a\\\\b|", "content: a root"]
    seed("label_looks", "header", json.dumps({"image-label": {}, "shvr": {"shvr_mask": 1, "nrrd_header": header}}))


def make_project():
    with tempfile.TemporaryDirectory() as folder:
        project = Path(folder) / "p"
        voxels = Path(folder) / "scan_40x36x3_uint8.raw"
        voxels.write_bytes(bytes((x * 5 + x // 40 * 3) % 251 for x in range(40 * 36 * 3)))
        subprocess.run([os.environ.get("SHVR", ROOT / "build/dev/shvr"), "import", voxels, project, "--quiet"],
                       check=True)
        files = packed(project)
        files = [(name, data.replace(folder.encode(), b"/data") if name.endswith(".json") else data)
                 for name, data in files]
        seed("zarr", "project", *files)
        for name, data in files:
            if name.startswith("shvr/ranges") or name.startswith("shvr/checksums") or name == "shvr/volume.json":
                seed("project_table", name.split("/")[1], data)
    return files


# ---- Text -----------------------------------------------------------------------------------------------------------


def make_text():
    for name in ["stent", "cranium"]:
        seed("session", name, (ROOT / f"assets/examples/{name}.session.json").read_bytes())
        script = (ROOT / f"assets/examples/{name}.jsonl").read_bytes().splitlines(True)
        seed("script", name, b"".join(script[:6])[:1500].rsplit(b"\n", 1)[0] + b"\n")
    text = (ROOT / "tests/unit/session/session_test.cpp").read_text(encoding="utf-8")
    begin = text.index("EVERYTHING = R\"(") + len("EVERYTHING = R\"(")
    seed("session", "everything", text[begin:text.index(")\"", begin)])
    seed("session", "controls", '{"shvr_session": 1, "volume": {"path": "scan_5x4x3_int16.ra\x7f", "unit": "\\u001b[31m"}}')
    seed("session", "beside", '{"shvr_session": 1, "volume": {"path": "scan_5x4x3_int16.raw"}}')
    seed("script", "every_operation", "".join(line + "\n" for line in [
        "// every operation", "",
        '{"op":"paint","brush":"fill","region":"box","group":255,"threshold":-1.5,"radius":3,"path":[[1,2,3]]}',
        '{"op":"paint","brush":"speckle","connectivity":26,"group":0,"threshold":7,"radius":127.5,"path":[[1,2,3],[4,5,6.5]]}',
        '{"op":"undo","count":2}', '{"op":"redo"}', '{"op":"expect","voxels":{"1":20}}', '{"op":"save"}']))
    seed("script", "only_unpainted", "".join(line + "\n" for line in [
        '{"op":"paint","brush":"fill","group":3,"only_unpainted":true,"threshold":1,"radius":3,"path":[[1,2,3]]}',
        '{"op":"density","brush":"flood","group":3,"only_unpainted":false,"threshold":1,"radius":3,"path":[[1,2,3]]}',
        '{"op":"paint","brush":"fill","group":0,"only_unpainted":true,"threshold":1,"radius":3,"path":[[1,2,3]]}']))
    seed("script", "claims_stroke", '{"op":"paint","group":1,"threshold":1,"radius":1,"path":[[0,0,0],[1e300,1e300,1e300]]}')
    for name, lines in {
            "render": ["render.size=[64,48]", "render.size.0=32", "render.step_voxels=0.25", "render.background=#10203040"],
            "points": ['transfer_function.points=[{"intensity":1,"opacity":0.5},{"intensity":2,"opacity":1}]',
                       "transfer_function.points.1.color=#ff0000", "light.direction.2=4", "top"],
            "camera": ['cameras.far={"projection":"perspective","eye":[1.5,-400,0.1],"target":[1,2,3],"up":[0,0.1,1]}',
                       "camera=far", '{"side":"left","zoom":1.5,"turn_degrees":30,"tilt_degrees":-20}']}.items():
        seed("setting", name, "\n".join(lines))
    for kind in ["constant", "ramp", "sphere", "marschner_lobb", "tubes", "speckles", "fog", "checker", "chirality"]:
        seed("procedural", kind, f'{{"procedural": "{kind}", "size": [9, 8, 7], "type": "uint16", "seed": 3}}')
        seed("procedural", kind + "_huge",
             f'{{"procedural": "{kind}", "size": [1048576, 1048576, 1048576], "type": "int8", "spacing": [1, 2, 1e-12]}}')
    for file in sorted((ROOT / "assets/devices").glob("*.json")):
        seed("hid_profile", file.stem, file.read_bytes())
    place = '{"inverse3":[{"device_id":"049D","state":{"cursor_position":{"x":0.01,"y":-1.2e-1,"z":0.15}}}]}'
    event = '{"name":"device-safety-triggered","data":{"device_id":"049D","safety_type":"ebrake_triggered"},"message":"\\u00e9"}'
    grip = ('{"inverse3":[],"wireless_verse_grip":[{"device_id":"1","state":{"orientation":{"w":1,"x":0,"y":0,"z":0},'
            '"buttons":{"a":true,"b":false}}}],"session_id":7,"x":[null,[1,-2.5e3],{}]}')

    def frame(text, first=0x81):
        data = text.encode()
        size = bytes([len(data)]) if len(data) < 126 else b"\x7e" + struct.pack(">H", len(data))
        return bytes([first]) + size + data
    for name, text in {"state": place, "event": event, "grip": grip}.items():
        seed("inverse3", name, frame(text))
    seed("inverse3", "parts", frame(place[:40], 0x01) + frame("hi", 0x89) + frame(place[40:], 0x80))
    seed("inverse3", "handshake", "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\n"
         "Sec-WebSocket-Accept: s3pPLMBiTxaQ9kYGzzhZRbK+xOo=\r\n\r\n")
    seed("inverse3", "claims_size", b"\x81\x7f" + struct.pack(">Q", 1 << 62) + b"{")
    seed("hid_recording", "touch", '{"format":"shvr_hid_reports","version":1,"vendor":"0x2988","product":"0x0304",'
         '"name":"Touch","descriptor":"0600ff"}\n{"t_us":0,"bytes":"01a3ff"}\n{"t_us":1000,"bytes":"01a4ff"}\n')
    for sides in [(5, 4, 3), (33, 32, 2), (64, 1, 1)]:
        voxels = sides[0] * sides[1] * sides[2]
        seed("mask", "x".join(map(str, sides)), bytes(side - 1 for side in sides) +
             bytes((i // 7 % 3) for i in range(voxels)))
    seed("mask", "claims_size", bytes([63, 63, 63]) + b"\1" * 60)
    for number, letter in enumerate("hhiiiiff"):
        values = [0, 1, -1, 100, -100, 0, 0, 5] * 3
        seed("offset", f"type_{number}", bytes([4 - 1, 3 - 1, 2 - 1, number]) + struct.pack(f"<24{letter}", *values))
    seed("offset", "claims_size", bytes([63, 63, 63, 7]) + b"\1" * 60)


def png(kind, depth, width=3, height=2, lines=None, extra=b"", claimed=None):
    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
    channels = {0: 1, 2: 3, 3: 1, 4: 2, 6: 4}[kind]
    row = b"\0" + bytes(range((width * channels * depth + 7) // 8))
    sides = claimed or (width, height)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", *sides, depth, kind, 0, 0, 0)) + extra +
            (chunk(b"PLTE", bytes(range(48))) if kind == 3 else b"") +
            chunk(b"IDAT", zlib.compress(lines or row * height)) + chunk(b"IEND", b""))


def make_trace():
    """The first byte names the form."""
    keys = "".join(f'<key id="{k}" for="all" attr.name="{k}" attr.type="string"/>' for k in
                   ["x", "y", "z", "radius", "group", "unit", "size", "spacing", "internode_radii", "next_node"])

    def graph(*inside):
        return b"\0" + f"<graphml>{keys}<graph>{''.join(inside)}</graph></graphml>".encode()

    def data(**values):
        return "".join(f'<data key="{k}">{v}</data>' for k, v in values.items())

    def node(name, x):
        return f'<node id="{name}">{data(x=x, y=2.5, z=-3e-7, radius=1.5, group=7)}</node>'
    seed("trace", "ring.graphml", graph(
        data(unit="um", size="9 8 7", spacing="1 0.5 2", internode_radii="7=1.5 8=2", next_node=12),
        node("n0", 1), node("n3", 2), node("n9", 3), '<edge id="e1" source="n0" target="n3"/>',
        f'<edge id="e5" source="n3" target="n9">{data(group=8)}</edge>', '<edge id="e7" source="n9" target="n0"/>'))
    seed("trace", "names.graphml", graph(node("a", 1), node("b", 2), '<edge source="b" target="a"/>'))
    seed("trace", "two.txt", b"\1-v 1, 2.5, -3, 7, 1.5\n-v 2,3,4,0,0\n-l 1, 0, 255\n")
    seed("trace", "star.swc", b"\2# unit um\n# size 9 8 7\n# spacing 1 0.5 2\n# SCALE 1 1 1\n"
         b"1 7 1 2 3 1.5 -1\n2 7 1 2 4 1.5 1\n3 8 1 3 3 1 1\n4 0 0 2 3 0 1\n9 1 5 5 5 2 -1\n")
    place = b"# space physical\n# frame LPS\n# origin -10.5 20 1e3\n# directions -1 0 0 0 -1 0 0 0 1\n"
    seed("trace", "physical.swc", b"\2" + place + b"# unit um\n# size 9 8 7\n# spacing 1 0.5 2\n"
         b"1 1 -11 20.25 1001 1 -1\n2 1 -12.25 19.1 1003 1 1\n")
    seed("trace", "physical.txt", b"\1" + place + b"# spacing 1 0.5 2\n-v -11, 20.25, 1001, 1, 1\n")
    seed("trace", "flat.txt", b"\1# space physical\n# origin 0 0 0\n# directions 1 0 0 1 1e-5 0 0 0 1\n"
         b"# spacing 1 1 1\n-v 1, 2, 3, 1, 1\n")
    seed("trace", "far.txt", b"\1# space physical\n# origin -1e15 0 0\n# directions 1 0 0 0 1 0 0 0 1\n"
         b"# spacing 1 1 1\n-v 9e14, 2, 3, 1, 1\n")
    seed("trace", "ring.swc", b"\2" + b"1 1 0 0 0 1 3\n2 1 1 0 0 1 1\n3 1 1 1 0 1 2\n")
    seed("trace", "branches.rsml", b"\3<rsml><metadata><unit>um</unit><resolution>2</resolution></metadata><scene><plant>"
         b"<root ID='1'><properties><group>3</group></properties><geometry><polyline><point x='1' y='2' z='3'/>"
         b"<point x='2' y='2'/></polyline></geometry><functions><function name='diameter' domain='polyline'>"
         b"<sample value='4'/><sample>2</sample></function></functions><root><geometry><polyline><point x='2' y='2'/>"
         b"<point x='2' y='5'/></polyline></geometry></root><root><geometry><polyline><point x='9' y='9'/></polyline>"
         b"</geometry></root></root></plant></scene></rsml>")
    seed("trace", "numbers.graphml", graph(node("n4294967295", 1), data(next_node=4294967296)))


def stylus(version, *lines, end=True, **head):
    """A stylus trace; version 3 gets its end line."""
    lines = [{"shvr_stylus_trace": version, "unit": "mm", **head}, *lines]
    text = "".join(json.dumps(line, separators=(",", ":")) + "\n" for line in lines)
    if version < 3 or not end:
        return text
    value = 14695981039346656037
    for byte in text.encode():
        value = (value ^ byte) * 1099511628211 % 2**64
    return text + f'{{"end":{{"lines":{len(lines)},"hash":"{value:016x}"}}}}\n'


def make_meshes():
    corners = [(0, 0, 0), (1, 0, 0), (0, 2, 0), (0, 0, 4)]
    faces = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]
    stl = b"".join(struct.pack("<12fH", 0, 0, 1, *(x for i in face for x in corners[i]), 0) for face in faces)
    header = b"SHVR surface, group 1, unit mm, positions are physical, in mm".ljust(80)
    seed("mesh", "binary.stl", header + struct.pack("<I", 4) + stl)
    seed("mesh", "solid.stl", b"solid".ljust(80) + struct.pack("<I", 4) + stl)
    seed("mesh", "claims_triangles.stl", header + struct.pack("<I", 8000000) + stl)
    facet = ("facet normal 0 0 1\n outer loop\n  vertex {} {} {}\n  vertex {} {} {}\n  vertex {} {} {}\n"
             " endloop\nendfacet\n")
    facets = [facet.format(*(x for i in face for x in corners[i])) for face in faces]
    seed("mesh", "text.stl", "solid a\r\n" + facets[0] + facets[1] + "endsolid a\nsolid b\n" + facets[2] + "endsolid b\n")

    quads = ("ply\nformat ascii 1.0\ncomment unit um\ncomment group 2 is vein\nelement vertex 4\nproperty float x\n"
             "property float y\nproperty float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
             "element face {}\nproperty list uchar int vertex_index\nproperty uchar group\nelement edge 1\n"
             "property list int short ends\nend_header\n0 0 0 1 2 3\n1 0 0 1 2 3\n1 1 0 1 2 3\n0 1 0 1 2 3\n"
             "4 0 1 2 3 1\n3 0 1 2 2\n2 0 1\n")
    seed("mesh", "text.ply", quads.format(2))
    seed("mesh", "claims_faces.ply", quads.format(8000000))
    for order, mark in (("little", "<"), ("big", ">")):
        ply = (f"ply\r\nformat binary_{order}_endian 1.0\r\nelement vertex {{}}\r\nproperty double x\r\nproperty float y\r\n"
               "property short z\r\nelement face 2\r\nproperty list ushort uint vertex_indices\r\n"
               "property list uchar float texcoord\r\nend_header\r\n")
        body = b"".join(struct.pack(mark + "dfh", *corner) for corner in corners)
        body += struct.pack(mark + "H3IBfH4IB", 3, 0, 1, 2, 1, 0.5, 4, 0, 1, 2, 3, 0)
        seed("mesh", f"{order}.ply", ply.format(4).encode() + body)
        seed("mesh", f"claims_{order}.ply", ply.format(4000000000).encode() + body)

    square = "v 0 0 0\nv 1 0 0 1\nv 1 1 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\n"
    seed("mesh", "groups.obj", "# unit mm\n# space volume\n# group 3 is vein\n" + square +
         "o cube\ng group_3\nf 1 2 3\ng\nf 1/1 2/1/1 3//1 4\nusemtl red\n")
    seed("mesh", "backwards.obj", "mtllib a.mtl\r\n" + square + "s off\r\nf -4 -3 \\\r\n -2//-1 -1\r\nl 1 2\r\nf 1 2 5 # ahead\r\nv 2 2 2")

    def glb(content, binary):
        text = json.dumps(content).encode()
        text += b" " * (-len(text) % 4)
        return (struct.pack("<4s4I", b"glTF", 2, 28 + len(text) + len(binary), len(text), 0x4E4F534A) + text +
                struct.pack("<II", len(binary), 0x004E4942) + binary)
    binary = b"".join(struct.pack("<3f", *corner) for corner in corners) + struct.pack("<6H", 0, 1, 2, 0, 2, 3)
    content = {"asset": {"version": "2.0", "extras": {"comments": ["unit mm", "space physical"]}}, "scene": 0,
               "scenes": [{"nodes": [0]}],
               "nodes": [{"children": [1, 2], "translation": [1, 2, 3], "scale": [0.1, 0.1, 0.1]}, {"mesh": 0},
                         {"mesh": 1, "rotation": [0, 0, 0.6, 0.8], "name": "b"}],
               "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]},
                          {"primitives": [{"attributes": {"POSITION": 0}, "mode": 5},
                                          {"attributes": {"POSITION": 0}, "mode": 6}]}],
               "materials": [{"pbrMetallicRoughness": {"baseColorFactor": [1, 0.5, 0, 1]}}],
               "buffers": [{"byteLength": 60}],
               "bufferViews": [{"buffer": 0, "byteLength": 48, "byteStride": 12},
                               {"buffer": 0, "byteOffset": 48, "byteLength": 12}],
               "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
                             {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"}]}
    seed("mesh", "scene.glb", glb(content, binary))
    content["accessors"][0]["count"] = 4000000000
    seed("mesh", "claims_points.glb", glb(content, binary))
    content["accessors"][0]["count"] = 4
    content["nodes"][1] = {"mesh": 0, "matrix": [0, 3, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 2, 1]}
    del content["scene"], content["scenes"]
    seed("mesh", "matrix.glb", glb(content, binary))


def make_stylus_trace():
    chosen = {"settings": {"assistance": True, "mode": "proximity", "threshold": 100, "probe_radius": 4,
                           "to_volume": [1000, 0, 0, 0, 1000, 0, 0, 0, 1000], "origin": [16, 8, 8]}}
    caps = {"outputs_force": True, "peak_force_n": 3.3, "usable_lower_m": [-1, -1, -1], "usable_upper_m": [1, 1, 1]}
    path = [{"at": [i * 0.0002, 0.001, 0]} for i in range(12)]

    def felt(sequence, runs, size=(32, 16, 16), **more):
        return {"relevance": {"sequence": sequence, "origin": [0, 0, 0], "size": size, "words_per_row": (size[0] + 31) // 32,
                              "spacing": [1, 1, 1], "volume_size": [64, 64, 64], "runs": runs, **more}}

    def dated(lines):
        return [{**lines[0], "relevance_time": 1 << 60}, *lines[1:]]
    # 32 x 16 x 16 bits: 4096 equal ones and as many that differ; 4096 is 0 + 32 (0 + 32 * 4).
    half = "ggEggE"
    seed("stylus_trace", "path", stylus(1, chosen, *path, caps=caps))
    seed("stylus_trace", "answers", stylus(
        1, {"settings": {"assistance": True, "law": "thesis", "strength": 0.5, "reset": 2}}, {"at": ["nan", 0, "-inf"]},
        {"read": "stale"}, {"read": "malformed"}, {"read": "lost"}, {"buttons": 1, "jump": 3, "turn": [0.5, 0.5, 0.5, 0.5]},
        {"now": 900000000, "time": 5, "sequence": 4294967295, "force": [0, 1e-300, 0]}, {"caps": {"peak_force_n": 0.1}},
        {"at": [0.1, 0.1, 0.1], "calibrated": False}, rate_hz=500))
    seed("stylus_trace", "felt", stylus(2, chosen, felt(1, half), *dated(path), felt(5, half, level=1), *path, caps=caps))
    object_mode = {"settings": {"mode": "object", "let_go": False}}
    seed("stylus_trace", "swapped", stylus(
        3, chosen, object_mode, felt(7, half), *dated(path), {"device": "swapped"}, {"caps": {"latency_s": 0.01}},
        felt(1, half), *dated(path), {"settings": {"mode": "surface"}}, *path, caps=caps))
    seed("stylus_trace", "holds_none", stylus(3, chosen, *path, holds_relevance=False))
    seed("stylus_trace", "no_end", stylus(3, chosen, *path, end=False))
    seed("stylus_trace", "claims_runs", stylus(2, felt(1, half, size=(128, 128, 128)), {"at": [0, 0, 0]}))
    seed("stylus_trace", "rows_too_long", stylus(2, felt(1, half, size=(128, 128, 128), words_per_row=64), {"at": [0, 0, 0]}))
    seed("stylus_trace", "rows_too_short", stylus(2, felt(1, half, size=(128, 16, 16), words_per_row=1), {"at": [0, 0, 0]}))
    seed("stylus_trace", "claims_rows", stylus(2, felt(1, half, size=(1 << 30, 1 << 30, 1 << 30)), {"at": [0, 0, 0]}))


def make_png():
    for kind, depth in [(0, 1), (0, 8), (0, 16), (2, 8), (2, 16), (3, 4), (4, 8), (6, 8), (6, 16)]:
        seed("png", f"kind_{kind}_{depth}.png", png(kind, depth))
    gamma = b"\0\0\0\4gAMA\0\0\xb1\x8f" + struct.pack(">I", zlib.crc32(b"gAMA\0\0\xb1\x8f"))
    seed("png", "gamma.png", png(2, 8, extra=gamma))
    seed("png", "claims_side", png(6, 16, claimed=(1 << 30, 1 << 30)))
    seed("png", "claims_pixels", png(6, 16, claimed=(1 << 14, 1 << 14)))


def main():
    make_headers()
    make_raw()
    make_tiff()
    make_dicom()
    make_pictures()
    make_zarr()
    make_zarr3()
    make_remote_store()
    make_ozx()
    make_label_looks()
    make_project()
    make_states()
    make_text()
    make_trace()
    make_meshes()
    make_stylus_trace()
    make_journals()
    make_png()
    files = [file for file in SEEDS.rglob("*") if file.is_file()]
    print(f"{len(files)} seeds, {sum(file.stat().st_size for file in files)} bytes")


if __name__ == "__main__":
    main()
