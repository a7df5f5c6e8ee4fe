"""shvr import: projects, as python3-zarr and the other commands see them; what happens when an import ends early."""
import itertools
import json
import math
import os
import pty
import random
import resource
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import time
import unittest
import unittest.mock
from pathlib import Path

from harness import ENVIRONMENT, IS_SLOW, SHVR, CliTest, Volume, run

# Runs in an interpreter that has python3-zarr, which need not be the one that runs this file. Every level is read by
# python3-zarr, recomputed from the level before, and compared; level 0 is compared with bare voxels.
ZARR = """
import json, sys
import numpy, zarr
group = zarr.open_group(sys.argv[1], "r")
entry = group.attrs["multiscales"][0]
levels = [group[dataset["path"]] for dataset in entry["datasets"]]
arrays = [level[:] for level in levels]
bare = numpy.fromfile(sys.argv[2], arrays[0].dtype).reshape(arrays[0].shape)
problems = [] if numpy.array_equal(bare, arrays[0]) else ["level 0 differs"]
for number, (fine, coarse) in enumerate(zip(arrays, arrays[1:])):
    size = [(side + 1) // 2 for side in fine.shape]
    pad = [(0, 2 * half - side) for half, side in zip(size, fine.shape)]
    halves = lambda a: numpy.pad(a, pad).reshape(size[0], 2, size[1], 2, size[2], 2).sum((1, 3, 5))
    mean = halves(fine.astype("f8")) / halves(numpy.ones(fine.shape))
    if fine.dtype.kind != "f":
        mean = numpy.rint(mean)
    if not numpy.array_equal(mean.astype(fine.dtype), coarse):
        problems.append(f"level {number + 1} is not the mean of level {number}")
transformations = [[t.get("scale", t.get("translation")) for t in d["coordinateTransformations"]]
                   for d in entry["datasets"]]
# As our reader gives them: x fastest, level after level.
for number, array in enumerate(arrays):
    array.astype(array.dtype.newbyteorder("<")).tofile(f"{sys.argv[3]}-{number}")
print(json.dumps({"problems": problems, "axes": entry["axes"], "transformations": transformations,
                  "types": [level.dtype.str for level in levels], "chunks": levels[0].chunks}))
"""


def python_with_zarr():
    for python in (sys.executable, "/usr/bin/python3"):
        if os.path.exists(python) and subprocess.run([python, "-c", "import zarr"], capture_output=True).returncode == 0:
            return python
    return None


def content_of(folder):
    return {str(path.relative_to(folder)): path.read_bytes() for path in Path(folder).rglob("*") if path.is_file()}


class Import(CliTest):
    def project(self):
        return self.folder / "project"

    def read_by_zarr(self, bare, prefix="level"):
        python = python_with_zarr()
        if python is None:
            self.skipTest("no interpreter here has python3-zarr")
        result = subprocess.run([python, "-c", ZARR, self.project(), bare, self.folder / prefix], capture_output=True,
                                text=True, timeout=120)
        self.assertEqual(result.returncode, 0, result.stderr)
        found = json.loads(result.stdout)
        self.assertEqual(found["problems"], [])
        return found

    def test_the_report_and_what_info_says_of_the_project(self):
        header = Volume.noise((70, 66, 65), seed=1, high=3000, voxel_type="int16", spacing=(0.5, 0.5, 2)).write(self.folder)
        report = self.check_json("import", header, self.project())
        self.assert_keys(report, ["project", "size", "levels", "bricks", "bricks_stored", "bytes", "seconds",
                                  "megabytes_per_second", "peak_rss_mib"])
        self.assertEqual(report["project"], str(self.project()))
        self.assertEqual((report["size"], report["levels"], report["bricks"]), ([70, 66, 65], 3, 8 + 1 + 1))
        self.assertEqual(report["bytes"], sum(map(len, content_of(self.project()).values())))
        before = self.check_json("info", header)
        after = self.check_json("info", self.project())
        self.assertEqual((after["format"], after["levels"]), ("ome-zarr", 3))
        for key in ("size", "type", "spacing", "unit", "min", "max", "mean", "histogram", "voxels"):
            self.assertEqual(after[key], before[key], key)

    def test_python_zarr_reads_every_level(self):
        for voxel_type, high in (("uint8", 255), ("int16", 30000), ("uint16", 65535), ("float", 1000)):
            with self.subTest(voxel_type=voxel_type):
                header = Volume.noise((67, 33, 130), seed=2, high=high, voxel_type=voxel_type,
                                      spacing=(0.5, 0.75, 2)).write(self.folder)
                self.check("import", header, self.project(), "--overwrite", "--unit", "um", "--quiet")
                found = self.read_by_zarr(self.folder / "volume.raw")
                self.assertEqual([axis["name"] for axis in found["axes"]], ["z", "y", "x"])
                self.assertEqual({axis["unit"] for axis in found["axes"]}, {"micrometer"})
                self.assertEqual(found["chunks"], [64, 64, 64])
                for level, (scale, translation) in enumerate(found["transformations"]):
                    self.assertEqual(scale, [2 ** level * side for side in (2, 0.75, 0.5)])
                    self.assertEqual(translation, [0.5 * (2 ** level - 1) * side for side in (2, 0.75, 0.5)])

    def test_python_zarr_and_we_read_the_same(self):
        header = Volume.noise((50, 40, 70), seed=3, high=60000, voxel_type="uint16").write(self.folder)
        self.check("import", header, self.project(), "--quiet")
        levels = len(self.read_by_zarr(self.folder / "volume.raw")["types"])
        for level in range(levels):
            size = [-(-side // 2 ** level) for side in (50, 40, 70)]
            bare = "x".join(map(str, size)) + ":uint16"
            told = self.check_json("info", self.folder / f"level-{level}", "--set", f"volume.raw={bare}")
            # The level's array by itself.
            ours = self.check_json("info", self.project() / str(level))
            for key in ("size", "type", "min", "max", "mean", "histogram"):
                self.assertEqual(ours[key], told[key], (level, key))

    def test_the_chirality_phantom_comes_back(self):
        for name in ("attached.nrrd", "detached.mhd", "side_car.json"):
            self.check("import", Path("tests/data/chirality") / name, self.project(), "--overwrite", "--quiet")
            bare = self.folder / "bare"
            values = [x + 10 * y + 100 * z - 99 for z in range(3) for y in range(4) for x in range(5)]
            bare.write_bytes(struct.pack("<60h", *values))
            self.read_by_zarr(bare)
            info = self.check_json("info", self.project())
            self.assertEqual((info["spacing"], info["unit"]), ([0.5, 0.5, 1.25], "mm"))

    def test_empty_bricks_are_not_stored(self):
        values = [0] * (128 * 64 * 64)
        values[5] = 200
        header = Volume((128, 64, 64), values).write(self.folder)
        report = self.check_json("import", header, self.project())
        self.assertEqual((report["bricks"], report["bricks_stored"]), (2 + 1 + 1, 3))
        self.assertFalse((self.project() / "0/0/0/1").exists())
        self.read_by_zarr(self.folder / "volume.raw")

    def test_preparation_is_done_in_its_order_and_told(self):
        volume = Volume.noise((20, 18, 16), seed=4)
        header = volume.write(self.folder)
        report = self.check_json("import", header, self.project(), "--crop", "2,4,6,12,14,16", "--reverse",
                                 "--downscale", 2, "--spacing", "1,2,3", "--unit", "mm")
        self.assertEqual((report["size"], report["spacing"], report["unit"]), ([5, 5, 5], [2, 4, 6], "mm"))
        expected = []
        for z, y, x in [(z, y, x) for z in range(6, 16, 2) for y in range(4, 14, 2) for x in range(2, 12, 2)]:
            block = [255 - volume.values[volume.index((x + i, y + j, z + k))]
                     for i in (0, 1) for j in (0, 1) for k in (0, 1)]
            expected.append(round(sum(block) / 8))
        (self.folder / "expected").write_bytes(bytes(expected))
        self.read_by_zarr(self.folder / "expected")
        record = json.loads((self.project() / "shvr/volume.json").read_text())
        self.assertEqual(record["preparation"],
                         "cropped to voxels 2,4,6 to 12,14,16, intensities reversed, made 2 times smaller")
        self.assertEqual(record["source"], str(header))

    def test_labels_are_halved_by_the_most_frequent_and_never_averaged(self):
        size = (70, 40, 37)
        numbers = random.Random(9)
        values = [numbers.choice((0, 0, 3, 200)) for _ in range(math.prod(size))]
        header = Volume(size, values).write(self.folder)
        self.check("import", header, self.project(), "--labels", "--quiet")
        fine, sides = values, size
        for level in (1, 2):
            expected, half = [], [(side + 1) // 2 for side in sides]
            for z, y, x in itertools.product(*(range(side) for side in reversed(half))):
                block = [fine[i + sides[0] * (j + sides[1] * k)]
                         for k in range(2 * z, min(2 * z + 2, sides[2])) for j in range(2 * y, min(2 * y + 2, sides[1]))
                         for i in range(2 * x, min(2 * x + 2, sides[0]))]
                # Of equally frequent labels: not 0, then the smallest.
                expected.append(min(set(block), key=lambda label: (-block.count(label), label == 0, label)))
            self.check("import", self.project() / str(level), self.folder / f"level{level}", "--quiet")
            info = self.check_json("info", self.folder / f"level{level}")
            self.assertEqual((info["size"], info["mean"]), (half, sum(expected) / len(expected)))
            self.assertEqual([info["histogram"][label * 256 // 200 if label < 200 else 255] for label in (0, 3, 200)],
                             [expected.count(label) for label in (0, 3, 200)])
            fine, sides = expected, half
        attributes = json.loads((self.project() / ".zattrs").read_text())
        self.assertEqual(attributes["multiscales"][0]["type"], "mode")
        self.assertIn("image-label", attributes)
        # Importing labels as intensities gives a warning.
        warnings = self.check_json("import", self.project(), self.folder / "again")["warnings"]
        self.assertIn("--labels", " ".join(warnings))

    # Kind (Masks): a label image of another program, imported as a scan
    def test_a_label_image_that_states_nothing_is_told_of(self):
        def ball(x, y, z):
            return (x - 8) ** 2 + (y - 8) ** 2 + (z - 8) ** 2 < 30
        labels = Volume((16, 16, 16), [255 * ball(x, y, z) for z in range(16) for y in range(16) for x in range(16)])
        header = labels.write(self.folder, "labels")
        says = "looks like a label image, not like a scan: its voxels have the values 0 and 255 only"
        self.assertIn(f"warning: {header}: {says}; to load it as annotation, open its scan in the window",
                      self.check("import", header, self.project()).stderr)
        self.assertIn(says, "\n".join(self.check_json("info", header)["warnings"]))
        self.assertNotIn("looks like", self.check("import", header, self.folder / "labelled", "--labels").stderr)
        scan = Volume.noise((16, 16, 16), seed=1).write(self.folder, "scan")
        self.assertNotIn("looks like", self.check("import", scan, self.folder / "scanned").stderr)

    def test_what_would_make_new_numbers_of_labels_is_refused(self):
        header = Volume.noise((9, 8, 7), seed=1).write(self.folder)
        for option in (["--blur", "1"], ["--reverse"], ["--downscale", "2"]):
            self.check_refused("import", header, self.project(), "--labels", *option, says=["no label between two"])
        floats = Volume.noise((9, 8, 7), seed=1, voxel_type="float").write(self.folder, "floats")
        self.check_refused("import", floats, self.project(), "--labels", says=["float32", "whole numbers"])
        self.check("import", header, self.project(), "--labels", "--crop", "0,0,0,4,4,4", "--quiet")

    def test_a_blur_keeps_what_is_constant_and_can_be_of_one_axis(self):
        flat = Volume((20, 10, 10), [77] * 2000).write(self.folder, "flat")
        self.check("import", flat, self.project(), "--blur", "1.5", "--quiet")
        info = self.check_json("info", self.project())
        self.assertEqual((info["min"], info["max"]), (77, 77))
        planes = Volume((10, 10, 10), [x * 20 for _ in range(100) for x in range(10)]).write(self.folder, "planes")
        self.check("import", planes, self.project(), "--blur", "0,2,3", "--overwrite", "--quiet")
        self.read_by_zarr(self.folder / "planes.raw")

    def test_bare_voxels_and_spacing_are_described_on_the_command_line(self):
        (self.folder / "bare.raw").write_bytes(struct.pack(">60H", *range(1000, 1060)))
        info = self.check_json("import", self.folder / "bare.raw", self.project(), "--raw", "5x4x3:uint16:big",
                               "--spacing", "1,1,2.5", "--unit", "micron")
        self.assertEqual((info["spacing"], info["unit"], info["warnings"]), ([1, 1, 2.5], "um", []))
        info = self.check_json("info", self.project())
        self.assertEqual((info["min"], info["max"], info["spacing"]), (1000, 1059, [1, 1, 2.5]))

    def test_a_project_can_be_imported_drawn_and_painted(self):
        header = Volume.noise((40, 40, 40), seed=5).write(self.folder)
        self.check("import", header, self.project(), "--quiet")
        self.check("import", self.project(), self.folder / "second", "--crop", "0,0,0,33,33,33", "--quiet")
        self.assertEqual(self.check_json("info", self.folder / "second")["size"], [33, 33, 33])
        arguments = ["--size", "24x16", "--quiet", "--set", "render.detail=0", "--set", "transfer_function.points=" + json.dumps(
            [{"intensity": 100, "opacity": 0}, {"intensity": 200, "opacity": 1}])]
        self.check("render", header, "-o", self.folder / "a.png", *arguments)
        self.check("render", self.project(), "-o", self.folder / "b.png", *arguments)
        self.assertEqual((self.folder / "a.png").read_bytes(), (self.folder / "b.png").read_bytes())
        script = self.write_script("s.jsonl", [{"op": "paint", "brush": "fill", "region": "ball", "group": 3,
                                                "threshold": 0, "radius": 3, "path": [[20, 20, 20]]}, {"op": "save"}])
        painted = self.check_json("annotate", self.project(), "--script", script)
        self.assertGreater(painted["voxels_changed"], 50)
        self.assertTrue((self.project() / "labels/paint/0/0/0/0").exists())
        # Without its session the OME-Zarr still opens.
        (self.project() / "shvr/session.json").unlink()
        self.check("render", self.project(), "-o", self.folder / "c.png", *arguments)
        self.assertEqual((self.folder / "a.png").read_bytes(), (self.folder / "c.png").read_bytes())

    def test_a_moved_project_still_opens(self):
        header = Volume.noise((9, 8, 7), seed=6).write(self.folder)
        self.check("import", header, self.project(), "--quiet")
        self.project().rename(self.folder / "elsewhere")
        header.unlink()
        self.assertEqual(self.check_json("info", self.folder / "elsewhere")["size"], [9, 8, 7])

    def test_what_is_said_is_progress_and_the_result(self):
        header = Volume.noise((64, 64, 640), seed=7).write(self.folder)
        lines = self.check("import", header, self.project()).stderr.splitlines()
        for line in lines:
            self.assertRegex(line, r"^(importing .*: (\d+ %, [\d.]+ MB/s, .* left|\d+ s so far)|warning: .*|.*: 64 x 64 x 640 voxels in 6 levels, .*)$")
        self.assertEqual(self.check("import", header, self.project(), "--overwrite", "--quiet").stderr, "")

    def test_on_a_terminal_one_line_shows_share_rate_and_time_left_and_goes_away(self):
        size = (128, 128, 256)
        header = Volume(size, [], voxel_type="uint8").write(self.folder)
        (self.folder / "volume.raw").write_bytes(random.Random(9).randbytes(math.prod(size)))
        ours, theirs = pty.openpty()
        process = subprocess.Popen([SHVR, "import", header, self.project(), "--blur", "12", "--threads", "1"],
                                   stdout=subprocess.DEVNULL, stderr=theirs, env=ENVIRONMENT)
        os.close(theirs)
        shown = b""
        try:
            while piece := os.read(ours, 65536):
                shown += piece
        except OSError:  # the other end is closed
            pass
        os.close(ours)
        self.assertEqual(process.wait(timeout=60), 0)
        lines = shown.decode().split("\r\x1b[K")
        told = [line for line in lines[1:-1] if "%" in line]  # on a fast machine it takes less than a second
        for line in told:
            self.assertRegex(line, r"^importing .*: \d+ %, [\d.]+ MB/s, (\d+ min )?\d+ s left$")
        shares = [int(line.rsplit(": ", 1)[1].split()[0]) for line in told]
        self.assertEqual(shares, sorted(shares))
        self.assertNotIn("%", lines[-1])

    def test_a_report_that_cannot_be_written_is_one_sentence_and_the_project_is_whole(self):
        header = Volume.noise((9, 8, 7), seed=10).write(self.folder)
        with open("/dev/full", "w") as full:
            result = subprocess.run([SHVR, "import", header, self.project(), "--json", "--quiet"], stdout=full,
                                    stderr=subprocess.PIPE, text=True, env=ENVIRONMENT, timeout=60)
        self.assertEqual((result.returncode, result.stderr), (1, "shvr: standard output: cannot be written\n"))
        self.assertEqual(self.check_json("info", self.project())["size"], [9, 8, 7])


class Refusals(CliTest):
    def test_wrong_usage(self):
        header = Volume.noise((9, 8, 7), seed=1).write(self.folder)
        project = self.folder / "project"
        for option, values in {"--crop": ["1,2,3", "a,b,c,d,e,f", "1,2,3,4,5,6,7", ""], "--blur": ["-1", "nan", "1,2", "101", "x"],
                               "--downscale": ["0", "65", "x"], "--spacing": ["1,1", "0,1,1", "1,1,inf", "x"],
                               "--raw": ["9x8", "9x8x7:uint7"], "--threads": ["-1"]}.items():
            for value in values:
                if option == "--crop" and value == "":
                    continue
                with self.subTest(option=option, value=value):
                    self.check_refused("import", header, project, f"{option}={value}", status=2)
        self.check_refused("import", header, status=2)
        self.assertFalse(project.exists() or (self.folder / "project.part").exists())

    def test_the_world(self):
        header = Volume.noise((9, 8, 7), seed=1).write(self.folder)
        project = self.folder / "project"
        self.check_refused("import", self.folder / "missing.nhdr", project, says=["missing.nhdr"])
        for volume in str(header), "https://example.org/scan.zarr":
            session = self.write_json("scan.json", {"shvr_session": 1, "volume": {"path": volume}})
            self.check_refused("import", session, project, says=["scan.json: is a session; expected a volume", "volume.path"])
        self.check_refused("import", header, project, "--crop", "0,0,0,9,8,8", says=["0,0,0 to 9,8,7"])
        self.check_refused("import", header, self.folder / "no/project", says=["no/project.part", "No such file"])
        self.check("import", header, project, "--quiet")
        self.check_refused("import", header, project, says=["already exists", "--overwrite"])
        (self.folder / "mine").mkdir()
        (self.folder / "mine/text").write_text("keep")
        self.check_refused("import", header, self.folder / "mine", "--overwrite", says=["is not a project"])
        self.assertEqual((self.folder / "mine/text").read_text(), "keep")
        # Nor does a project that holds foreign files.
        (project / "notes.txt").write_text("keep")
        self.check_refused("import", header, project, "--overwrite", says=["holds notes.txt, no part of a project"])
        self.assertEqual((project / "notes.txt").read_text(), "keep")
        (project / "notes.txt").unlink()
        self.check("import", header, project, "--overwrite", "--quiet")
        with open(self.folder / "volume.raw", "r+b") as voxels:
            voxels.truncate(100)
        self.check_refused("import", header, self.folder / "other", says=["100", "504"])

    def test_channels_are_chosen(self):
        several = Path("tests/data/zarr/image_tczyx")
        self.check_refused("import", several, self.folder / "project", says=["3 channels", "DAPI"])
        self.check("import", several, self.folder / "project", "--channel", "GFP", "--frame", 2, "--quiet")
        self.assertEqual(self.check_json("info", self.folder / "project")["min"], 1500 - 99)


class EndingEarly(CliTest):
    """A partial project never counts as a project, and the same command resumes it."""

    @classmethod
    def setUpClass(cls):
        # Enough slabs of 64 slices for several intermediate states.
        size = (80, 70, 64 * 20)
        temporary = tempfile.TemporaryDirectory(prefix="shvr-cli-")
        cls.addClassCleanup(temporary.cleanup)
        folder = Path(temporary.name)
        cls.header = Volume(size, [], voxel_type="uint16").write(folder)
        (folder / "volume.raw").write_bytes(random.Random(8).randbytes(2 * math.prod(size)))
        cls.options = ["--blur", "0.6", "--threads", "2"]
        begin = time.monotonic()
        assert run("import", cls.header, folder / "project", *cls.options, "--quiet").returncode == 0
        cls.seconds = time.monotonic() - begin
        cls.expected = content_of(folder / "project")

    def setUp(self):
        super().setUp()
        self.arguments = [self.header, self.folder / "project", *self.options]

    def clear(self):
        for name in ("project", "project.part"):
            shutil.rmtree(self.folder / name, ignore_errors=True)

    def start(self, more={}, **options):
        # A signal that a test sends is no fault for a sanitizer to report.
        environment = {**ENVIRONMENT, **more}
        for name in ("ASAN_OPTIONS", "TSAN_OPTIONS"):
            environment[name] = environment.get(name, os.environ.get(name, "")) + ":handle_segv=0"
        return subprocess.Popen([SHVR, "import", *map(str, self.arguments)], stdout=subprocess.PIPE,
                                stderr=subprocess.PIPE, text=True, env=environment, **options)

    def chunks(self):
        return sum(len(files) for _, _, files in os.walk(self.folder / "project.part"))

    def wait_for_chunks(self, process, chunks):
        while process.poll() is None and self.chunks() < chunks:
            time.sleep(0.002)

    def check_finished(self):
        result = self.check_json("import", *self.arguments)
        self.assertEqual(content_of(self.folder / "project"), self.expected)
        self.assertFalse((self.folder / "project.part").exists())
        return result

    def test_killed_anywhere_it_goes_on_and_gives_the_same_bytes(self):
        resumed = killed = 0
        early, more = (1, 8, 22, 38), (3, 15, 30, 46, 60, 80)
        for chunks in (*early, *more) if IS_SLOW else early:
            with self.subTest(chunks=chunks):
                process = self.start()
                self.wait_for_chunks(process, chunks)
                process.kill()
                process.communicate()
                killed += process.returncode == -signal.SIGKILL
                if not (self.folder / "project").exists():
                    resumed += self.check_finished()["resumed"]
                self.clear()
        self.assertGreater(killed, 3 if IS_SLOW else 1)
        self.assertGreater(resumed, 2 if IS_SLOW else 0)

    def test_killed_again_and_again_it_gets_there(self):
        for _ in range(30):
            process = self.start()
            self.wait_for_chunks(process, self.chunks() + 10)
            process.kill()
            process.communicate()
            if (self.folder / "project").exists():
                break
        if not (self.folder / "project").exists():
            self.check_finished()
        self.assertEqual(content_of(self.folder / "project"), self.expected)

    def test_ctrl_c_leaves_what_is_done_and_says_so(self):
        for number in (signal.SIGINT, signal.SIGTERM):
            process = self.start()
            self.wait_for_chunks(process, 20)
            process.send_signal(number)
            output, said = process.communicate(timeout=60)
            if process.returncode == 0:  # it finished first
                self.clear()
                continue
            self.assertEqual((process.returncode, output), (1, ""))
            said = [line for line in said.splitlines() if line.startswith("shvr: ")]
            self.assertEqual(said, [f"shvr: {self.folder}/project.part: the import was stopped; what is done is kept, "
                                    "and the same command goes on from there; rm -r removes it"])
            self.assertFalse((self.folder / "project").exists())
            self.check_finished()
            self.clear()

    def test_ctrl_c_at_any_time_leaves_nothing_or_what_can_be_gone_on_with(self):
        for step in range(8) if IS_SLOW else (0, 3, 6):
            with self.subTest(step=step):
                process = self.start()
                time.sleep(self.seconds * step / 7)
                process.send_signal(signal.SIGINT)
                _, said = process.communicate(timeout=60)
                # Before there is anything to keep it ends at once, like any program.
                self.assertIn(process.returncode, (0, 1, -signal.SIGINT))
                if process.returncode == 1:
                    self.assertIn("the import was stopped; what is done is kept", said.splitlines()[-1])
                is_there = (self.folder / "project").exists()
                # The signal may also come when all is done and the program is about to end: then the project is whole.
                if process.returncode != -signal.SIGINT:
                    self.assertEqual(is_there, process.returncode == 0)
                if is_there:
                    self.assertEqual(content_of(self.folder / "project"), self.expected)
                else:
                    self.check_finished()
                self.clear()

    def test_a_crash_leaves_what_is_done(self):
        process = self.start()
        self.wait_for_chunks(process, 30)
        process.send_signal(signal.SIGSEGV)
        process.communicate(timeout=60)
        if process.returncode != 0:
            self.assertEqual(process.returncode, -signal.SIGSEGV)
            self.assertFalse((self.folder / "project").exists())
            self.check_finished()

    def test_files_that_may_not_grow_are_one_sentence(self):
        def limit():
            resource.setrlimit(resource.RLIMIT_FSIZE, (200000, 200000))

        process = self.start(preexec_fn=limit)
        _, said = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 1)
        self.assertRegex(said.splitlines()[-1], r"^shvr: .*/project.part/0/.*: cannot be written: File too large; "
                                                r"what is done is kept in .*/project.part, and the same command goes on from "
                                                r"there; rm -r removes it$")
        self.check_finished()

    def test_a_full_disk_is_one_sentence(self):
        disk = self.folder / "disk"
        disk.mkdir()
        mount = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=4k", "none", disk], capture_output=True)
        if mount.returncode != 0:
            self.skipTest("this process may not mount a file system")
        try:
            self.arguments[1] = disk / "project"
            # The disk is full at the first small file, at the first chunks, half-way, and near the end.
            for size in ("4k", "64k", "512k", "4m", "8m", "15m"):
                subprocess.run(["mount", "-o", f"remount,size={size}", disk], check=True)
                said = self.check_refused("import", *self.arguments, "--quiet",
                                          says=["disk/project.part", "cannot be written: No space left on device", "kept"])
                self.assertEqual(len(said.splitlines()), 1)
                self.assertEqual([path.name for path in disk.iterdir()], ["project.part"])
            subprocess.run(["mount", "-o", "remount,size=64m", disk], check=True)
            self.assertTrue(self.check_json("import", *self.arguments)["resumed"])
            self.assertEqual({name: content for name, content in content_of(disk / "project").items()}, self.expected)
        finally:
            subprocess.run(["umount", disk], check=True)

    def test_two_at_once_are_one_and_a_sentence(self):
        self.check_two_at_once({})

    # Kind (bad input and lost work): two imports of one name on a network file system, which locks files and no folders
    def test_two_at_once_where_only_files_have_locks(self):
        self.check_two_at_once({"LD_PRELOAD": str(Path(SHVR).resolve().parent / "stubs" / "libno_locks.so"),
                                "SHVR_LOCKS": "files", "ASAN_OPTIONS": "verify_asan_link_order=0"})

    def check_two_at_once(self, more):
        process = self.start(more)
        self.wait_for_chunks(process, 2)
        os.kill(process.pid, signal.SIGSTOP)
        try:
            if (self.folder / "project.part").exists():
                with unittest.mock.patch.dict(ENVIRONMENT, more):
                    self.check_refused("import", *self.arguments, says=["another process is importing into it"])
        finally:
            os.kill(process.pid, signal.SIGCONT)
        process.communicate(timeout=60)
        self.assertEqual(process.returncode, 0)
        self.assertEqual(content_of(self.folder / "project"), self.expected)
        self.assertEqual(sorted(path.name for path in self.folder.glob(".*")), [])
        self.assertFalse((self.folder / "project.part").exists())


class Usage(CliTest):
    def test_help_shows_an_example_and_the_order(self):
        text = self.check("import", "--help").stdout
        self.assertIn("Example:\n  shvr import ", text)
        for word in ("--json", "--quiet", "crop, reverse, blur, downscale"):
            self.assertIn(word, text)
        self.assertEqual(run("import").returncode, 2)


if __name__ == "__main__":
    unittest.main()
