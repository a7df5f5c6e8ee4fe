"""Formats over time: samples of every version open with the same content, and newer files are refused and left alone.

`tests/data/project_1.tar.xz` is session version 1 in project format 1; test_sparse_saves.py has the sample before it.
When a version number is raised, add a sample of the version that was written until then, and its content here."""
import tarfile
import unittest
from pathlib import Path

from harness import CliTest

DATA = Path(__file__).resolve().parents[2] / "data"
# Sample: the annotation with which it opens, after a last undo that was not saved.
SAMPLES = {"project_1.tar.xz": {"voxels_in_group": {"1": 108, "2": 32, "3": 0}, "nodes": 1, "internodes": 0},
           "project_with_mask.tar.xz": {"voxels_in_group": {"1": 260, "2": 96, "5": 40}, "nodes": 2}}


def files_of(folder):
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


class Versions(CliTest):
    def unpack(self, sample):
        folder = self.folder / sample.partition(".")[0]
        with tarfile.open(DATA / sample) as packed:
            packed.extractall(folder)
        return next(path for path in folder.iterdir() if (path / "shvr").is_dir())

    def annotate(self, project, *operations, status=0):
        script = self.write_script("script.jsonl", operations)
        return self.check("annotate", project, "--script", script, "--quiet", status=status)

    def test_every_sample_opens_with_its_content_and_keeps_it_when_saved(self):
        for sample, content in SAMPLES.items():
            with self.subTest(sample=sample):
                project = self.unpack(sample)
                expected = {"op": "expect", **content}
                self.annotate(project, expected, {"op": "save"})
                self.annotate(project, expected)
                # From the files alone, without the journal.
                (project / "shvr" / "session.journal").unlink()
                self.annotate(project, expected)

    def test_a_session_or_project_of_a_newer_version_is_refused_and_nothing_is_changed(self):
        for name, key in [("session.json", "shvr_session"), ("volume.json", "shvr_volume")]:
            with self.subTest(name=name):
                self.check_newer_is_refused(self.unpack("project_1.tar.xz"), name, key)

    def check_newer_is_refused(self, project, name, key):
        file = project / "shvr" / name
        file.write_text(file.read_text().replace(f'"{key}": 1', f'"{key}": 2'))
        before = files_of(project)
        script = self.write_script("paint.jsonl", [{"op": "node", "at": [5, 5, 5], "radius": 1, "group": 1},
                                                   {"op": "save"}])
        for command in [["annotate", project, "--script", script], ["annotate", project, "--script", script, "--fresh"],
                        ["export", project, "--mask", self.folder / "a.mask"],
                        ["render", project, "-o", self.folder / "a.png"], ["info", project]]:
            self.check_refused(*command, says=[name, f"{key} is 2", "expected 1"])
            self.assertEqual(files_of(project), before, command)
        self.assertFalse((self.folder / "a.mask").exists() or (self.folder / "a.png").exists())

    def test_a_journal_of_a_newer_version_is_refused_and_nothing_is_changed(self):
        project = self.unpack("project_1.tar.xz")
        journal = project / "shvr" / "session.journal"
        # The head of a journal stands twice in it, and both copies state the version.
        data, mark = journal.read_bytes(), b"SHVRJRNL"
        self.assertEqual(data.count(mark + b"\1\0\0\0"), 2)
        journal.write_bytes(data.replace(mark + b"\1", mark + b"\2"))
        before = files_of(project)
        script = self.write_script("paint.jsonl", [{"op": "node", "at": [5, 5, 5], "radius": 1, "group": 1},
                                                   {"op": "save"}])
        self.check_refused("annotate", project, "--script", script, says=["session.journal", "version"])
        self.assertEqual(files_of(project), before)


if __name__ == "__main__":
    unittest.main()
