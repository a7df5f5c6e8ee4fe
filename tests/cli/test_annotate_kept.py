"""What is kept beside the steps: looks of the session, the last save, the spacing, and the journal that a mask names."""
import json
import unittest

from harness import CliTest, Volume
from test_annotate import paint

SIZE = (9, 8, 7)


class Kept(CliTest):
    def setUp(self):
        super().setUp()
        self.volume = Volume.noise(SIZE, seed=1)
        self.name = self.volume.write(self.folder).name
        self.session = self.write(volume={"path": self.name})

    def write(self, **keys):
        return self.write_session(**keys)

    def annotate(self, operations, *arguments, status=0):
        script = self.write_script("script.jsonl", operations)
        return self.check("annotate", self.session, "--script", script, *arguments, status=status).stderr

    def export(self, *arguments):
        return self.check_json("export", self.session, *arguments)

    def dab(self, group):
        return paint("fill", "box", group, 0, 0.4, [[group + 0.5, 1.5, 1.5]])

    def picture(self, *arguments):
        """Its size, and what was said."""
        result = self.check("render", self.session, "-o", self.folder / "a.png", "--json", *arguments)
        return json.loads(result.stdout)["size"], result.stderr

    # ---- The session's other settings ----

    def test_a_session_that_is_edited_after_a_save_is_believed(self):
        changed = "these settings of the session were changed since it was saved: render; they are taken"
        self.assertEqual(self.picture()[0], [24, 16])
        self.assertFalse((self.folder / "session.journal").exists())
        self.annotate([self.dab(1), {"op": "save"}])
        size, said = self.picture()
        self.assertEqual(size, [24, 16])
        self.assertNotIn("were changed", said)
        self.write(volume={"path": self.name}, render={"size": [10, 12]})
        size, said = self.picture()
        self.assertEqual(size, [10, 12])
        self.assertIn(changed, said)
        self.assertEqual(self.picture("--size", "5x6", "--quiet"), ([5, 6], ""))
        # The next writer records it.
        self.assertIn(changed, self.annotate([self.dab(2)]))
        size, said = self.picture()
        self.assertEqual(size, [10, 12])
        self.assertNotIn("were changed", said)

    # ---- Revert ----

    def test_what_a_script_saved_is_opened_without_a_word_of_changed_settings(self):
        session = self.write_session()
        script = self.write_script("script.jsonl", [{"op": "node", "at": [1, 1, 1], "radius": 1}, {"op": "save"}])
        self.check("annotate", session, "--script", script)
        said = self.check("annotate", session, "--actions", self.write_script("none.jsonl", [])).stderr
        self.assertIn("Opened", said)
        self.assertNotIn("changed since it was saved", said)

    def test_revert_is_a_step(self):
        self.assertIn("script.jsonl:2: ", self.annotate([self.dab(1), {"op": "revert"}], status=1))
        said = self.annotate([{"op": "revert"}], status=1)
        self.assertIn("session.journal: was never saved; expected a save to go back to", said)
        node = {"op": "node", "at": [1.5, 2.5, 3.5], "radius": 1, "group": 2}
        count = {"op": "expect", "voxels_in_group": {"1": 1, "2": 1, "3": 1}, "nodes": 1}
        saved = {"op": "expect", "voxels_in_group": {"1": 1, "2": 0, "3": 0}, "nodes": 0}
        self.annotate([{"op": "save"}, self.dab(2), node])
        said = self.annotate([self.dab(3), count, {"op": "revert"}, saved, {"op": "undo"}, count, {"op": "redo"}, saved,
                              {"op": "revert"}, {"op": "save"}], "--verbose")
        self.assertIn("script.jsonl:3: Reverted to the last save", said)
        self.assertIn("script.jsonl:9: Nothing has changed since the last save", said)
        self.annotate([saved, {"op": "undo"}, count, {"op": "revert"}, saved])
        self.assertIn("script.jsonl:1: unknown key count",
                      self.annotate([{"op": "revert", "count": 1}], status=1))

    # ---- The spacing ----

    def voxels(self, spacing):
        """Positions of the exported nodes in voxels, their radii in voxels along x, and the length of group 1."""
        trace = self.folder / "out.txt"
        length = self.export("--trace", trace, "--space", "volume", "--quiet")["length_by_group"]["1"]
        nodes = [[float(word) for word in line[3:].split(",")] for line in trace.read_text().splitlines()
                 if line.startswith("-v")]
        return [[n[0] / spacing[0], n[1] / spacing[1], n[2] / spacing[2], n[4] / spacing[0]] for n in nodes], length

    def given(self, spacing, unit="um"):
        self.write(volume={"path": self.name, "spacing": spacing, "unit": unit})

    def test_nodes_stay_at_their_voxels_where_the_spacing_is_corrected(self):
        nodes = [[1.5, 2.5, 3.5, 1.5], [5.5, 2.5, 3.5, 1.0], [5.5, 6.5, 0.5, 0.5]]
        lines = [{"op": "node", "at": n[:3], "radius": n[3], "group": 1} for n in nodes]
        self.given([1, 1, 1])
        self.annotate(lines[:2] + [{"op": "save"}])
        self.assertEqual(self.voxels([1, 1, 1]), (nodes[:2], 4.0))
        corrected = "was traced with voxels of 1 x 1 x 1 µm; expected 0.5 x 2 x 3 mm, this volume's: its nodes stay"
        self.given([0.5, 2, 3], "mm")
        journal = (self.folder / "session.journal").read_bytes()
        self.assertEqual(self.voxels([0.5, 2, 3]), (nodes[:2], 2.0))
        said = self.check("export", self.session, "--json").stderr
        self.assertIn(corrected, said)
        self.assertEqual((self.folder / "session.journal").read_bytes(), journal)  # looking changes nothing
        # Work goes on in the new spacing, and undo keeps to it, before the correction, too.
        self.assertIn(corrected, self.annotate([{"op": "select", "node": 1}, lines[2], {"op": "undo"}]))
        self.assertEqual(self.voxels([0.5, 2, 3]), (nodes[:2], 2.0))
        self.assertNotIn("was traced", self.annotate([{"op": "redo"}, {"op": "save"}]))
        self.assertEqual(self.voxels([0.5, 2, 3])[0], nodes)
        self.annotate([{"op": "undo", "count": 2}, {"op": "redo"}])
        self.assertEqual(self.voxels([0.5, 2, 3]), (nodes[:2], 2.0))
        self.given([1, 1, 1])
        self.assertEqual(self.voxels([1, 1, 1]), (nodes[:2], 4.0))
        self.annotate([{"op": "revert"}])
        self.assertEqual(self.voxels([1, 1, 1])[0], nodes)

    # ---- A label image ----

    def test_a_label_image_names_its_journal_so_that_a_missing_one_is_told(self):
        self.write(volume={"path": self.name}, annotation={"mask": "paint.zarr"})
        self.annotate([self.dab(1), {"op": "save"}, self.dab(2)])
        self.assertFalse((self.folder / "paint.zarr.json").exists())
        self.assertNotIn("is missing", self.annotate([]))
        journal = self.folder / "session.journal"
        kept = journal.read_bytes()
        journal.unlink()
        result = self.check("export", self.session, "--json", "--quiet")
        self.assertIn(f"{journal}: is missing; expected the history and what was not saved, since "
                      f"{self.folder / 'paint.zarr'} names it", result.stderr)
        self.assertEqual(json.loads(result.stdout)["voxels_by_group"], {"1": 1})
        journal.write_bytes(kept)
        self.assertEqual(self.export("--quiet")["voxels_by_group"], {"1": 1, "2": 1})
        # A journal that is older than the mask is noticed by the same.
        self.annotate([self.dab(3), {"op": "save"}])
        journal.write_bytes(kept)
        said = self.check("export", self.session, status=1).stderr
        self.assertIn("paint.zarr: was saved by a later state of the journal", said)
        # An export belongs to no journal.
        self.annotate([], "--believe", "journal")
        self.export("--mask", self.folder / "out.zarr", "--believe", "journal")
        self.assertNotIn("journal", (self.folder / "out.zarr" / ".zattrs").read_text())


if __name__ == "__main__":
    unittest.main()
