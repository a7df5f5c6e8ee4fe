"""Commands that would lose work, or write into a file that is not theirs, do neither."""
import json
import subprocess
import unittest

from harness import ENVIRONMENT, SHVR, CliTest, Volume, read_png_header
from test_annotate import paint


class LostWork(CliTest):
    def setUp(self):
        super().setUp()
        self.scan = Volume((8, 8, 8), [100] * 512).write(self.folder)
        self.project = self.folder / "project"
        self.check("import", self.scan, self.project, "--quiet")

    def without_streams(self, closed, *arguments):
        """Runs a shell that closes descriptors, as a service manager or a careless script does."""
        command = " ".join(f"'{argument}'" for argument in (SHVR, *arguments))
        return subprocess.run(["sh", "-c", f"{command} {closed}"], env=ENVIRONMENT, timeout=120, capture_output=True)

    def dab(self, group):
        return paint("fill", "box", group, 50, 0.4, [[group + 0.5, 1.5, 1.5]])

    def painted(self, counts):
        script = self.write_script("expect.jsonl", [{"op": "expect", "voxels_in_group": counts}])
        self.check("annotate", self.project, "--script", script, "--quiet")

    def test_closed_standard_streams_reach_no_file(self):
        script = self.write_script("script.jsonl", [self.dab(1)])
        for closed in ("<&- >&-", "<&- >&- 2>&-", ">&-"):
            result = self.without_streams(closed, "annotate", self.project, "--script", script, "--json")
            self.assertEqual(result.returncode, 0, result.stderr)
            self.painted({"1": 1})
        picture = self.folder / "picture.png"
        for closed in (">&-", "<&- >&-", "2>&-"):
            result = self.without_streams(closed, "render", self.project, "-o", picture, "--size", "8x8", "--json")
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertEqual(read_png_header(picture)[:2], (8, 8))
            self.assertTrue(picture.read_bytes().endswith(b"IEND\xaeB`\x82"), closed)
        # A script that would come from a closed stream is empty.
        result = self.without_streams("<&-", "annotate", self.project, "--script", "-", "--json")
        self.assertEqual((result.returncode, json.loads(result.stdout)["commands"]), (0, 0), result.stderr)

    def test_no_project_is_imported_onto_itself(self):
        script = self.write_script("script.jsonl", [self.dab(1), {"op": "save"}])
        self.check("annotate", self.project, "--script", script, "--quiet")
        link = self.folder / "link"
        link.symlink_to(self.project)
        level = self.project / "0"
        for source, target in [(self.project, self.project), (link, self.project), (self.project, link),
                               (level, self.project), (link / "0", self.project), (f"{self.project}/", self.project),
                               (self.project / ".." / "project", self.project)]:
            self.check_refused("import", source, target, "--overwrite", says=["holds the volume to import", "expected"])
            self.painted({"1": 1})
        self.check("import", self.scan, self.project, "--overwrite", "--quiet")
        self.painted({"1": 0})
        self.check("import", self.project, self.folder / "copy", "--quiet")

    def test_a_bare_volume_is_not_annotated(self):
        script = self.write_script("script.jsonl", [self.dab(1)])
        self.check_refused("annotate", self.scan, "--script", script,
                           says=["annotation is kept only in projects", "shvr import"])


if __name__ == "__main__":
    unittest.main()
