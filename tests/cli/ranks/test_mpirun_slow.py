"""mpirun -n N shvr render: the picture of one process at every N; lost ranks and errors; what ranks read and draw."""
import json
import os
import signal
import subprocess
import unittest

from mpi import ENVIRONMENT_OF_RANKS, PROGRAM, RanksTest, lines_of_shvr

PAGED = ["--set", "render.paging=always", "--budget-device", "32", "--budget-host", "32", "--threads", "1"]


class Mpirun(RanksTest):
    COUNTS = (1, 2, 3, 4, 5, 8)

    def setUp(self):
        super().setUp()
        self.session = self.write_session(annotation={}, render={"size": [96, 320]},
                                          volume={"procedural": "tubes", "size": [160, 160, 160]})

    def alone(self, output, *more):
        subprocess.run([PROGRAM, "render", self.session, "-o", self.folder / output, "--quiet", *more], check=True)
        return (self.folder / output).read_bytes()

    def check_equal(self, *more, ends=("png", "pfm")):
        for end in ends:
            whole = self.alone(f"whole.{end}", *more)
            for ranks in self.COUNTS:
                with self.subTest(ranks=ranks, end=end):
                    output = self.folder / f"picture-{ranks}.{end}"
                    self.mpirun(ranks, "render", self.session, "-o", output, "--quiet", *more)
                    self.assertEqual(output.read_bytes(), whole)
        self.assertEqual(self.temporary_files(), [])

    def test_a_resident_volume(self):
        self.check_equal()
        self.check_equal("--with-session", "--scale-bar", "--title", "Tubes", ends=("png",))

    def test_a_paged_volume_with_occlusion_in_panes(self):
        self.check_equal(*PAGED, "--set", "light.occlusion.strength=0.5", "--set", "view.arrangement=overview",
                         ends=("pfm",))

    def test_a_project_that_exceeds_every_budget(self):
        made = self.check_json("phantom", "tubes", "--size", "256", "--seed", "1", "-o", self.folder / "phantom")
        self.check("import", made["volume"], self.folder / "project", "--quiet")
        self.session = self.folder / "project"
        # A picture of 37 MB in floats, under 16 MiB of host memory: strips wait for those above them.
        self.check_equal("--size", "1200x1900", "--set", "render.paging=always", "--set", "render.detail=0",
                         "--budget-device", "24", "--budget-host", "16", "--threads", "1", ends=("pfm",))

    def test_counters_of_ranks_make_those_of_one_process(self):
        more = [*PAGED, "--json", "--quiet"]
        alone = json.loads(subprocess.run([PROGRAM, "render", self.session, "-o", self.folder / "a.png", *more],
                                          check=True, capture_output=True, text=True).stdout)
        result = self.mpirun(3, "render", self.session, "-o", self.folder / "b.png", *more)
        told = json.loads(result.stdout)  # one object: rank 0 alone prints
        self.assertEqual([rank["rank"] for rank in told["ranks"]], [0, 1, 2])
        self.assertEqual(sum(rank["rows"] for rank in told["ranks"]), 320)
        self.assertTrue(told["complete"])
        for name in ("rays", "samples"):
            self.assertEqual(told["counters"][name], alone["counters"][name])
            self.assertEqual(sum(rank["counters"][name] for rank in told["ranks"]), alone["counters"][name])
        for rank in told["ranks"]:
            self.assertLessEqual(rank["bytes"]["peak_device"], 32 << 20)
            self.assertLessEqual(rank["bytes"]["peak_host"], 32 << 20)

    def kill(self, rank, number):
        """Sends a signal to a rank once the picture is being written; returns what mpirun printed."""
        output = self.folder / "picture.png"
        output.write_bytes(b"old")
        # Hours of work: only the signal ends it.
        process = self.start(3, "render", self.session, "-o", output, "--size", "16000x60000", "--set",
                             "render.step_voxels=0.01")
        while process.poll() is None and not self.temporary_files():
            os.sched_yield()
        self.assertIsNone(process.poll(), "mpirun ended before the picture was begun")
        self.assertEqual(len(self.processes()), 4, self.processes())  # mpirun and three ranks
        os.kill(self.process_of(process.pid, rank), number)
        told, errors = process.communicate()
        self.assertNotEqual(process.returncode, 0)
        self.assertEqual(told, "")
        self.check_no_process_is_left()
        self.assertEqual(output.read_bytes(), b"old")
        self.assertEqual(self.temporary_files(), [])
        return errors

    def test_a_killed_rank_ends_the_picture_with_a_message_and_leaves_no_file_or_process(self):
        for rank in (1, 2):
            with self.subTest(rank=rank):
                lines = lines_of_shvr(self.kill(rank, signal.SIGKILL))
                self.assertEqual(len(lines), 1, lines)
                self.assertIn("a rank is lost; no file is left half written", lines[0])

    def test_a_killed_rank_0_leaves_no_file_or_process(self):
        # Only mpirun is left to say so.
        errors = self.kill(0, signal.SIGKILL)
        self.assertEqual(lines_of_shvr(errors), [])
        self.assertIn("rank 0", errors)

    def test_an_error_of_one_rank_is_told_once(self):
        output = self.folder / "picture.png"
        wrapper = self.folder / "wrapper"
        for failing in (0, 2):
            with self.subTest(failing=failing):
                # One rank lacks a device.
                wrapper.write_text(f'#!/bin/sh\nif [ "$OMPI_COMM_WORLD_RANK" = {failing} ]; then set -- "$@" --device '
                                   f'nowhere; fi\nexec {PROGRAM} "$@"\n')
                wrapper.chmod(0o755)
                command = self.command(3, "render", self.session, "-o", output)
                command[3] = str(wrapper)
                result = self.run_ranks(command)
                lines = lines_of_shvr(result.stderr)
                self.assertEqual(len(lines), 1, result.stderr)
                self.assertIn("nowhere", lines[0])
                self.assertEqual(lines[0].count("(rank 2 of 3, on "), 1 if failing == 2 else 0)
                self.assertFalse(output.exists())
                self.assertEqual(self.temporary_files(), [])

    def run_ranks(self, command):
        result = subprocess.run(command, capture_output=True, text=True, env=ENVIRONMENT_OF_RANKS)
        self.assertEqual((result.returncode, result.stdout), (1, ""), result.stderr)
        return result

    def test_an_error_of_all_ranks_is_told_once(self):
        for arguments, status, says in (([self.folder / "none.json"], 1, "none.json"),
                                        ([self.session, "--no-such-option"], 2, "--no-such-option"),
                                        ([self.session, "--task", "0/2"], 2, "--task"),
                                        ([self.session, "--size", "4y4"], 2, "4y4")):
            with self.subTest(says=says):
                result = self.mpirun(3, "render", *arguments, "-o", self.folder / "picture.png", status=status)
                lines = lines_of_shvr(result.stderr)
                self.assertEqual((len(lines), result.stdout), (1, ""), result.stderr)
                self.assertIn(says, lines[0])

    def test_a_movie_is_refused_and_help_is_printed_once(self):
        result = self.mpirun(2, "render", self.session, "--movie", self.folder / "frames", "--turntable", "90", status=2)
        self.assertEqual(len(lines_of_shvr(result.stderr)), 1, result.stderr)
        self.assertFalse((self.folder / "frames").exists())
        self.assertEqual(self.mpirun(2, "render", "--help").stdout.count("Makes a picture"), 1)


if __name__ == "__main__":
    unittest.main()
