"""shvr label --task: components joined across the borders of tasks have the numbers of one process."""
import signal
import subprocess
import unittest
from pathlib import Path

from harness import ENVIRONMENT, IS_SLOW, SHVR, Volume
from tasks import SplitTest

LOCAL = Path(__file__).resolve().parents[3] / "tools" / "slurm" / "local"


class LabelTasks(SplitTest):
    OTHER = ["--set", "probe.radius_voxels=2.5"]

    def label(self, volume, output, *more):
        return ["label", volume, "--threshold", 128, "-o", self.folder / output, *more]

    def check_every_count(self, volume, everyday, *more):
        """Compares the output of each number of tasks; `everyday`: of these alone, unless SHVR_SLOW=1."""
        whole = self.check_json(*self.label(volume, "whole.nrrd", *more))
        for of in (*self.COUNTS, 50) if IS_SLOW else everyday:
            with self.subTest(of=of, more=more):
                output = self.folder / f"labels-{of}.nrrd"
                self.tasks(of, *self.label(volume, output.name, *more))
                self.assertFalse(output.exists())
                told = self.gather(output, "--remove")
                self.assertEqual((told["pieces"], told["missing"], told["path"]), (of, [], str(output)))
                for key in ("components", "foreground_voxels", "largest_voxels", "kept", "kept_voxels", "largest",
                            "type"):
                    self.assertEqual(told["result"][key], whole[key], key)
                self.assert_equal_files(output, self.folder / "whole.nrrd")
                output.unlink()
        return whole

    def test_noise_is_labelled_as_by_one_process(self):
        # Half of the voxels: with corners all are one component, with faces there are hundreds of every shape.
        volume = Volume.noise((9, 11, 40), seed=5).write(self.folder)
        self.check_every_count(volume, self.COUNTS, "--connectivity", 6, "--threads", 2)
        self.check_every_count(volume, (3,), "--connectivity", 26, "--threads", 2)
        self.check_every_count(volume, (2,), "--min-voxels", 3, "--largest", 9)

    def test_components_join_over_faces_edges_and_corners_of_borders(self):
        # Pairs of voxels in neighbouring slices, at every border: the second one is across a face, an edge or a corner.
        size = (30, 12, 42)
        values = [0] * (size[0] * size[1] * size[2])
        pairs = 0
        for z in range(0, 40, 3):
            for number, (dx, dy) in enumerate([(0, 0), (1, 0), (0, -1), (1, 1), (-1, 1)]):
                for x, y, at in [(3 + 6 * number, 5, z), (3 + 6 * number + dx, 5 + dy, z + 1)]:
                    values[x + size[0] * (y + size[1] * at)] = 200
                pairs += 1
        volume = Volume(size, values).write(self.folder)
        faces = self.check_every_count(volume, (7,), "--connectivity", 6)
        corners = self.check_every_count(volume, (7,), "--connectivity", 26)
        self.assertEqual((faces["components"], corners["components"]), (2 * pairs - pairs // 5, pairs))

    def test_a_sparse_project_and_label_images_are_split_too(self):
        size = (70, 66, 140)
        values = [0] * (size[0] * size[1] * size[2])
        for z in range(50, 90):  # a rod across blocks
            values[10 + size[0] * (60 + size[1] * z)] = 255
        project = self.folder / "project"
        self.check("import", Volume(size, values).write(self.folder), project, "--quiet")
        whole = self.check_json(*self.label(project, "whole.zarr"))
        self.assertEqual((whole["components"], whole["largest_voxels"]), (1, 40))
        for of in (2, 7):
            self.tasks(of, *self.label(project, f"{of}.zarr"))
            self.check("gather", self.folder / f"{of}.zarr")  # named by its output
            names = [".zattrs"]  # holds the image's name
            found, expected = (self.folder / f"{of}.zarr", self.folder / "whole.zarr")
            self.assertEqual((found / names[0]).read_text().replace(f'"{of}.zarr"', '"whole.zarr"'),
                             (expected / names[0]).read_text())
            (found / names[0]).write_bytes((expected / names[0]).read_bytes())
            self.assert_equal_files(found, expected)

    def test_tasks_may_be_killed_repeated_and_run_twice(self):
        volume = Volume.noise((40, 40, 60), seed=8).write(self.folder)
        output = self.folder / "labels.nrrd"
        self.check_rules(output, *self.label(volume, "labels.nrrd"))
        for number in (signal.SIGKILL, signal.SIGTERM):
            self.kill(*self.label(volume, "labels.nrrd"), "--task", "1/3", number=number)
        self.tasks(3, *self.label(volume, "labels.nrrd"), order=(1,))
        self.gather(output)
        self.check(*self.label(volume, "whole.nrrd"))
        self.assert_equal_files(output, self.folder / "whole.nrrd")

    def test_xargs_runs_the_tasks_without_slurm(self):
        volume = Volume.noise((9, 11, 20), seed=6).write(self.folder)
        output = self.folder / "labels.nrrd"
        command = [LOCAL, "3", "2", output, *map(str, self.label(volume, output.name))]
        # Task 1 fails at first: the others run, nothing is joined, and the same line runs what is missing.
        failing = self.folder / "shvr-that-fails"
        failing.write_text('#!/bin/sh\ncase "$*" in *"--task 1/3"*) mkdir "$0.failed" 2> /dev/null && exit 1; esac\n'
                           f'exec {Path(SHVR).resolve()} "$@"\n')
        failing.chmod(0o755)
        environment = {**ENVIRONMENT, "SHVR": str(failing)}
        failed = subprocess.run(command, env=environment, capture_output=True, text=True)
        self.assertNotEqual(failed.returncode, 0)
        self.assertFalse(output.exists())
        self.assertEqual(self.gather(output, status=1)["missing"], ["1/3"])
        done = subprocess.run(command, env=environment, capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.check(*self.label(volume, "whole.nrrd"))
        self.assert_equal_files(output, self.folder / "whole.nrrd")

    def test_what_does_not_fit_is_refused(self):
        volume = Volume.noise((8, 8, 8), seed=1).write(self.folder)
        self.check_refused("label", volume, "--threshold", 128, "--task", "0/2", status=2, says=["--output"])
        self.tasks(2, *self.label(volume, "labels.nrrd"))
        piece = self.folder / "labels.nrrd.pieces" / "piece-1"
        whole = piece.read_bytes()
        for damaged in (b"", whole[:-9], whole[:-8] + b"\xff" * 8, whole[:100] + bytes(len(whole) - 100)):
            piece.write_bytes(damaged)
            self.assertIn("piece-1", self.check_refused("gather", self.folder / "labels.nrrd.pieces", status=1))
        self.assertFalse((self.folder / "labels.nrrd").exists())


if __name__ == "__main__":
    unittest.main()
