"""Volumes with a stated place, written and read by their formats' own descriptions; nothing of the engine is used.

A place is an affine map from voxel indices (the centre of voxel 0 is at 0, 0, 0) to physical LPS coordinates: three
steps and an origin. Formats that think in RAS turn x and y round. `place_of` functions return such a map for a file,
and `mark_in` the mean index of the voxels that are marked in it, so that the position of the mark follows from the file
alone.
"""
import json
import re
import struct
import zlib

SIZE = (12, 10, 8)
# 2 x 2 x 2 voxels, off the centre along every axis, at even indices, so that halving it leaves one voxel.
MARK = (2, 6, 4)
GROUP = 3


class Place:
    def __init__(self, steps, origin):
        self.steps, self.origin = [list(map(float, s)) for s in steps], list(map(float, origin))

    def at(self, index):
        return [o + sum(step[i] * n for step, n in zip(self.steps, index)) for i, o in enumerate(self.origin)]

    def turned(self):
        """LPS in RAS, or the other way round."""
        turn = (-1, -1, 1)
        return Place([[a * t for a, t in zip(step, turn)] for step in self.steps],
                     [a * t for a, t in zip(self.origin, turn)])

    @property
    def spacing(self):
        return [sum(a * a for a in step) ** 0.5 for step in self.steps]

    @property
    def directions(self):
        return [[a / s for a in step] for step, s in zip(self.steps, self.spacing)]


def voxels():
    """0 to 10 everywhere, and 200 in the mark; x fastest."""
    x0, y0, z0 = MARK
    return [200 if x - x0 in (0, 1) and y - y0 in (0, 1) and z - z0 in (0, 1) else (x + 3 * y + 5 * z) % 11
            for z in range(SIZE[2]) for y in range(SIZE[1]) for x in range(SIZE[0])]


MARK_INDEX = [m + 0.5 for m in MARK]


def mark_in(values, size, threshold=1):
    """The mean index of the voxels at or above the threshold."""
    found = [(i % size[0], i // size[0] % size[1], i // (size[0] * size[1]))
             for i, value in enumerate(values) if value >= threshold]
    return [sum(index[axis] for index in found) / len(found) for axis in range(3)], len(found)


# ---- Writers --------------------------------------------------------------------------------------------------------

def bracketed(vector):
    return "(" + ",".join(repr(float(a)) for a in vector) + ")"


def write_nrrd(path, place, space="left-posterior-superior"):
    stated = {"right-anterior-superior": place.turned(), None: place}.get(space, place)
    if space == "left-anterior-superior":
        # x as in LPS, y turned round.
        stated = Place([[s[0], -s[1], s[2]] for s in place.steps], [place.origin[0], -place.origin[1], place.origin[2]])
    header = "NRRD0004\ntype: uchar\ndimension: 3\n" + (f"space: {space}\n" if space else "space dimension: 3\n") + \
        f"sizes: {' '.join(map(str, SIZE))}\nspace directions: {' '.join(map(bracketed, stated.steps))}\n" + \
        f'space units: "mm" "mm" "mm"\nspace origin: {bracketed(stated.origin)}\nencoding: raw\n\n'
    path.write_bytes(header.encode() + bytes(voxels()))
    return path


def write_mha(path, place):
    numbers = " ".join(repr(a) for direction in place.directions for a in direction)
    path.write_bytes((f"ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
                      f"TransformMatrix = {numbers}\nOffset = {' '.join(map(repr, place.origin))}\n"
                      f"AnatomicalOrientation = RAI\nElementSpacing = {' '.join(map(repr, place.spacing))}\n"
                      f"DimSize = {' '.join(map(str, SIZE))}\nElementType = MET_UCHAR\n"
                      f"ElementDataFile = LOCAL\n").encode() + bytes(voxels()))
    return path


def write_mhd(path, place):
    write_mha(path, place)
    head, data = path.read_bytes().split(b"LOCAL\n", 1)
    path.with_suffix(".raw").write_bytes(data)
    path.write_bytes(head + path.with_suffix(".raw").name.encode() + b"\n")
    return path


def write_nifti(path, place):
    """NIfTI-2, whose numbers are doubles."""
    ras = place.turned()
    rows = [number for i in range(3) for number in (*(step[i] for step in ras.steps), ras.origin[i])]
    header = struct.pack("<i8shh8q24x8dqdd48x80x24xii6d12d4xii16xB15x", 540, b"n+2\0\r\n\x1a\n", 2, 8, 3, *SIZE, 1, 1, 1, 1,
                         1.0, *place.spacing, 0, 0, 0, 0, 544, 0.0, 0.0, 0, 1, 0, 0, 0, 0, 0, 0, *rows, 2, 0, 0)
    path.write_bytes(header.ljust(544, b"\0") + bytes(voxels()))
    return path


def write_dicom(folder, place):
    """A series of slices of 16 bits, explicit little endian; the later slices come first by name."""
    folder.mkdir()
    plane = SIZE[0] * SIZE[1]

    def element(group, number, kind, value):
        if isinstance(value, str):
            value = value.encode()
        value += (b"\0" if kind == "UI" else b" ") * (len(value) % 2)
        long = kind in ("OB", "OW")
        return struct.pack("<HH2s", group, number, kind.encode()) + \
            (struct.pack("<HI", 0, len(value)) if long else struct.pack("<H", len(value))) + value

    def text(numbers):
        return "\\".join(f"{a:.10g}" for a in numbers)

    for z in range(SIZE[2]):
        uid = f"1.2.826.0.1.3680043.9.1.{z + 1}"
        meta = element(2, 1, "OB", b"\0\1") + element(2, 2, "UI", "1.2.840.10008.5.1.4.1.1.2") + element(2, 3, "UI", uid) \
            + element(2, 0x10, "UI", "1.2.840.10008.1.2.1") + element(2, 0x12, "UI", "1.2.3")
        meta = element(2, 0, "UL", struct.pack("<I", len(meta))) + meta
        voxel = struct.pack(f"<{plane}H", *voxels()[plane * z:plane * (z + 1)])
        spacing = place.spacing
        data = element(8, 0x16, "UI", "1.2.840.10008.5.1.4.1.1.2") + element(8, 0x18, "UI", uid) \
            + element(8, 0x60, "CS", "CT") + element(0x20, 0xD, "UI", "1.2.3.4") + element(0x20, 0xE, "UI", "1.2.3.5") \
            + element(0x20, 0x13, "IS", str(z + 1)) + element(0x20, 0x32, "DS", text(place.at((0, 0, z)))) \
            + element(0x20, 0x37, "DS", text(place.directions[0] + place.directions[1])) \
            + element(0x28, 2, "US", struct.pack("<H", 1)) + element(0x28, 4, "CS", "MONOCHROME2") \
            + element(0x28, 0x10, "US", struct.pack("<H", SIZE[1])) + element(0x28, 0x11, "US", struct.pack("<H", SIZE[0])) \
            + element(0x28, 0x30, "DS", text((spacing[1], spacing[0]))) + element(0x28, 0x100, "US", struct.pack("<H", 16)) \
            + element(0x28, 0x101, "US", struct.pack("<H", 16)) + element(0x28, 0x102, "US", struct.pack("<H", 15)) \
            + element(0x28, 0x103, "US", struct.pack("<H", 0)) + element(0x7FE0, 0x10, "OW", voxel)
        (folder / f"slice{SIZE[2] - z:02}.dcm").write_bytes(bytes(128) + b"DICM" + meta + data)
    return folder


def write_raw(path):
    path.write_bytes(bytes(voxels()))
    return path


def write_tiff(path, spacing):
    """As ImageJ writes a stack: one directory, uncompressed slices behind each other."""
    text = f"ImageJ=1.53t\nimages={SIZE[2]}\nslices={SIZE[2]}\nunit=mm\nspacing={spacing[2]!r}\n".encode() + b"\0"
    tags = [(256, 4, 1, SIZE[0]), (257, 4, 1, SIZE[1]), (258, 3, 1, 8), (259, 3, 1, 1), (262, 3, 1, 1),
            (270, 2, len(text), 300), (273, 4, 1, 1000), (277, 3, 1, 1), (278, 4, 1, SIZE[1]),
            (279, 4, 1, SIZE[0] * SIZE[1]), (282, 5, 1, 800), (283, 5, 1, 808), (296, 3, 1, 1)]
    head = b"II*\0" + struct.pack("<IH", 8, len(tags)) + b"".join(struct.pack("<HHII", *tag) for tag in tags) + bytes(4)
    content = bytearray(head.ljust(1000, b"\0"))
    content[300:300 + len(text)] = text
    for at, side in ((800, spacing[0]), (808, spacing[1])):
        content[at:at + 8] = struct.pack("<II", 1000000, round(1000000 * side))
    path.write_bytes(bytes(content) + bytes(voxels()))
    return path


def write_ome_zarr(folder, spacing, translation):
    """One level of one chunk, not compressed."""
    (folder / "0").mkdir(parents=True)
    (folder / ".zgroup").write_text('{"zarr_format": 2}')
    axes = [{"name": name, "type": "space", "unit": "millimeter"} for name in "zyx"]
    steps = [{"type": "scale", "scale": spacing[::-1]}, {"type": "translation", "translation": translation[::-1]}]
    (folder / ".zattrs").write_text(json.dumps({"multiscales": [
        {"version": "0.4", "axes": axes, "datasets": [{"path": "0", "coordinateTransformations": steps}]}]}))
    (folder / "0/.zarray").write_text(json.dumps({
        "zarr_format": 2, "shape": SIZE[::-1], "chunks": SIZE[::-1], "dtype": "|u1", "compressor": None, "fill_value": 0,
        "order": "C", "filters": None}))
    (folder / "0/0.0.0").write_bytes(bytes(voxels()))
    return folder


# ---- Readers --------------------------------------------------------------------------------------------------------

def numbers_in(text):
    return [float(a) for a in re.findall(r"[-+]?[0-9.]+(?:e[-+]?[0-9]+)?", text)]


def read_nrrd(path):
    """Voxels, size and place of a raw NRRD that is one file."""
    head, data = path.read_bytes().split(b"\n\n", 1)
    fields = dict(line.split(": ", 1) for line in head.decode().splitlines()[1:] if ":=" not in line)
    size = [int(n) for n in fields["sizes"].split()]
    kind = {"uint8": "B", "int8": "b", "uint16": "H", "uint32": "I", "int32": "i", "float": "f"}[fields["type"]]
    values = struct.unpack(f"<{size[0] * size[1] * size[2]}{kind}", data)
    if "spacings" in fields:
        spacing = numbers_in(fields["spacings"])
        return values, size, Place([[s if i == j else 0 for j in range(3)] for i, s in enumerate(spacing)], [0, 0, 0])
    steps = numbers_in(fields["space directions"])
    place = Place([steps[0:3], steps[3:6], steps[6:9]], numbers_in(fields["space origin"]))
    space = fields.get("space", "left-posterior-superior")
    assert space in ("left-posterior-superior", "right-anterior-superior"), space
    return values, size, place.turned() if space.startswith("right") else place


def read_tiff(path):
    """Voxels and size of 8-bit slices behind deflate, and the lines of the description."""
    data = path.read_bytes()
    at, = struct.unpack_from("<I", data, 4)
    values, lines, sizes = [], {}, []
    while at:
        count, = struct.unpack_from("<H", data, at)
        tags = {}
        for i in range(count):
            tag, kind, length, value = struct.unpack_from("<HHII", data, at + 2 + 12 * i)
            bytes_each = {2: 1, 3: 2, 4: 4, 5: 8, 16: 8}.get(kind, 1)
            inside = length * bytes_each <= 4
            where = at + 2 + 12 * i + 8 if inside else value
            form = {3: "H", 4: "I", 16: "Q"}.get(kind)
            tags[tag] = struct.unpack_from(f"<{length}{form}", data, where) if form else data[where:where + length * bytes_each]
        if 270 in tags:
            lines = dict(line.split("=", 1) for line in tags[270].decode().rstrip("\0").splitlines())
        for offset, length in zip(tags[273], tags[279]):
            values += zlib.decompress(data[offset:offset + length])
        sizes.append((tags[256][0], tags[257][0]))
        at, = struct.unpack_from("<I", data, at + 2 + 12 * count)
    return values, [*sizes[0], len(sizes)], lines


def place_of_tiff(lines):
    spacing = numbers_in(lines["shvr_spacing"])
    if "shvr_origin" not in lines:
        return Place([[s if i == j else 0 for j in range(3)] for i, s in enumerate(spacing)], [0, 0, 0])
    directions = numbers_in(lines["shvr_directions"])
    place = Place([[a * s for a in directions[3 * i:3 * i + 3]] for i, s in enumerate(spacing)],
                  numbers_in(lines["shvr_origin"]))
    return place.turned() if lines["shvr_frame"] == "RAS" else place


def place_of_ome_zarr(folder, level=0):
    """The whole placement; and the map of OME-Zarr alone, along the volume's own axes."""
    attributes = json.loads((folder / ".zattrs").read_text())
    scale, translation = (step[step["type"]][::-1] for step in
                          attributes["multiscales"][0]["datasets"][level]["coordinateTransformations"])
    own = Place([[s if i == j else 0 for j in range(3)] for i, s in enumerate(scale)], translation)
    stated = attributes.get("shvr_placement")
    if stated is None:
        return own, own
    directions = stated["directions"]
    origin = [sum(directions[axis][i] * translation[axis] for axis in range(3)) for i in range(3)]
    place = Place([[a * s for a in d] for d, s in zip(directions, scale)], stated["origin"] if level == 0 else origin)
    return (place.turned() if stated["frame"] == "RAS" else place), own


def place_of_info(info):
    """As shvr info --json says it."""
    place = Place([[a * s for a in d] for d, s in zip(info["directions"], info["spacing"])], info["origin"])
    return place.turned() if info["frame"] == "RAS" else place
