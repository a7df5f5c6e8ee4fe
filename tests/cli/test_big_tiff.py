"""TIFFs beyond 4 GiB and 16 GiB, whose voxels are holes of a sparse file but for a mark: they take no disk."""
import os
import struct
import unittest

from harness import CliTest

SHORT, LONG, LONG8, ASCII = 3, 4, 16, 2
GIB = 1 << 30
SIDE = 1 << 16   # pixels of a slice of 4 GiB
MARK = bytes(range(1, 9))


def write_hole(path, size, writes):
    """A file of `size` bytes, 0 but for {offset: bytes}."""
    with open(path, "wb") as file:
        file.truncate(size)
        for offset, content in writes.items():
            file.seek(offset)
            file.write(content)


def big_directory(fields, following):
    """Of a BigTIFF, little-endian; one value to a field."""
    packed = b"".join(struct.pack("<HHQQ", tag, kind, 1, value) for tag, kind, value in fields)
    return struct.pack("<Q", len(fields)) + packed + struct.pack("<Q", following)


class BigTiff(CliTest):
    def setUp(self):
        super().setUp()
        probe = self.folder / "probe"
        write_hole(probe, 1 << 26, {})
        if probe.stat().st_blocks * 512 > 1 << 20:
            self.skipTest("this file system keeps no holes: the files would take 20 GB")
        probe.unlink()

    def write_big(self, name, slices):
        """A BigTIFF of slices of 65536 x 65536 bytes; the directories stand behind all voxels. Slice z holds MARK, plus
        10 z, from x = 40000, y = 65535 on."""
        path = self.folder / name
        first, directory_bytes = 4096, 8 + 8 * 20 + 8
        behind = first + slices * 4 * GIB
        writes = {0: struct.pack("<2sHHHQ", b"II", 43, 8, 0, behind)}
        for z in range(slices):
            voxels = first + z * 4 * GIB
            at = behind + z * directory_bytes
            writes[voxels + 65535 * SIDE + 40000] = bytes(value + 10 * z for value in MARK)
            writes[at] = big_directory(
                [(256, LONG, SIDE), (257, LONG, SIDE), (258, SHORT, 8), (259, SHORT, 1), (262, SHORT, 1),
                 (273, LONG8, voxels), (278, LONG, SIDE), (279, LONG8, 4 * GIB)],
                at + directory_bytes if z + 1 < slices else 0)
        write_hole(path, behind + slices * directory_bytes, writes)
        self.assertGreater(path.stat().st_size, slices * 4 * GIB)
        self.assertLess(path.stat().st_blocks * 512, 1 << 20)
        return path

    def check_crop(self, path, crop, expected):
        """Imports `crop`; `expected`: its voxels."""
        project = self.folder / "project"
        report = self.check_json("import", path, project, "--crop", ",".join(map(str, crop)), "--overwrite",
                                 "--spacing", "1,1,1", "--unit", "um")
        self.assertEqual(report["size"], [crop[3] - crop[0], crop[4] - crop[1], crop[5] - crop[2]])
        self.assertLess(report["bytes"], 1 << 20)
        statistics = self.check_json("info", project)
        for key, value in (("voxels", len(expected)), ("min", min(expected)), ("max", max(expected)),
                           ("mean", sum(expected) / len(expected))):
            self.assertAlmostEqual(statistics[key], value, places=9, msg=key)
        chunk = (project / "0" / "0" / "0" / "0")
        self.assertTrue(chunk.exists())

    def test_a_bigtiff_of_20_gib(self):
        path = self.write_big("a.tif", 5)
        told = self.check_json("info", path)
        self.assertEqual((told["size"], told["type"], told["voxels"]), ([SIDE, SIDE, 5], "uint8", 5 << 32))
        self.assertTrue(any("sample" in warning for warning in told["warnings"]), told["warnings"])
        # Crops from the slice whose offset is beyond 2^34, and through all slices.
        self.check_crop(path, (40000, 65535, 4, 40008, 65536, 5), [value + 40 for value in MARK])
        self.check_crop(path, (40002, 65535, 0, 40004, 65536, 5), [value + 10 * z for z in range(5) for value in (3, 4)])

    def test_pictures_of_it_are_refused_by_its_size_with_what_to_do(self):
        path = self.write_big("a.tif", 5)
        self.check_refused("render", path, "-o", self.folder / "a.png", "--size", "64x64", "--spacing", "1,1,1",
                           "--unit", "um", says=["a.tif", "--budget-host", "shvr import"])
        self.assertEqual([file.name for file in self.folder.iterdir()], ["a.tif"])

    def test_a_bigtiff_that_lost_its_end_is_refused(self):
        path = self.write_big("a.tif", 5)
        whole = path.stat().st_size
        os.truncate(path, 18 * GIB)
        self.check_refused("info", path, says=[f"starts at byte {4096 + 20 * GIB}", f"the {18 * GIB} bytes of the file",
                                               "truncated"])
        # Directories that are there, of voxels that are not.
        path = self.write_big("b.tif", 1)
        with open(path, "r+b") as file:
            file.seek(4096 + 4 * GIB)
            fields = file.read().replace(struct.pack("<HHQQ", 273, LONG8, 1, 4096),
                                         struct.pack("<HHQQ", 273, LONG8, 1, 1 << 35))
            file.seek(4096 + 4 * GIB)
            file.write(fields)
        self.assertGreater(whole, path.stat().st_size)
        self.check_refused("info", path, says=["page 1", str(1 << 35), "expected"])

    def test_imagejs_form_above_4_gib(self):
        """Classic TIFF: one directory, at the start; the voxels of 1281 images of 4 MiB follow each other."""
        images, side, first = 1281, 2048, 4096
        text = f"ImageJ=1.53t\nimages={images}\nslices={images}\nloop=false\n".encode() + b"\0"
        fields = [(256, LONG, 1, side), (257, LONG, 1, side), (258, SHORT, 1, 8), (259, SHORT, 1, 1), (262, SHORT, 1, 1),
                  (270, ASCII, len(text), 512), (273, LONG, 1, first), (277, SHORT, 1, 1), (278, LONG, 1, side),
                  (279, LONG, 1, side * side)]
        directory = struct.pack("<H", len(fields)) + b"".join(struct.pack("<HHII", *field) for field in fields)
        path = self.folder / "long.tif"
        last = first + (images - 1) * side * side
        write_hole(path, first + images * side * side,
                   {0: struct.pack("<2sHI", b"II", 42, 8), 8: directory + struct.pack("<I", 0), 512: text,
                    first + 7: MARK, last + 100 * side + 7: bytes(value + 100 for value in MARK)})
        self.assertGreater(last, 1 << 32)
        told = self.check_json("info", path)
        self.assertEqual((told["size"], told["type"]), ([side, side, images], "uint8"))
        self.check_crop(path, (7, 100, images - 1, 15, 101, images), [value + 100 for value in MARK])
        self.check_crop(path, (7, 0, 0, 15, 1, 1), list(MARK))
        os.truncate(path, first + (images - 1) * side * side)
        self.check_refused("info", path, says=[f"{images} images", "truncated, or pages are missing"])


if __name__ == "__main__":
    unittest.main()
