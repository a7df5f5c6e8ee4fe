"""OME-Zarr 0.5 and zipped OME-Zarr: what is written, as an independent reader sees it (tests/support/zarr3.py), and that
projects and archives give the pictures, masks and measures that 0.4 gives."""
import json
import math
import os
import random
import shutil
import struct
import subprocess
import time
import unittest
from array import array
from pathlib import Path

from harness import ENVIRONMENT, SHVR, CliTest, Volume
from test_import import content_of, python_with_zarr

SUPPORT = Path(__file__).resolve().parents[1] / "support"
DATA = Path(__file__).resolve().parents[1] / "data"
ABSENT = 2 ** 64 - 1

# Runs in an interpreter that has numpy and numcodecs. Level 0 is compared with bare voxels, each level with the mean of
# the one before or, for labels, by their rule: the most frequent label; of equally frequent ones not 0, and of those the
# smallest.
READER = """
import json, sys
import numpy
import zarr3
values = zarr3.read_folder(sys.argv[1])
ome = zarr3.read_group(values)["ome"]
entry = ome["multiscales"][0]
read = [zarr3.read_array(values, dataset["path"]) for dataset in entry["datasets"]]
arrays = [array for array, _ in read]
problems = [] if "multiscales" in ome and "version" not in entry else ["misplaced version"]
bare = numpy.fromfile(sys.argv[2], arrays[0].dtype).reshape(arrays[0].shape) if len(sys.argv) > 2 else arrays[0]
if not numpy.array_equal(bare, arrays[0]):
    problems.append("level 0 differs")
for number, (fine, coarse) in enumerate(zip(arrays, arrays[1:])):
    for place in numpy.ndindex(coarse.shape):
        part = fine[tuple(slice(2 * i, 2 * i + 2) for i in place)]
        if entry["type"] == "mode":
            labels, counts = numpy.unique(part, return_counts=True)
            most = [int(label) for label, count in zip(labels, counts) if count == counts.max()]
            expected = min(most, key=lambda label: (label == 0, label))
        else:
            expected = part.astype("f8").mean()
            expected = numpy.rint(expected) if fine.dtype.kind != "f" else fine.dtype.type(expected)
        if coarse[place] != expected:
            problems.append(f"level {number + 1} at {place}")
print(json.dumps({"problems": problems[:5], "ome": ome, "attributes": zarr3.read_group(values),
                  "metadata": [metadata for _, metadata in read], "sum": int(arrays[0].astype("i8").sum())}))
"""
# Packs a folder as the RFC recommends, or otherwise: deflated, in 64 bits, streamed.
PACKER = """
import json, sys
import zarr3
values = zarr3.read_folder(sys.argv[1])
open(sys.argv[2], "wb").write(zarr3.zip_bytes(values, **json.loads(sys.argv[3])))
"""


def crc32c(data):
    """RFC 3720, bit by bit."""
    crc = 0xFFFFFFFF
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = crc >> 1 ^ (0x82F63B78 if crc & 1 else 0)
    return crc ^ 0xFFFFFFFF


def independent(test, program, *arguments):
    python = python_with_zarr()
    if python is None:
        test.skipTest("no interpreter here has numcodecs")
    result = subprocess.run([python, "-c", program, *map(str, arguments)], capture_output=True, text=True, timeout=120,
                            env={**os.environ, "PYTHONPATH": str(SUPPORT)})
    test.assertEqual(result.returncode, 0, result.stderr)
    return result.stdout


def read(test, folder, *arguments):
    found = json.loads(independent(test, READER, folder, *arguments))
    test.assertEqual(found["problems"], [])
    return found


class Written(CliTest):
    def test_every_level_and_all_metadata_of_an_import(self):
        for voxel_type, high in (("uint8", 255), ("int16", 30000), ("uint16", 65535), ("float", 1000)):
            with self.subTest(voxel_type=voxel_type):
                header = Volume.noise((67, 9, 13), seed=2, high=high, voxel_type=voxel_type,
                                      spacing=(0.5, 0.75, 2)).write(self.folder)
                project = self.folder / "project"
                self.check("import", header, project, "--ome-zarr", "0.5", "--overwrite", "--unit", "um", "--quiet")
                found = read(self, project, self.folder / "volume.raw")
                ome = found["ome"]
                self.assertEqual(ome["version"], "0.5")
                self.assertEqual(ome["multiscales"][0]["axes"],
                                 [{"name": name, "type": "space", "unit": "micrometer"} for name in "zyx"])
                for level, dataset in enumerate(ome["multiscales"][0]["datasets"]):
                    self.assertEqual(dataset["coordinateTransformations"], [
                        {"type": "scale", "scale": [2 ** level * side for side in (2, 0.75, 0.5)]},
                        {"type": "translation",
                         "translation": [0.5 * (2 ** level - 1) * side for side in (2, 0.75, 0.5)]}])
                first = found["metadata"][0]
                self.assertEqual(first["dimension_names"], ["z", "y", "x"])
                self.assertEqual(first["chunk_grid"]["configuration"]["chunk_shape"], [64, 64, 64])
                self.assertEqual(first["chunk_key_encoding"], {"name": "default", "configuration": {"separator": "/"}})
                self.assertEqual([codec["name"] for codec in first["codecs"]], ["bytes", "blosc"])
                self.assertEqual([path for path in project.rglob(".z*") if "shvr" not in path.parts], [])

    def test_0_4_is_the_default_and_only_the_dialect_differs(self):
        header = Volume.noise((70, 66, 65), seed=1, voxel_type="uint16", high=900).write(self.folder)
        plain, old, new = (self.folder / name / "project" for name in ("plain", "old", "new"))
        for project in (plain, old, new):
            project.parent.mkdir()
        self.check("import", header, plain)
        self.check("import", header, old, "--ome-zarr", "0.4")
        report = self.check_json("import", header, new, "--ome-zarr", "0.5")
        self.assertEqual(content_of(plain), content_of(old))
        self.assertEqual(list(plain.rglob("zarr.json")), [])
        before, after = content_of(old), content_of(new)
        chunks = {name: data for name, data in before.items() if name[0].isdigit() and ".z" not in name}
        self.assertEqual(len(chunks), report["bricks_stored"])
        for name, data in chunks.items():
            level, rest = name.split("/", 1)
            self.assertEqual(after[f"{level}/c/{rest}"], data, name)
        # All of SHVR's own data is the same.
        for name in before:
            if name.startswith("shvr/"):
                self.assertEqual(after[name], before[name], name)
        told, again = self.check_json("info", old), self.check_json("info", new)
        for key in told:
            if key not in ("input", "mask"):
                self.assertEqual(again[key], told[key], key)

    def test_versions_that_are_not_written_are_wrong_usage(self):
        header = Volume.noise((8, 8, 8), seed=1).write(self.folder)
        for version in ("0.3", "0.6", "", "v0.5"):
            self.check("import", header, self.folder / "project", "--ome-zarr", version, status=2)
        self.assertFalse((self.folder / "project").exists())

    def test_an_import_in_another_version_begins_anew_and_replaces_the_project(self):
        header = Volume.noise((40, 40, 40), seed=4).write(self.folder)
        project = self.folder / "project"
        for version, there in (("0.5", "zarr.json"), ("0.4", ".zattrs"), ("0.5", "zarr.json")):
            self.check("import", header, project, "--ome-zarr", version, "--overwrite")
            self.assertTrue((project / there).exists())
            self.assertEqual(sum((project / name).exists() for name in ("zarr.json", ".zattrs")), 1)
        self.check_refused("import", header, project, says=["already exists"])


class Projects(CliTest):
    """The same work in a project of either version."""

    def setUp(self):
        super().setUp()
        header = Volume.noise((40, 36, 34), seed=7, spacing=(0.5, 1, 2)).write(self.folder)
        self.projects = {}
        for version in ("0.4", "0.5"):
            self.projects[version] = self.folder / version / "project"
            self.projects[version].parent.mkdir()
            self.check("import", header, self.projects[version], "--ome-zarr", version, "--unit", "mm")
        self.script = self.write_script("script.jsonl", [
            {"op": "paint", "brush": "fill", "region": "box", "group": 3, "threshold": 100, "radius": 6,
             "path": [[9, 9, 9], [20, 18, 17]]},
            {"op": "node", "at": [5, 5, 5], "radius": 2, "group": 1}, {"op": "node", "at": [20, 9, 9], "radius": 2},
            {"op": "undo"}, {"op": "redo"}, {"op": "save"}])

    def test_pictures_annotations_and_exports_are_the_same(self):
        made = {}
        for version, project in self.projects.items():
            out = project.parent
            self.check("annotate", project, "--script", self.script)
            self.check("render", project, "--set", "render.size=[48,32]", "-o", out / "a.png")
            self.check("export", project, "--mask", out / "a.mask", "--trace", out / "a.swc", "--metrics", out / "a.csv")
            labels = self.check_json("export", project, "--labels")
            self.assertEqual(labels["written"], [str(project / "labels" / "mask")])
            parts = self.check_json("label", project, "--threshold", 240, "-o", project / "labels" / "parts")
            for key in ("seconds", "label_seconds", "megavoxels_per_second", "output", "peak_bytes"):
                parts.pop(key)
            made[version] = [(out / f"a.{form}").read_bytes() for form in ("png", "mask", "swc", "csv")] + [parts]
        self.assertEqual(made["0.4"], made["0.5"])

    def test_labels_are_of_the_version_of_their_image_and_are_known_again(self):
        project = self.projects["0.5"]
        self.check("annotate", project, "--script", self.script)
        self.check("export", project, "--labels")
        self.check("label", project, "--threshold", 250, "-o", project / "labels" / "parts")
        group = json.loads((project / "labels" / "zarr.json").read_text())
        self.assertEqual(group, {"zarr_format": 3, "node_type": "group",
                                 "attributes": {"ome": {"version": "0.5", "labels": ["paint", "mask", "parts"]}}})
        painted = self.folder / "painted.mask"
        self.check("export", project, "--mask", painted)
        read(self, project / "labels" / "paint", painted)
        found = read(self, project / "labels" / "mask", painted)
        label = found["ome"]["image-label"]
        self.assertEqual(label["version"], "0.5")
        self.assertEqual(label["source"], {"image": "../../"})
        self.assertEqual([color["label-value"] for color in label["colors"]], [3])
        self.assertTrue(found["attributes"]["shvr"]["image"].startswith("xxh3-128:"))
        read(self, project / "labels" / "parts")
        self.assertEqual(list(project.rglob(".z*")), [])
        # Read back by its own volume; a mask of another volume is refused.
        labels = project / "labels" / "mask"
        self.check("export", project, "--set", f'annotation.mask="{labels}"', "--mask", self.folder / "again.mask")
        self.assertEqual((self.folder / "again.mask").read_bytes(), painted.read_bytes())
        other = Volume.noise((40, 36, 34), seed=8, spacing=(0.5, 1, 2)).write(self.folder, "other")
        self.check("import", other, self.folder / "third", "--unit", "mm")
        self.check_refused("export", self.folder / "third", "--set", f'annotation.mask="{labels}"',
                           says=["zarr.json", "painted on other voxels"])
        # One hierarchy, one version.
        for version, wrong in (("0.5", "0.4"), ("0.4", "0.5")):
            self.check_refused("export", self.projects[version], "--labels", "--ome-zarr", wrong,
                               says=[f"is an OME-Zarr {version}", f"were asked for as {wrong}"])
        self.check("export", project, "--labels", "--ome-zarr", "0.5")

    def test_a_label_image_alone_keeps_its_version_until_another_is_asked_for(self):
        project, alone = self.projects["0.4"], self.folder / "alone.zarr"
        self.check("annotate", project, "--script", self.script)
        self.check("export", project, "--mask", alone, "--ome-zarr", "0.5")
        self.check("export", project, "--mask", self.folder / "painted.mask")
        read(self, alone, self.folder / "painted.mask")
        # Painted and saved there.
        more = self.write_script("more.jsonl", [
            {"op": "paint", "brush": "fill", "region": "box", "group": 7, "threshold": 0, "radius": 2,
             "path": [[30, 30, 30]]}, {"op": "save"}])
        self.check("annotate", project, "--script", more, "--set", f'annotation.mask="{alone}"')
        found = read(self, alone)
        self.assertEqual([color["label-value"] for color in found["ome"]["image-label"]["colors"]], [3, 7])
        # The journal saved elsewhere since, so the project's own mask is an earlier one.
        self.check("export", project, "--mask", alone, "--ome-zarr", "0.4", "--believe", "journal")
        self.assertTrue((alone / ".zattrs").exists())
        self.assertFalse((alone / "zarr.json").exists())


class Shards(CliTest):
    """shvr import --ome-zarr 0.5 --shards: up to 8 x 8 x 8 chunks in a file."""

    def shard(self, path, chunks):
        """{chunk number in the shard: bytes}; the index lies at the end, behind the chunks, with its CRC-32C."""
        content = path.read_bytes()
        index = content[-16 * chunks - 4:]
        self.assertEqual(int.from_bytes(index[-4:], "little"), crc32c(index[:-4]))
        parts = [struct.unpack_from("<QQ", index, 16 * i) for i in range(chunks)]
        self.assertEqual(sum(size for _, size in parts if size != ABSENT), len(content) - len(index))
        return {i: content[at:at + size] for i, (at, size) in enumerate(parts) if at != ABSENT}

    def test_they_hold_the_chunks_of_a_project_without_them(self):
        size = (520, 70, 66)  # 9 x 2 x 2 chunks: two shards along x
        numbers = random.Random(1).randbytes(math.prod(size))  # 2.4 million: too many for Volume.noise
        for voxel_type, letter in (("uint16", "H"), ("float", "f")):
            with self.subTest(voxel_type=voxel_type):
                header = Volume(size, [], voxel_type=voxel_type).write(self.folder)
                (self.folder / "volume.raw").write_bytes(array(letter, list(numbers)).tobytes())
                plain, packed = self.folder / "plain" / "project", self.folder / "packed" / "project"
                for project, options in ((plain, []), (packed, ["--shards"])):
                    project.parent.mkdir(exist_ok=True)
                    report = self.check_json("import", header, project, "--ome-zarr", "0.5", "--overwrite", *options)
                before, after = content_of(plain), content_of(packed)
                self.assertEqual(sorted(name for name in after if name.startswith("0/c/")), ["0/c/0/0/0", "0/c/0/0/1"])
                found = {}
                for number, along in ((0, 8), (1, 1)):
                    for i, content in self.shard(packed / "0" / "c" / "0" / "0" / str(number), 8 * 2 * 2).items():
                        z, y, x = i // 16, i // 8 % 2, i % 8
                        self.assertLess(x, along)
                        found[f"0/c/{z}/{y}/{8 * number + x}"] = content
                self.assertEqual(found, {name: data for name, data in before.items() if name.startswith("0/c/")})
                self.assertEqual(report["bytes"], sum(map(len, after.values())))
                # All of SHVR's own data is the same, except the metadata of levels.
                for name in before:
                    if name.startswith("shvr/"):
                        self.assertEqual(after[name], before[name], name)
                self.assertEqual(set(after) - set(before), {name for name in after if "/c/" in name} - set(before))
                told, again = self.check_json("info", plain), self.check_json("info", packed)
                for key in told:
                    if key not in ("input", "mask"):
                        self.assertEqual(again[key], told[key], key)
                for project in (plain, packed):
                    self.check("render", project, "--size", "32x24", "-o", project.parent / "a.png", "--quiet")
                self.assertEqual((plain.parent / "a.png").read_bytes(), (packed.parent / "a.png").read_bytes())

    def test_an_independent_reader_reads_them(self):
        header = Volume.noise((130, 66, 9), seed=2, high=30000, voxel_type="int16").write(self.folder)
        self.check("import", header, self.folder / "project", "--ome-zarr", "0.5", "--shards")
        found = read(self, self.folder / "project", self.folder / "volume.raw")
        first, last = found["metadata"][0], found["metadata"][-1]
        self.assertEqual(first["chunk_grid"]["configuration"]["chunk_shape"], [64, 128, 192])
        self.assertEqual([codec["name"] for codec in first["codecs"]], ["sharding_indexed"])
        configuration = first["codecs"][0]["configuration"]
        self.assertEqual(configuration["chunk_shape"], [64, 64, 64])
        self.assertEqual([codec["name"] for codec in configuration["index_codecs"]], ["bytes", "crc32c"])
        self.assertEqual(configuration["index_location"], "end")
        self.assertEqual([codec["name"] for codec in last["codecs"]], ["bytes", "blosc"])  # one chunk needs no shard

    def test_chunks_of_zeros_are_left_out_and_shards_of_them_too(self):
        size = (64 * 9, 64, 64)
        volume = Volume(size, [])
        header = volume.write(self.folder)
        voxels = bytearray(64 ** 3 * 9)
        voxels[50] = 7
        (self.folder / "volume.raw").write_bytes(voxels)
        report = self.check_json("import", header, self.folder / "project", "--ome-zarr", "0.5", "--shards")
        self.assertEqual(list(self.shard(self.folder / "project" / "0" / "c" / "0" / "0" / "0", 8)), [0])
        self.assertFalse((self.folder / "project" / "0" / "c" / "0" / "0" / "1").exists())
        self.assertEqual(report["bytes"], sum(map(len, content_of(self.folder / "project").values())))
        self.assertEqual(self.check_json("info", self.folder / "project")["max"], 7)

    def test_a_changed_byte_of_a_chunk_or_of_the_index_is_found(self):
        header = Volume.noise((128, 64, 64), seed=1).write(self.folder)
        project = self.folder / "project"
        self.check("import", header, project, "--ome-zarr", "0.5", "--shards")
        shard = project / "0" / "c" / "0" / "0" / "0"
        whole = shard.read_bytes()
        for at, says in ((100, "another program changed it"), (len(whole) - 10, "its CRC-32C is")):
            shard.write_bytes(whole[:at] + bytes([whole[at] ^ 1]) + whole[at + 1:])
            self.check_refused("label", project, "--threshold", 3, says=[str(shard), says])

    def test_killed_while_shards_are_packed_it_goes_on_and_gives_the_same_bytes(self):
        size = (80, 70, 64 * 20)
        header = Volume(size, [], voxel_type="uint16").write(self.folder)
        (self.folder / "volume.raw").write_bytes(random.Random(8).randbytes(2 * math.prod(size)))
        project, part = self.folder / "project", self.folder / "project.part"
        arguments = [header, project, "--ome-zarr", "0.5", "--shards", "--threads", "1"]
        self.check("import", *arguments, "--quiet")
        expected = content_of(project)
        killed = 0
        for _ in range(10):
            shutil.rmtree(project, ignore_errors=True)
            process = subprocess.Popen([SHVR, "import", *map(str, arguments)], stdout=subprocess.PIPE,
                                       stderr=subprocess.PIPE, env=ENVIRONMENT)
            while process.poll() is None and not (part / "0" / "c" / "0" / "0" / "0").exists():
                time.sleep(0.001)
            process.kill()
            process.communicate()
            if not project.exists():
                killed += (part / "0" / "c" / "0" / "0" / "0").exists()
                self.check("import", *arguments, "--quiet")
            self.assertEqual(content_of(project), expected)
            if killed == 2:
                break
        self.assertGreater(killed, 0)

    def test_0_4_has_none(self):
        header = Volume.noise((8, 8, 8), seed=1).write(self.folder)
        for version in ([], ["--ome-zarr", "0.4"]):
            self.check_refused("import", header, self.folder / "project", "--shards", *version, status=2,
                               says=["--ome-zarr 0.5"])
        self.assertFalse((self.folder / "project").exists())


class Archives(CliTest):
    FORMS = {"stored": {}, "zip64": {"zip64": True}, "deflated": {"deflate": True}, "streamed": {"stream": True}}

    def pack(self, folder, name, **form):
        independent(self, PACKER, folder, self.folder / name, json.dumps(form))
        return self.folder / name

    def check_whole_project(self, archive, project):
        """Only its image is read, which every command says, quiet ones too; and nothing empty is exported."""
        says = [str(archive), "is a project in an archive", "unpack the archive"]
        for command in (["info"], ["render", "-o", self.folder / "a.png", "--size", "8x8"],
                        ["label", "--threshold", 2900]):
            said = self.check(command[0], archive, *command[1:], "--quiet").stderr
            for words in says:
                self.assertIn(words, said)
            self.assertEqual(said.count("unpack the archive"), 1, said)
        before = archive.read_bytes()
        for option, name in (("--mask", "a.nrrd"), ("--trace", "a.swc"), ("--offset", "a.offset")):
            self.check_refused("export", archive, option, self.folder / name, "--quiet", says=says)
            self.assertFalse((self.folder / name).exists())
        script = self.write_script("script.jsonl", [
            {"op": "paint", "brush": "fill", "region": "box", "group": 1, "threshold": -200, "radius": 1,
             "path": [[2, 2, 1]]}, {"op": "save"}])
        self.check_refused("annotate", archive, "--script", script, "--quiet", says=["annotation is kept only in projects"])
        self.assertEqual(archive.read_bytes(), before)
        self.assertNotIn("archive", self.check("info", project).stderr)

    def test_an_archive_gives_the_pictures_and_figures_of_its_folder(self):
        header = Volume.noise((70, 66, 65), seed=1, voxel_type="int16", high=3000, spacing=(0.5, 0.5, 2)).write(self.folder)
        project = self.folder / "scan.zarr"
        self.check("import", header, project, "--ome-zarr", "0.5", "--unit", "um")
        whole = self.pack(project, "project.ozx")
        self.check_whole_project(whole, project)
        shutil.rmtree(project / "shvr")  # what an archive of another program lacks
        settings = ["--set", "render.size=[48,32]"]
        self.check("render", project, *settings, "-o", self.folder / "a.png")
        told = self.check_json("info", project)
        expected = self.check_json("label", project, "--threshold", 2900, "-o", self.folder / "b.nrrd")
        for name, form in self.FORMS.items():
            with self.subTest(form=name):
                archive = self.pack(project, f"{name}.ozx", **form)
                again = self.check_json("info", archive)
                self.assertEqual((again["levels"], again["format"]), (3, "ome-zarr"))
                for key in told:
                    if key not in ("input", "seconds", "name"):
                        self.assertEqual(again[key], told[key], key)
                self.check("render", archive, *settings, "-o", self.folder / "b.png")
                self.assertEqual((self.folder / "b.png").read_bytes(), (self.folder / "a.png").read_bytes())
                found = self.check_json("label", archive, "--threshold", 2900, "-o", self.folder / "a.nrrd")
                self.assertEqual(found["components"], expected["components"])
                self.assertEqual((self.folder / "a.nrrd").read_bytes(), (self.folder / "b.nrrd").read_bytes())
                self.check("import", archive, self.folder / f"from {name}", "--quiet")
                self.check_json("info", self.folder / f"from {name}")

    def test_shards_of_other_writers_are_imported(self):
        expected = self.check_json("info", DATA / "zarr3" / "image_04")
        for name in ("layout_ngff_zarr", "layout_tensorstore", "series"):
            for form in (name, f"{name}.ozx"):
                with self.subTest(form=form):
                    self.check("import", DATA / "zarr3" / form, self.folder / "project", "--overwrite", "--quiet",
                               "--ome-zarr", "0.5")
                    found = self.check_json("info", self.folder / "project")
                    for key in ("size", "spacing", "unit", "min", "max", "mean", "type"):
                        self.assertEqual(found[key], expected[key], key)

    def test_a_mask_in_an_archive_is_read_and_never_written(self):
        session = self.write_session(volume={"path": str(DATA / "zarr3" / "with_labels")})
        labels = DATA / "zarr3" / "with_labels.ozx" / "labels" / "cells"
        before = (DATA / "zarr3" / "with_labels.ozx").read_bytes()
        mask = f'annotation.mask="{labels}"'
        voxels = self.check_json("export", session, "--set", mask)["voxels_by_group"]
        self.assertEqual(voxels, {"3": sum(x + 10 * y + 100 * z - 99 > 100 for z in range(3) for y in range(4)
                                           for x in range(5))})
        script = self.write_script("script.jsonl", [
            {"op": "paint", "brush": "fill", "region": "box", "group": 1, "threshold": -200, "radius": 1,
             "path": [[2, 2, 1]]}, {"op": "save"}])
        self.check_refused("annotate", session, "--script", script, "--set", mask, "--quiet",
                           says=["lies in an archive, which is only read"])
        self.assertEqual((DATA / "zarr3" / "with_labels.ozx").read_bytes(), before)
        self.check_refused("export", session, "--set", f'annotation.mask="{labels}x"', says=["cellsx", "zarr.json"])

    def test_what_cannot_be_read_is_refused_in_a_sentence(self):
        for name, says in {"version_later": ["\"0.6\"", "\"0.5\""], "version_later.ozx": ["\"0.6\"", "zarr.json"],
                           "zip_in_a_folder.ozx": ["no zarr.json at its root"],
                           "zip_two_images.ozx": ["several images", "zip_two_images.ozx/0"],
                           "zip_encrypted.ozx": ["encrypted"], "zip_bomb.ozx": ["4194304"]}.items():
            with self.subTest(name=name):
                for command in (["info"], ["import", self.folder / "project"]):
                    self.check_refused(command[0], DATA / "zarr3" / name, *command[1:], says=says)
        self.check("info", DATA / "zarr3" / "zip_two_images.ozx" / "1")
        shutil.rmtree(self.folder / "project.part", ignore_errors=True)


if __name__ == "__main__":
    unittest.main()
