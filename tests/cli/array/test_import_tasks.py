"""shvr import --task: a project made by several processes equals that of one process, file by file."""
import json
import random
import shutil
import signal
import struct
import subprocess
import sys
import unittest
from pathlib import Path

from harness import ENVIRONMENT, IS_SLOW, SHVR, Volume
from tasks import SplitTest, files_below

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "remote"))
from store_server import StoreServer  # noqa: E402


STOP_IN_SAVE = Path(SHVR).resolve().parent / "stubs" / "libstop_in_save.so"


class ImportTasks(SplitTest):
    OTHER = ["--blur", "2.5"]

    def write_volume(self, size, voxel_type="uint8", seed=3):
        """Smooth enough to compress, with every slice different."""
        numbers = random.Random(seed)
        row = [numbers.randint(0, 200) for _ in range(size[0])]
        values = []
        for z in range(size[2]):
            for y in range(size[1]):
                shift = (7 * z + 3 * y) % size[0]
                values += row[shift:] + row[:shift]
                values[-1] = (z + y) % 251
        return Volume(size, values, (2.0, 2.0, 3.0), voxel_type).write(self.folder)

    def import_of(self, volume, project, *more):
        return ["import", volume, self.folder / project, *more]

    def check_every_count(self, volume, counts, *more):
        self.check(*self.import_of(volume, "project", *more))
        whole = self.folder / "whole"
        (self.folder / "project").rename(whole)
        for of in counts:
            with self.subTest(of=of, more=more):
                self.tasks(of, *self.import_of(volume, "project", *more))
                self.assertFalse((self.folder / "project").exists())
                told = self.gather(self.folder / "project", "--remove")
                self.assertEqual((told["pieces"], told["missing"]), (of, []))
                self.assert_equal_files(self.folder / "project", whole)
                shutil.rmtree(self.folder / "project")
        shutil.rmtree(whole)

    def test_projects_are_equal_file_by_file(self):
        # 7 slabs of 64 slices; layers of the first three levels lie across the borders of most tasks.
        self.check_every_count(self.write_volume((70, 40, 410)), (*self.COUNTS, 9) if IS_SLOW else self.COUNTS)

    def test_preparation_shards_and_floats_are_equal_too(self):
        volume = self.write_volume((40, 33, 330))
        self.check_every_count(volume, (3,), "--crop", "3,2,10,39,30,300", "--reverse", "--blur", "0.8",
                               "--downscale", "1")
        self.check_every_count(volume, (3,), "--ome-zarr", "0.5", "--shards")
        self.check_every_count(volume, (2,), "--labels")
        size = (20, 17, 200)
        values = [float("nan") if i % 977 == 0 else i % 331 - 7.5 for i in range(size[0] * size[1] * size[2])]
        self.check_every_count(Volume(size, values, voxel_type="float").write(self.folder, "floats"), (3,))

    def test_a_long_volume_has_levels_beyond_the_sixth(self):
        # 65 slabs: level 6 has 65 slices, and the level after it depends on those of all tasks.
        self.check_every_count(self.write_volume((5, 4, 4130)), (2, 7) if IS_SLOW else (3,))

    def test_a_sparse_volume_is_imported_while_joining(self):
        size = (70, 70, 600)
        values = [0] * (size[0] * size[1] * size[2])
        values[5] = 9
        project = self.folder / "sparse"
        self.check("import", Volume(size, values).write(self.folder, "dense"), project, "--quiet")
        self.check_every_count(project, (3,))

    def test_tasks_may_be_killed_repeated_and_run_twice(self):
        volume = self.write_volume((90, 80, 400))
        output = self.folder / "project"
        arguments = self.import_of(volume, "project")
        self.check_rules(output, *arguments)
        for number in (signal.SIGKILL, signal.SIGTERM):
            process = subprocess.Popen([SHVR, *map(str, arguments), "--task", "1/3", "--quiet"], env=ENVIRONMENT,
                                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            part = Path(f"{output}.pieces") / "piece-1.part" / "0"
            while process.poll() is None and not part.exists():
                pass
            process.send_signal(number)
            process.wait()
        self.tasks(3, *arguments, order=(1,))
        self.gather(output)
        whole = self.folder / "whole"
        output.rename(whole)
        self.check(*arguments)
        self.assert_equal_files(output, whole)

    def temporary_files(self):
        return sorted(file for file in self.folder.rglob(".shvr-*.tmp"))

    def kill_in_save(self, *arguments):
        """Kills a task while the state of its piece has its temporary name."""
        process = subprocess.Popen([SHVR, *map(str, arguments), "--quiet"], stdout=subprocess.DEVNULL,
                                   stderr=subprocess.DEVNULL,
                                   env={**ENVIRONMENT, "LD_PRELOAD": str(STOP_IN_SAVE), "SHVR_STOP_AT_CREATE": "/.shvr-",
                                        "SHVR_STOP_SIGNAL": str(int(signal.SIGKILL))})
        self.assertEqual(process.wait(), -signal.SIGKILL)

    def test_what_a_killed_task_left_is_removed_by_gather_and_by_the_next_task(self):
        arguments = self.import_of(self.write_volume((20, 17, 130)), "project")
        self.tasks(2, *arguments, order=(0,))
        for remover in ("gather", "task 0", "task 1"):
            with self.subTest(remover=remover):
                self.kill_in_save(*arguments, "--task", "1/2")
                self.assertEqual(len(self.temporary_files()), 1)
                if remover == "gather":
                    self.gather(self.folder / "project", status=1)
                else:
                    self.tasks(2, *arguments, order=(int(remover[-1]),))
                self.assertEqual(self.temporary_files(), [])
        self.gather(self.folder / "project")

    def test_a_damaged_manifest_is_refused_by_tasks_and_by_gather_and_written_again(self):
        arguments = self.import_of(self.write_volume((20, 17, 130)), "project")
        self.tasks(2, *arguments, order=(0,))
        manifest = self.folder / "project.pieces" / "manifest.json"
        whole = manifest.read_text()
        for text, says in ((whole[:60], "is not JSON"), (whole.replace('"tasks": 2', '"tasks": -2'), "key tasks is -2; expected")):
            manifest.write_text(text)
            for command in (("gather", self.folder / "project.pieces"), (*arguments, "--task", "1/2")):
                self.check_refused(*command, status=1, says=[str(manifest), says, "remove this file, and run any task"])
        manifest.unlink()
        self.tasks(2, *arguments, order=(1,))
        self.assertEqual(manifest.read_text(), whole)
        self.gather(self.folder / "project")

    def test_a_project_that_is_in_the_way_is_refused_before_the_work_and_after_it(self):
        arguments = self.import_of(self.write_volume((20, 17, 130)), "project")
        self.tasks(2, *arguments)
        self.gather(self.folder / "project")
        self.tasks(2, *arguments)  # all is done
        self.check_refused("gather", self.folder / "project", status=1,
                           says=["project: already exists", "once the pieces are joined", "remove it"])
        shutil.rmtree(self.folder / "project.pieces")
        self.check_refused(*arguments, "--task", "0/2", status=1, says=["project: already exists", "--overwrite"])
        self.assertFalse((self.folder / "project.pieces" / "piece-0").exists())
        before = files_below(self.folder / "project")
        shutil.rmtree(self.folder / "project.pieces")
        self.tasks(2, *arguments, "--overwrite")
        for _ in range(2):
            self.gather(self.folder / "project")
        self.assertEqual(files_below(self.folder / "project"), before)

    def test_a_volume_at_an_address_is_split(self):
        volume = self.write_volume((90, 80, 400))
        served = self.folder / "served"
        served.mkdir()
        self.check(*self.import_of(volume, "served/x"), "--quiet")
        shutil.rmtree(served / "x" / "shvr")  # an image that is no project, and states no statistics
        with StoreServer(served) as server:
            address, output = server.address("x"), self.folder / "project"
            self.check("import", address, output, "--quiet")
            output.rename(self.folder / "whole")
            arguments = ["import", address, output]
            self.tasks(3, *arguments, order=(2, 0))
            process = subprocess.Popen([SHVR, *map(str, arguments), "--task", "1/3", "--quiet"], env=ENVIRONMENT,
                                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            part = Path(f"{output}.pieces") / "piece-1.part" / "0"
            while process.poll() is None and not part.exists():
                pass
            process.kill()
            process.wait()
            self.tasks(3, *arguments, order=(1,))
            self.gather(output)
        self.assert_equal_files(output, self.folder / "whole")

    def test_a_changed_source_and_incomplete_volumes_are_refused(self):
        volume = self.write_volume((20, 20, 130))
        self.check_refused(*self.import_of(volume, "project", "--allow-incomplete", "--task", "0/2"), status=2,
                           says=["--allow-incomplete"])
        self.assertFalse((self.folder / "project.pieces").exists())
        self.tasks(2, *self.import_of(volume, "project"))
        # The voxels are in another file than the header.
        data = self.folder / "volume.raw"
        data.write_bytes(struct.pack("B", 77) + data.read_bytes()[1:])
        self.check_refused("gather", self.folder / "project.pieces", status=1, says=["volume.raw", "to start over"])
        self.assertFalse((self.folder / "project").exists())
        self.assertFalse((self.folder / "project.part").exists())
        manifest = json.loads((self.folder / "project.pieces" / "manifest.json").read_text())
        self.assertEqual((manifest["shvr_pieces"], manifest["tasks"]), (1, 2))


if __name__ == "__main__":
    unittest.main()
