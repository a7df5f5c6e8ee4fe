"""Groups and offsets in sparse OME-Zarr: new projects, projects of earlier versions, and what a save costs."""
import json
import shutil
import subprocess
import tarfile
import unittest
from pathlib import Path

from harness import CliTest, Volume
from test_import import python_with_zarr
from test_sparse import HUGE, write_sparse

# Made by the program of commit c8061ff9, whose formats are those of 03a6d730: a .mask, an .offset, a trace, a journal.
EARLIER = Path(__file__).resolve().parent.parent / "data" / "project_with_mask.tar.xz"

# What python3-zarr finds in the first dataset of an image, with how often each value occurs. It reads the chunks that
# have a file, since arrays may have 2^60 voxels.
ZARR = """
import json, pathlib, sys
import numpy, zarr
group = zarr.open_group(sys.argv[1], mode="r")
path = group.attrs["multiscales"][0]["datasets"][0]["path"]
array = group[path]
counts = {}
for file in pathlib.Path(sys.argv[1], path).glob("*/*/*"):
    at = [int(piece) * chunk for piece, chunk in zip(file.parts[-3:], array.chunks)]
    voxels = array[tuple(slice(first, first + chunk) for first, chunk in zip(at, array.chunks))]
    for value, count in zip(*numpy.unique(voxels, return_counts=True)):
        counts[str(value)] = counts.get(str(value), 0) + int(count)
print(json.dumps({"shape": array.shape, "type": array.dtype.str, "fill": float(array.fill_value), "counts": counts,
                  "levels": len(group.attrs["multiscales"][0]["datasets"])}))
"""

# Adds an array and an attribute to each image.
ADDS = """
import sys
import numpy, zarr
for path in sys.argv[1:]:
    group = zarr.open_group(path, mode="a")
    group.create_dataset("scores", data=numpy.arange(4), chunks=2)
    group.attrs["reviewer"] = ["Anna"]
print("{}")
"""
SCORES = """
import json, sys
import zarr
group = zarr.open_group(sys.argv[1], mode="r")
print(json.dumps([group.attrs["reviewer"], group["scores"][:].tolist()]))
"""
# Consolidates the metadata of a group where asked to; all copies in it, and their originals.
CONSOLIDATED = """
import json, pathlib, sys
import zarr
folder = pathlib.Path(sys.argv[1])
if sys.argv[2]:
    zarr.consolidate_metadata(str(folder))
copies = json.loads((folder / ".zmetadata").read_text())["metadata"]
originals = {str(path.relative_to(folder)): json.loads(path.read_text())
             for name in (".zgroup", ".zattrs", ".zarray") for path in folder.rglob(name)}
found = "labels/paint/0/.zarray" in copies and zarr.open_consolidated(str(folder))["labels/paint/0"].shape == (40,) * 3
print(json.dumps({"copies": copies, "originals": originals, "found": found}))
"""


def files_of(folder):
    return {str(path.relative_to(folder)): path.stat().st_size for path in Path(folder).rglob("*") if path.is_file()}


class SparseSaves(CliTest):
    def setUp(self):
        super().setUp()
        self.project = self.folder / "project"

    def by_zarr(self, image):
        python = python_with_zarr()
        if python is None:
            self.skipTest("no interpreter here has python3-zarr")
        result = subprocess.run([python, "-c", ZARR, image], capture_output=True, text=True, timeout=120)
        self.assertEqual(result.returncode, 0, result.stderr)
        found = json.loads(result.stdout)
        found["counts"].pop("0", None)
        found["counts"].pop("0.0", None)
        return found

    def annotate(self, project, operations, *arguments):
        return self.check("annotate", project, "--script", self.write_script("script.jsonl", operations), *arguments)

    def dab(self, at, radius=3, group=1, threshold=0):
        return {"op": "paint", "brush": "fill", "region": "box", "group": group, "threshold": threshold,
                "radius": radius, "path": [at]}

    def session(self):
        return json.loads((self.project / "shvr" / "session.json").read_text())

    def groups(self, project):
        return self.check_json("export", project)["voxels_by_group"]

    def test_a_new_project_has_labels_and_offsets_that_python3_zarr_reads_after_every_save(self):
        for voxel_type, held in (("uint8", "<i4"), ("float", "<f4")):
            with self.subTest(type=voxel_type):
                shutil.rmtree(self.project, ignore_errors=True)
                volume = Volume.noise((40, 70, 33), seed=4, spacing=(0.5, 1, 2), voxel_type=voxel_type)
                self.check("import", volume.write(self.folder), self.project)
                self.assertEqual(self.session()["annotation"], {
                    "mask": "../labels/paint", "trace": "paint.graphml", "density": "paint.offsets.zarr"})
                raised = {"op": "density", "brush": "fill", "threshold": 0, "radius": 2, "offset": 5,
                          "path": [[20.5, 20.5, 20.5]]}
                self.annotate(self.project, [self.dab([20, 20, 20], 2), raised, {"op": "save"}])
                labels, offsets = self.project / "labels" / "paint", self.project / "shvr" / "paint.offsets.zarr"
                painted = self.groups(self.project)
                found = self.by_zarr(labels)
                self.assertEqual((found["shape"], found["type"], found["fill"]), ([33, 70, 40], "|u1", 0))
                self.assertEqual(found["counts"], painted)
                self.assertEqual(found["levels"], 3)
                found = self.by_zarr(offsets)
                self.assertEqual((found["shape"], found["type"], found["levels"]), ([33, 70, 40], held, 1))
                self.assertEqual(list(found["counts"]), ["5" if held == "<i4" else "5.0"])
                self.assertEqual(json.loads((self.project / "labels" / ".zattrs").read_text()), {"labels": ["paint"]})
                # Erased again: the arrays stay, without a chunk.
                self.annotate(self.project, [{"op": "undo", "count": 2}, {"op": "save"}])
                self.assertEqual((self.by_zarr(labels)["counts"], self.by_zarr(offsets)["counts"]), ({}, {}))
                self.assertEqual([path.name for path in (self.project / "labels").iterdir() if path.is_dir()], ["paint"])

    def test_the_project_opens_without_its_journal_and_says_so(self):
        self.check("import", Volume.noise((40, 40, 40), seed=4).write(self.folder), self.project)
        self.annotate(self.project, [self.dab([20, 20, 20]), {"op": "save"}])
        painted = self.groups(self.project)
        (self.project / "shvr" / "session.journal").unlink()
        said = self.check("export", self.project, "--json")
        self.assertEqual(json.loads(said.stdout)["voxels_by_group"], painted)
        self.assertIn("session.journal: is missing; expected the history and what was not saved, since", said.stderr)

    def test_labels_of_other_programs_stay(self):
        self.check("import", Volume.noise((40, 40, 40), seed=4).write(self.folder), self.project)
        self.check("label", self.project, "--threshold", 250, "-o", self.project / "labels" / "cells")
        before = files_of(self.project / "labels" / "cells")
        self.annotate(self.project, [self.dab([20, 20, 20]), {"op": "save"}])
        self.assertEqual(files_of(self.project / "labels" / "cells"), before)
        self.assertEqual(json.loads((self.project / "labels" / ".zattrs").read_text()), {"labels": ["cells", "paint"]})

    def python(self, program, *arguments):
        python = python_with_zarr()
        if python is None:
            self.skipTest("no interpreter here has python3-zarr")
        result = subprocess.run([python, "-c", program, *map(str, arguments)], capture_output=True, text=True,
                                timeout=120)
        self.assertEqual(result.returncode, 0, result.stderr)
        return json.loads(result.stdout)

    # Kind (annotation files): an array and attributes that python3-zarr added to the labels and to the offsets.
    def test_what_python3_zarr_added_is_kept_with_a_warning(self):
        self.check("import", Volume.noise((40, 40, 40), seed=4).write(self.folder), self.project)
        raised = {"op": "density", "brush": "fill", "threshold": 0, "radius": 2, "offset": 5, "path": [[20, 20, 20]]}
        self.annotate(self.project, [self.dab([20, 20, 20]), raised, {"op": "save"}])
        labels, offsets = self.project / "labels" / "paint", self.project / "shvr" / "paint.offsets.zarr"
        self.python(ADDS, labels, offsets)
        again = [self.dab([9, 9, 9], 1, 2), {**raised, "path": [[9, 9, 9]]}, {"op": "save"}]
        said = self.annotate(self.project, again, "--quiet").stderr
        for image in (labels, offsets):
            old = image.with_name(image.name + ".old")
            self.assertIn(f"{image}: held ", said)
            self.assertIn(f"kept as {old}", said)
            self.assertEqual(self.python(SCORES, old), [["Anna"], [0, 1, 2, 3]])
        self.assertEqual(self.by_zarr(labels)["counts"], self.groups(self.project))
        before = sorted(files_of(self.project))
        self.assertEqual(self.annotate(self.project, [{"op": "save"}], "--quiet").stderr, "")
        self.assertEqual(sorted(files_of(self.project)), before)

    def test_a_bare_session_keeps_what_was_added_too(self):
        session = self.write_session(annotation={"mask": "scan.labels.zarr"})
        self.annotate(session, [self.dab([12, 12, 12]), {"op": "save"}])
        (self.folder / "scan.labels.zarr" / "notes.txt").write_text("mine")
        self.assertIn("held notes.txt of another program", self.annotate(
            session, [self.dab([9, 9, 9]), {"op": "save"}]).stderr)
        self.assertEqual((self.folder / "scan.labels.zarr.old" / "notes.txt").read_text(), "mine")

    def test_files_of_file_browsers_refuse_no_save_and_are_no_change_of_the_mask(self):
        self.check("import", Volume.noise((40, 40, 40), seed=4).write(self.folder), self.project)
        self.annotate(self.project, [self.dab([20, 20, 20]), {"op": "save"}])
        labels = self.project / "labels" / "paint"
        for name in (".DS_Store", "Thumbs.db", "0/.DS_Store"):
            (labels / name).write_text("left by a browser")
        said = self.annotate(self.project, [self.dab([9, 9, 9], 1, 2), {"op": "save"}], "--quiet").stderr
        self.assertEqual(said, "")
        self.assertTrue((labels / ".DS_Store").exists())
        self.assertEqual([path.name for path in (self.project / "labels").iterdir() if path.is_dir()], ["paint"])

    def test_a_list_of_labels_that_cannot_be_continued_says_what_to_do_about_it(self):
        self.check("import", Volume.noise((40, 40, 40), seed=4).write(self.folder), self.project)
        labels = self.project / "labels"
        script = self.write_script("s.jsonl", [self.dab([20, 20, 20]), {"op": "save"}])
        for content, made, says in (
                ("{labels", labels / ".zattrs", [".zattrs: is not JSON", "repair it, or move it, and the next save"]),
                ("text", labels, ["labels: is a file; expected the folder of the image's labels: move the file"])):
            with self.subTest(made=made):
                shutil.rmtree(labels, ignore_errors=True)
                made.parent.mkdir(exist_ok=True)
                made.write_text(content)
                self.check_refused("annotate", self.project, "--script", script, says=says)
                self.assertEqual(made.read_text(), content)
                made.unlink()
                self.check("annotate", self.project, "--script", script)
                self.assertEqual(json.loads((labels / ".zattrs").read_text()), {"labels": ["paint"]})

    def test_metadata_that_another_program_consolidated_follow_a_save(self):
        self.check("import", Volume.noise((40, 40, 40), seed=4).write(self.folder), self.project)
        self.assertFalse(self.python(CONSOLIDATED, self.project, "write")["found"])
        self.annotate(self.project, [self.dab([20, 20, 20]), {"op": "save"}])
        self.assertTrue(self.python(CONSOLIDATED, self.project, "")["found"])
        found = self.python(CONSOLIDATED, self.project / "labels", "write")
        self.annotate(self.project, [self.dab([9, 9, 9], 1, 2), {"op": "save"}])
        for group in (self.project, self.project / "labels"):
            now = self.python(CONSOLIDATED, group, "")
            self.assertEqual(now["copies"], now["originals"])
        self.assertNotEqual(now["copies"], found["copies"])  # the journal's record, at least
        self.assertEqual([path.name for path in (self.project / "labels").iterdir() if path.is_dir()], ["paint"])

    def earlier(self):
        with tarfile.open(EARLIER) as packed:
            packed.extractall(self.folder)
        return files_of(self.project)

    def test_an_earlier_project_opens_with_its_whole_history_and_reading_changes_nothing(self):
        before = self.earlier()
        self.assertEqual(self.groups(self.project), {"1": 260, "2": 96, "5": 40})
        self.assertEqual(files_of(self.project), before)
        everything = {"op": "expect", "voxels_in_group": {"1": 260, "2": 96, "4": 0, "5": 40}, "nodes": 2}
        nothing = {"op": "expect", "voxels_in_group": {"1": 0, "2": 0, "5": 0}, "nodes": 0, "voxels_with_offset": 0}
        self.annotate(self.project, [everything, {"op": "undo", "count": 6}, nothing, {"op": "redo", "count": 6},
                                     everything])

    def test_the_next_save_of_an_earlier_project_upgrades_it_and_keeps_the_old_files(self):
        self.earlier()
        shvr = self.project / "shvr"
        old = {name: (shvr / name).read_bytes() for name in ("paint.mask", "paint.mask.json", "paint.offset")}
        session = self.session()
        said = self.annotate(self.project, [{"op": "save"}]).stderr
        labels, offsets = self.project / "labels" / "paint", shvr / "paint.offsets.zarr"
        self.assertIn(f"saved {labels}", said)
        self.assertEqual({name: (shvr / name).read_bytes() for name in old}, old)
        self.assertEqual(self.by_zarr(labels)["counts"], {"1": 260, "2": 96, "5": 40})
        self.assertEqual(list(self.by_zarr(offsets)["counts"]), ["40"])
        annotation = {"mask": "../labels/paint", "trace": "paint.graphml", "density": "paint.offsets.zarr"}
        self.assertEqual(self.session(), {**session, "annotation": annotation})
        # From now on, these are the project's files, with the whole history.
        again = self.annotate(self.project, [{"op": "undo", "count": 6}, {"op": "save"}], "--quiet")
        self.assertEqual(again.stderr, "")
        self.assertEqual(self.by_zarr(labels)["counts"], {})
        (shvr / "session.journal").unlink()
        self.assertEqual(self.groups(self.project), {})
        self.assertEqual({name: (shvr / name).read_bytes() for name in old}, old)

    def test_an_earlier_project_without_its_session_is_found(self):
        self.earlier()
        (self.project / "shvr" / "session.json").unlink()
        (self.project / "shvr" / "session.journal").unlink()
        self.assertEqual(self.groups(self.project), {"1": 260, "2": 96})

    def test_a_mask_that_a_session_elsewhere_names_stays_a_mask(self):
        session = self.write_session()
        self.annotate(session, [self.dab([12, 12, 12]), {"op": "save"}])
        self.assertEqual((self.folder / "paint.mask").stat().st_size, 24 ** 3)

    def sparse_project(self, size):
        """A project folder whose volume has 64 chunks of 32^3 voxels stored, whatever its size."""
        folder = self.folder / f"side-{size}"
        (folder / "shvr").mkdir(parents=True)
        write_sparse(folder / "volume.zarr", size, [(x, y, z) for x in range(4) for y in range(4) for z in range(4)])
        (folder / "shvr" / "session.json").write_text(json.dumps({
            "shvr_session": 1, "volume": {"path": "../volume.zarr"}, "annotation": {
                "mask": "paint.zarr", "density": "paint.offsets.zarr"}}))
        return folder

    def test_a_stroke_and_a_save_write_the_same_at_every_size(self):
        sizes = {}
        for side in (128, 2048, HUGE):
            with self.subTest(side=side):
                project = self.sparse_project(side)
                stroke = {**self.dab([64, 64, 64], 20, threshold=100), "region": "ball"}
                raised = {"op": "density", "brush": "fill", "threshold": 0, "radius": 6, "offset": 5,
                          "path": [[64, 64, 64]]}
                self.annotate(project, [stroke, raised, {"op": "save"}])
                painted = self.groups(project)
                self.assertEqual(painted, {"1": 33552})
                files = files_of(project / "shvr")
                sizes[side] = (sum(files.values()), len(files))
                # Undo, and everything again, from the files.
                self.annotate(project, [{"op": "undo", "count": 2}, {"op": "redo", "count": 2}, {"op": "save"}])
                self.assertEqual(self.groups(project), painted)
                # Another label image of it
                self.check("export", project, "--mask", self.folder / f"{side}.zarr", "--offset",
                           self.folder / f"{side}.offsets.zarr")
                self.assertLess(sum(files_of(self.folder / f"{side}.zarr").values()), 200_000)
                self.assertEqual(self.by_zarr(project / "shvr" / "paint.zarr")["counts"], painted)
        for side, (content, files) in sizes.items():
            self.assertLess(content, 300_000, side)
            self.assertLess(content, sizes[128][0] + 30_000, side)
            self.assertLess(files, sizes[128][1] + 60, side)

    def test_exports_of_every_voxel_are_refused_with_both_sizes_where_the_disk_is_too_small(self):
        project = self.sparse_project(HUGE)
        self.annotate(project, [self.dab([64, 64, 64]), {"op": "save"}])
        for option, name, size in (("--mask", "m.mask", HUGE ** 3), ("--mask", "m.nrrd", HUGE ** 3),
                                   ("--offset", "o.offset", 2 * HUGE ** 3), ("--offset", "o.nrrd", 4 * HUGE ** 3)):
            with self.subTest(name=name):
                self.check_refused("export", project, option, self.folder / name, says=[
                    f"{name}: would take {size} bytes; expected at most ", "the free space of its disk", "choose .zarr"])
                self.assertFalse((self.folder / name).exists())


if __name__ == "__main__":
    unittest.main()
