"""Volumes that exceed every budget: a sparse OME-Zarr of 4096^3 voxels, and a procedural volume of 65536^3."""
import json
import os
import re
import subprocess
import unittest
import zlib

from harness import ENVIRONMENT, SHVR, TIMEOUT_S, CliTest, Volume

SIDE = 4096
CHUNK = 64
LEVELS = 8  # the coarsest has 32 voxels per side
MARK = 200
BUDGET_MIB = 64
SIZE = 128  # pixels per side
RED, WHITE = (255, 0, 0), (255, 255, 255)


def write_sparse(folder):
    """Cubes of 64^3 voxels in the first and the last corner. All other chunks are missing: they have the fill value, 0."""
    multiscales = [{"version": "0.4", "name": "sparse",
                    "axes": [{"name": axis, "type": "space", "unit": "micrometer"} for axis in "zyx"],
                    "datasets": [{"path": str(level), "coordinateTransformations": [
                        {"type": "scale", "scale": [2.0 ** level] * 3},
                        {"type": "translation", "translation": [0.5 * (2 ** level - 1)] * 3}]}
                        for level in range(LEVELS)]}]
    folder.mkdir()
    (folder / ".zgroup").write_text('{"zarr_format": 2}')
    (folder / ".zattrs").write_text(json.dumps({"multiscales": multiscales}))
    for level in range(LEVELS):
        side = SIDE >> level
        mark = max(CHUNK >> level, 1)
        array = folder / str(level)
        array.mkdir()
        (array / ".zarray").write_text(json.dumps({
            "zarr_format": 2, "shape": [side] * 3, "chunks": [CHUNK] * 3, "dtype": "|u1", "compressor": None,
            "fill_value": 0, "order": "C", "filters": None, "dimension_separator": "/"}))
        for last in (False, True):
            corner = (side - 1) // CHUNK if last else 0
            begin = side - mark - corner * CHUNK if last else 0  # relative to its chunk
            chunk = array / str(corner) / str(corner) / str(corner)
            chunk.parent.mkdir(parents=True, exist_ok=True)
            # On coarse levels, one chunk holds both corners.
            voxels = bytearray(chunk.read_bytes()) if chunk.exists() else bytearray(CHUNK ** 3)
            for z in range(begin, begin + mark):
                for y in range(begin, begin + mark):
                    row = begin + CHUNK * (y + CHUNK * z)
                    voxels[row:row + mark] = bytes([MARK]) * mark
            chunk.write_bytes(voxels)
    return folder


def read_png(path):
    """Rows of RGBA pixels of an 8-bit RGBA file. Rows may have any of the five filter types of PNG."""
    data = path.read_bytes()
    width, height = int.from_bytes(data[16:20], "big"), int.from_bytes(data[20:24], "big")
    packed, at = b"", 8
    while at < len(data):
        length = int.from_bytes(data[at:at + 4], "big")
        if data[at + 4:at + 8] == b"IDAT":
            packed += data[at + 8:at + 8 + length]
        at += 12 + length
    channels = {2: 3, 6: 4}[data[25]]
    stride = channels * width
    raw, rows, above = zlib.decompress(packed), [], bytearray(stride)
    for y in range(height):
        kind, row = raw[y * (stride + 1)], bytearray(raw[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
        for i in range(stride):
            a, b = row[i - channels] if i >= channels else 0, above[i]
            c = above[i - channels] if i >= channels else 0
            nearest = min((abs(b - c), 0, a), (abs(a - c), 1, b), (abs(a + b - 2 * c), 2, c))[2]
            row[i] = (row[i] + [0, a, b, (a + b) // 2, nearest][kind]) & 255
        rows.append([tuple(row[channels * x:channels * x + 3]) for x in range(width)])
        above = row
    return rows


def session_of(volume, eye, target, height):
    return {"shvr_session": 1, "volume": volume,
            "transfer_function": {"points": [{"intensity": 60, "color": "#ff0000", "opacity": 0.0},
                                             {"intensity": 100, "color": "#ff0000", "opacity": 1.0},
                                             {"intensity": 255, "color": "#ff0000", "opacity": 1.0}]},
            "cameras": {"corner": {"projection": "orthographic", "eye": eye, "target": target, "up": [0, 0, 1],
                                   "height": height}},
            "light": {"shaded": False}, "render": {"size": [SIZE, SIZE], "background": "#ffffff"}}


class Large(CliTest):
    def render(self, session):
        """The JSON object, the picture, and the peak of resident memory in bytes."""
        path = self.write_json("session.json", session)
        picture = self.folder / "a.png"
        with subprocess.Popen([SHVR, "render", path, "-o", picture, "--camera", "corner", "--budget-device",
                               str(BUDGET_MIB), "--budget-host", str(BUDGET_MIB), "--json"], stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, text=True, env=ENVIRONMENT) as process:
            out, err = process.stdout.read(), process.stderr.read()
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
        self.assertEqual(process.returncode, 0, err)
        return json.loads(out), read_png(picture), 1024 * usage.ru_maxrss

    def check_bytes(self, result, resident):
        """The memory that the program reports, and its resident memory beyond that of a tiny volume's picture."""
        budget = BUDGET_MIB << 20
        self.assertLessEqual(result["bytes"]["peak_device"], budget)
        self.assertLessEqual(result["bytes"]["peak_host"], budget)
        tiny = session_of({"procedural": "sphere", "size": [8, 8, 8]}, [4, -60, 4], [4, 4, 4], 8)
        *_, base = self.render(tiny)
        self.assertLessEqual(resident - base, 1.05 * 2 * budget)

    def assert_color(self, color, expected, where):
        """Allows for rays that end as soon as they are nearly opaque."""
        self.assertLessEqual(max(abs(one - other) for one, other in zip(color, expected)), 4, (color, expected, where))

    def check_corner(self, pixels):
        """Pixels are as large as voxels, and the centre of the picture is a corner of the volume, so that the cube in that
        corner fills the lower left quarter."""
        half = SIZE // 2
        for y, row in enumerate(pixels):
            for x, color in enumerate(row):
                if min(abs(x - half + 0.5), abs(y - half + 0.5), x, SIZE - 1 - y) >= 2:
                    self.assert_color(color, RED if x < half <= y else WHITE, (x, y))

    def test_marks_in_the_corners_of_a_sparse_4096(self):
        sparse = write_sparse(self.folder / "sparse.zarr")
        # From the front, so that rays cross the whole empty volume.
        far = session_of({"path": str(sparse)}, [SIDE, -200, SIDE], [SIDE, SIDE, SIDE], SIZE)
        result, pixels, resident = self.render(far)
        self.assertIs(result["complete"], True)
        self.assertEqual(result["bricks"]["finest_level"], 0)
        self.check_corner(pixels)
        self.check_bytes(result, resident)
        self.assertNotIn("measured on level", " ".join(result["warnings"]))  # level 0 stores little

    def test_the_whole_of_a_sparse_4096_is_a_coarse_level(self):
        sparse = write_sparse(self.folder / "sparse.zarr")
        middle = SIDE / 2
        result, pixels, _ = self.render(
            session_of({"path": str(sparse)}, [middle, -200, middle], [middle, middle, middle], SIDE))
        self.assertIs(result["complete"], True)
        self.assertGreaterEqual(result["bricks"]["finest_level"], 5)
        last = SIZE - 1
        colored = {(x, y) for y, row in enumerate(pixels) for x, color in enumerate(row) if color != WHITE}
        self.assertIn((0, last), colored)  # the first corner, at the bottom left
        self.assertIn((last, 0), colored)
        self.assertEqual([(x, y) for x, y in colored if x + last - y > 6 and last - x + y > 6], [])

    def test_a_procedural_65536(self):
        volume = {"procedural": "sphere", "size": [65536] * 3}
        # The top of the visible sphere, where the intensity falls to 60: it is 125 at a radius of 0.35 of the side, and
        # changes by 1000 / 65536 per voxel.
        top = 32768 + 0.35 * 65536 + (125 - 60) * 65.536
        result, pixels, resident = self.render(session_of(volume, [32768, 0, top], [32768, 32768, top], 4096))
        self.assertIs(result["complete"], True)
        for y, color in ((SIZE // 4, WHITE), (3 * SIZE // 4, RED)):
            self.assert_color(pixels[y][SIZE // 2], color, y)
        self.check_bytes(result, resident)

    def test_thin_tubes_in_2_to_the_20_are_seen(self):
        volume = {"procedural": "tubes", "size": [1 << 20] * 3}
        middle = 1 << 19
        session = session_of(volume, [middle, -(1 << 20), middle], [middle] * 3, 1 << 20)
        session["transfer_function"]["points"] = [{"intensity": 130, "color": "#ff0000", "opacity": 0.0},
                                                  {"intensity": 200, "color": "#ff0000", "opacity": 0.9},
                                                  {"intensity": 255, "color": "#ff0000", "opacity": 0.9}]
        result, pixels, _ = self.render(session)
        self.assertIs(result["complete"], True)
        seen = [y for y, row in enumerate(pixels) for color in row if color[1] < 128]
        self.assertGreater(len(seen), SIZE)  # thirteen tubes, one pixel wide at least
        self.assertGreater(len(set(seen)), SIZE * 3 // 4)  # from bottom to top


class Plain(CliTest):
    """A file without levels that does not fit into the device budget."""

    def write_plain(self):
        """64 MiB of zeros, as a sparse file."""
        header = Volume((8, 8, 8), bytes(512)).write(self.folder, "plain")
        header.write_text(header.read_text().replace("sizes: 8 8 8", "sizes: 512 512 256"))
        os.truncate(self.folder / "plain.raw", 512 * 512 * 256)
        return header

    def test_levels_that_do_not_fit_are_refused_and_both_remedies_work(self):
        plain, project, picture = self.write_plain(), self.folder / "p.zarr", self.folder / "a.png"
        draw = ["-o", picture, "--size", "32x32", "--budget-device", "64", "--budget-host"]
        # Coarser levels take (1/8 + 1/64 + ...) of 64 MiB, and building them takes two slices of 512 x 512 voxels.
        said = self.check_refused("render", plain, *draw, "32",
                                  says=["plain", "takes 10 MiB; expected at most 8 MiB, a quarter of --budget-host"])
        enough = re.search(r"use --budget-host (\d+), or make a project with `shvr import FILE PROJECT`", said)[1]
        self.check("render", plain, *draw, enough)
        self.check_refused("render", plain, *draw, str(int(enough) - 1), says=["takes 10 MiB"])
        self.check("import", plain, project, "--quiet")
        self.check("render", project, *draw, "32")


if __name__ == "__main__":
    unittest.main()
