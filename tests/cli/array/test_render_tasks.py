"""shvr render --task: a picture in bands, drawn by several processes, equals that of one process bit for bit."""
import signal
import unittest
from pathlib import Path

from harness import IS_SLOW, Volume
from tasks import SplitTest


class RenderTasks(SplitTest):
    OTHER = ["--set", "render.step_voxels=2.5"]

    def render(self, output, *more):
        return ["render", self.session, "-o", self.folder / output, *more]

    def setUp(self):
        super().setUp()
        self.session = self.write_session(annotation={})

    def test_bands_make_the_picture_of_one_process(self):
        self.check(*self.render("whole.png", "--with-session"))
        self.check(*self.render("whole.pfm"))
        for of in (*self.COUNTS, 20) if IS_SLOW else self.COUNTS:  # 16 rows: some of 20 tasks have none
            with self.subTest(of=of):
                output = f"picture-{of}.png"
                self.tasks(of, *self.render(output, "--with-session"))
                self.assertFalse((self.folder / output).exists())
                told = self.gather(self.folder / output)
                self.assertEqual((told["pieces"], told["missing"]), (of, []))
                self.assertEqual((told["result"]["size"], told["result"]["complete"]), ([24, 16], True))
                self.assert_equal_pictures(output, "whole.png")
        self.tasks(3, *self.render("three.pfm"))
        self.gather(self.folder / "three.pfm", "--remove")
        self.assert_equal_files(self.folder / "three.pfm", self.folder / "whole.pfm")
        self.assertFalse((self.folder / "three.pfm.pieces").exists())

    def assert_equal_pictures(self, a, b):
        told = self.check_json("compare", self.folder / a, self.folder / b)
        self.assertEqual((told["max_abs"], told["rmse"]), (0, 0))
        self.assertEqual((self.folder / a).stat().st_size > 0, True)

    def test_panes_with_occlusion_and_a_paged_volume_are_equal_in_bands(self):
        look = ["--set", "view.arrangement=overview", "--set", "render.size=[40,30]",
                "--set", "light.occlusion.strength=0.5",
                "--set", "render.paging=always", "--set", "render.detail=0", "--axes", "--title", "three bands"]
        self.check(*self.render("whole.pfm", *look))
        self.tasks(3, *self.render("three.pfm", *look))
        self.gather(self.folder / "three.pfm")
        self.assert_equal_files(self.folder / "three.pfm", self.folder / "whole.pfm")

    def test_tasks_may_be_killed_repeated_and_run_twice(self):
        output = self.folder / "picture.pfm"
        self.check_rules(output, *self.render("picture.pfm"))
        for number in (signal.SIGKILL, signal.SIGTERM):
            self.kill(*self.render("picture.pfm"), "--task", "1/3", number=number)
        self.tasks(3, *self.render("picture.pfm"), order=(1,))
        self.gather(output)
        self.check(*self.render("whole.pfm"))
        self.assert_equal_files(output, self.folder / "whole.pfm")

    def test_slurm_decides_only_if_it_is_asked(self):
        def slurm(index):
            return {"SLURM_ARRAY_TASK_ID": str(5 + 2 * index), "SLURM_ARRAY_TASK_MIN": "5", "SLURM_ARRAY_TASK_MAX": "9",
                    "SLURM_ARRAY_TASK_STEP": "2"}
        for index in range(3):
            self.slurm(slurm(index), *self.render("slurm.pfm", "--task", "slurm"))
        self.slurm(slurm(1), *self.render("whole.pfm"))
        self.gather(self.folder / "slurm.pfm")
        self.assert_equal_files(self.folder / "slurm.pfm", self.folder / "whole.pfm")
        self.check_refused(*self.render("slurm.pfm", "--task", "slurm"), status=2, says=["SLURM_ARRAY_TASK_ID"])

    def test_a_changed_session_and_a_foreign_manifest_are_refused(self):
        arguments = self.render("picture.pfm")
        self.tasks(2, *arguments, order=(0,))
        self.session.write_text(self.session.read_text() + "\n")
        self.check_refused(*arguments, "--task", "1/2", status=1, says=["session.json", "start over"])
        # The voxels of a header.
        header = Volume.noise((12, 10, 8), seed=4).write(self.folder)
        arguments = ["render", header, "-o", self.folder / "noise.png", "--size", "16x12"]
        self.tasks(2, *arguments, order=(0,))
        data = self.folder / "volume.raw"
        data.write_bytes(bytes(len(data.read_bytes())))
        self.check_refused(*arguments, "--task", "1/2", status=1, says=["volume.raw", "start over"])
        # A manifest from elsewhere does not decide where a picture is written.
        other = self.folder / "other.pfm.pieces"
        (self.folder / "picture.pfm.pieces").rename(other)
        self.check_refused("gather", other, status=1, says=["picture.pfm", "other.pfm.pieces"])
        self.assertFalse(Path(self.folder / "picture.pfm").exists())


if __name__ == "__main__":
    unittest.main()
