"""A job array of Slurm itself: slurmctld, slurmd and munge on this machine run the scripts of tools/slurm. Tasks are
killed, told to end, and requeued while they write; what gather joins equals the work of one process. Skipped where
Slurm or munge is not installed."""
import json
import os
import pwd
import re
import shutil
import signal
import socket
import subprocess
import sys
import time
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from harness import ENVIRONMENT, SHVR, Volume  # noqa: E402
from placed_files import write_tiff  # noqa: E402
from tasks import SplitTest, files_below  # noqa: E402

SCRIPTS = Path(__file__).resolve().parents[3] / "tools" / "slurm"
STOP_IN_SAVE = Path(SHVR).resolve().parent / "stubs" / "libstop_in_save.so"
PATH = os.environ.get("PATH", "") + ":/usr/sbin"
NEEDED = ("slurmctld", "slurmd", "munged", "sbatch", "scancel", "scontrol", "squeue")
MISSING = [name for name in NEEDED if not shutil.which(name, path=PATH)]
WAIT_S = 300  # for what Slurm does in a second or, for a requeued task, in ten

# Every processor takes several tasks, so that four of them run at once on any machine. A requeued task waits until its
# credential has expired.
CONFIGURATION = """
ClusterName=shvr
SlurmctldHost={host}(127.0.0.1)
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
CredType=cred/munge
AuthInfo=socket={folder}/munge.socket,cred_expire=5
SlurmctldPort={controller}
SlurmdPort={node}
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/affinity
MpiDefault=none
ReturnToService=2
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
KillWait=60
NodeName={host} NodeAddr=127.0.0.1 CPUs={processors} RealMemory=500 State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP OverSubscribe=FORCE:4
"""

# Stops tasks 1, 2 and 3 in the middle of their first run: once they have finished a slab, and a chunk of the next one
# exists.
STOPPING = """#!/bin/bash
index=${{SLURM_ARRAY_TASK_ID:-0}}
if [ "$1" = import ] && [ "$index" -gt 0 ] && mkdir "{folder}/began-$index" 2> /dev/null; then
    echo $$ > "{folder}/began-$index/pid"
    export LD_PRELOAD={stub} SHVR_STOP_SIGNAL={stop} SHVR_STOP_AT_CREATE=".part/0/$((2 * index + 1))/"
fi
exec {shvr} "$@"
"""


def free_ports(count):
    """Ports of this machine that are free."""
    sockets = [socket.socket() for _ in range(count)]
    for each in sockets:
        each.bind(("127.0.0.1", 0))
    ports = [each.getsockname()[1] for each in sockets]
    for each in sockets:
        each.close()
    return ports


@unittest.skipIf(MISSING, f"{', '.join(MISSING)} not installed (Debian: slurm-wlm, munge)")
class Slurm(SplitTest):
    def setUp(self):
        super().setUp()
        self.daemons = self.folder / "slurm"
        for name in ("state", "spool"):
            (self.daemons / name).mkdir(parents=True)
        key = self.daemons / "key"
        key.write_bytes(os.urandom(128))
        key.chmod(0o400)
        controller, node = free_ports(2)
        host = socket.gethostname().partition(".")[0]
        (self.daemons / "slurm.conf").write_text(CONFIGURATION.format(
            host=host, user=pwd.getpwuid(os.getuid()).pw_name, folder=self.daemons, controller=controller, node=node,
            processors=len(os.sched_getaffinity(0))))
        self.environment = {**ENVIRONMENT, "PATH": PATH, "SLURM_CONF": str(self.daemons / "slurm.conf"),
                            "SHVR_NODE_CACHE": str(self.folder / "cache"), "SHVR": str(Path(SHVR).resolve()),
                            "SBATCH_OPTIONS": "--cpus-per-task=1 --mem=100M"}
        # In a private folder munged warns, and says that only one user reaches it.
        self.serve("munged", "--foreground", "--force", "--num-threads=2", f"--key-file={key}",
                   *(f"--{name}-file={self.daemons / 'munge'}.{name}" for name in ("pid", "log", "seed")),
                   f"--socket={self.daemons / 'munge.socket'}")
        self.wait("munge's socket", (self.daemons / "munge.socket").exists)
        self.serve("slurmctld", "-D", "-c")
        self.serve("slurmd", "-D", "-N", host)
        self.wait("an idle node", lambda: "idle" in self.ask("sinfo", "--noheader", "--format=%T", fails=True).split())

    def serve(self, *command):
        log = (self.daemons / f"{command[0]}.out").open("w")
        self.addCleanup(log.close)
        process = subprocess.Popen(command, env=self.environment, stdout=log, stderr=log, cwd=self.daemons)

        def end():
            process.terminate()
            try:
                process.wait(timeout=WAIT_S)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
        self.addCleanup(end)

    def ask(self, *command, fails=False, environment=None):
        result = subprocess.run(list(map(str, command)), env={**self.environment, **(environment or {})},
                                capture_output=True, text=True, cwd=self.folder)
        if not fails:
            self.assertEqual(result.returncode, 0, f"{command}\n{result.stdout}{result.stderr}\n{self.told()}")
        return result.stdout

    def told(self):
        """What the daemons and the jobs said."""
        files = [file for folder in (self.daemons, self.folder) for form in ("log", "out")
                 for file in sorted(folder.glob(f"*.{form}"))]
        return "\n".join(f"== {file.name}\n{file.read_text(errors='replace')[-3000:]}" for file in files)

    def wait(self, what, holds):
        end = time.monotonic() + WAIT_S
        while not holds():
            if time.monotonic() > end:
                self.fail(f"no {what} after {WAIT_S} s\n{self.told()}")
            time.sleep(0.05)

    def states(self, job):
        """{task or job: (state, reason)} of a job that Slurm remembers."""
        rows = self.ask("squeue", "--states=all", "--array", "--noheader", "--format=%i %T %r", f"--jobs={job}")
        return {name: (state, reason) for name, state, reason in (row.split(maxsplit=2) for row in rows.splitlines())}

    def submit(self, *command, environment=None):
        """Submits 4 tasks; returns the numbers of the array and of the job that joins. The script prints the latter."""
        output = command[command.index("import") + 2 if "import" in command else command.index("-o") + 1]
        gather = int(self.ask(SCRIPTS / "submit", 4, output, *command, environment=environment))
        return gather - 1, gather

    def wait_for_end(self, job):
        """Returns {task: state} once all have ended."""
        ended = {"COMPLETED", "FAILED", "CANCELLED"}
        self.wait(f"end of job {job}", lambda: all(state in ended for state, _ in self.states(job).values()))
        return {name: state for name, (state, _) in self.states(job).items()}

    def stopped_task(self, index):
        """Waits until the task has stopped in its first run, and returns its process."""
        number = self.folder / f"began-{index}" / "pid"
        self.wait(f"task {index}", lambda: number.exists() and number.read_text())
        status = Path(f"/proc/{int(number.read_text())}/status")
        self.wait(f"stop of task {index}", lambda: "State:\tT" in status.read_text())
        return int(number.read_text())

    def wait_for_signal(self, process):
        """Waits until a stopped process has been told to end: the signal is pending, or Slurm has continued it."""
        def is_told():
            try:
                status = Path(f"/proc/{process}/status").read_text()
            except FileNotFoundError:
                return True
            pending = sum(int(mask, 16) for mask in re.findall(r"^(?:SigPnd|ShdPnd):\s*(\w+)", status, re.M))
            return "State:\tT" not in status or pending & 1 << signal.SIGTERM - 1
        self.wait(f"signal to process {process}", is_told)
        try:
            os.kill(process, signal.SIGCONT)
        except ProcessLookupError:
            pass

    def write_volume(self):
        """8 slabs of 64 slices, two for each task."""
        size = (33, 20, 512)
        values = [(x * y + 7 * z + x) % 251 for z in range(size[2]) for y in range(size[1]) for x in range(size[0])]
        return Volume(size, values).write(self.folder)

    def stopping_program(self):
        program = self.folder / "shvr-that-stops"
        program.write_text(STOPPING.format(folder=self.folder, stub=STOP_IN_SAVE, stop=int(signal.SIGSTOP),
                                           shvr=Path(SHVR).resolve()))
        program.chmod(0o755)
        return {"SHVR": str(program)}

    def test_killed_ended_and_requeued_tasks_make_the_project_of_one_process(self):
        volume, project = self.write_volume(), self.folder / "project"
        command = ("import", volume, project)
        array, gather = self.submit(*command, environment=self.stopping_program())
        processes = {index: self.stopped_task(index) for index in (1, 2, 3)}
        parts = {index: project.parent / "project.pieces" / f"piece-{index}.part" / "0" for index in (1, 2, 3)}
        done = {index: (parts[index] / str(2 * index) / "0" / "0").stat() for index in (1, 3)}
        # Task 1 is killed by something else than Slurm, such as a machine out of memory.
        os.kill(processes[1], signal.SIGKILL)
        # Task 2 is requeued, as if its node were needed: it is told to end, and runs once more under the same number.
        self.ask("scontrol", "requeue", f"{array}_2")
        self.wait_for_signal(processes[2])
        # Task 3 is told to end as before a time limit.
        self.ask("scancel", "--batch", "--signal=TERM", f"{array}_3")
        self.wait_for_signal(processes[3])
        self.assertEqual(self.wait_for_end(array), {f"{array}_0": "COMPLETED", f"{array}_1": "FAILED",
                                                    f"{array}_2": "COMPLETED", f"{array}_3": "FAILED"}, self.told())
        # The job that joins never runs, and says why; by hand, too, nothing is joined.
        self.wait("refusal to join", lambda: self.states(gather)[str(gather)][1] == "DependencyNeverSatisfied")
        told = self.check_json("gather", f"{project}.pieces", status=1)
        self.assertEqual((told["missing"], told["path"]), (["1/4", "3/4"], None))
        self.assertFalse(project.exists())
        self.ask("scancel", gather)

        # The same line again: tasks 0 and 2 have their pieces, 1 and 3 go on from the slab that they had finished.
        array, gather = self.submit(*command)
        self.assertEqual(set(self.wait_for_end(array).values()), {"COMPLETED"}, self.told())
        self.assertEqual(self.wait_for_end(gather), {str(gather): "COMPLETED"}, self.told())
        for index, before in done.items():
            after = (project / "0" / str(2 * index) / "0" / "0").stat()
            self.assertEqual((after.st_ino, after.st_mtime_ns), (before.st_ino, before.st_mtime_ns))
        log = (self.folder / f"shvr-{gather}.log").read_text()  # both streams
        told, _ = json.JSONDecoder().raw_decode(log[log.index("{"):])
        self.assertEqual((told["pieces"], told["missing"], told["path"]), (4, [], str(project)))
        project.rename(self.folder / "joined")
        self.check(*command)
        self.assert_equal_files(self.folder / "joined", project)

    def test_labels_and_a_picture_are_those_of_one_process(self):
        volume = Volume.noise((20, 20, 40), seed=3).write(self.folder)
        session = self.write_session(annotation={})
        commands = [("label", volume, "--threshold", 128, "-o"), ("render", session, "-o")]
        for (command, name) in zip(commands, ("labels.nrrd", "picture.pfm")):
            array, gather = self.submit(*command, self.folder / name)
            self.assertEqual(self.wait_for_end(gather), {str(gather): "COMPLETED"}, self.told())
            self.check(*command, self.folder / f"whole-{name}")
            self.assert_equal_files(self.folder / name, self.folder / f"whole-{name}")

    def test_the_worked_example_of_the_page_does_every_scan(self):
        page = (SCRIPTS / "README.md").read_text().partition("## A hundred scans")[2]
        by_slurm, by_xargs, large = re.findall(r"```sh\n(.*?)```", page, re.S)
        for old, new in [("1-100%20", "1-3%20"), ("--cpus-per-task=4", "--cpus-per-task=1"),
                         ("--mem=8G", "--mem=100M")]:
            self.assertIn(old, by_slurm)
            by_slurm = by_slurm.replace(old, new)
        for old, new in [("seq 1 100", "seq 1 3"), ("$((4 * SLOT))-$((4 * SLOT + 3))", "0")]:
            self.assertIn(old, by_xargs)
            by_xargs = by_xargs.replace(old, new)
        (self.folder / "scans").mkdir()
        for name in "abc":
            write_tiff(self.folder / "scans" / f"{name}.tif", (1.0, 1.0, 1.0))
        (self.folder / "bin").mkdir()
        (self.folder / "bin" / "shvr").symlink_to(Path(SHVR).resolve())
        self.environment["PATH"] = f"{self.folder / 'bin'}:{PATH}"
        job = self.ask("bash", "-euo", "pipefail", "-c", by_slurm).split()[-1]
        self.assertEqual(list(self.wait_for_end(job).values()), ["COMPLETED"] * 3, self.told())
        results = files_below(self.folder / "results")
        self.assertEqual(list(results), [f"{name}.{form}" for name in "abc" for form in ("json", "png")])
        for name in ("projects", "results"):
            (self.folder / name).rename(self.folder / f"{name}-by-slurm")
            (self.folder / name).mkdir()
        self.ask("bash", "-euo", "pipefail", "-c", by_xargs)
        for name in results:
            if name.endswith(".png"):
                self.assertEqual((self.folder / "results" / name).read_bytes(), results[name], name)
        self.assert_equal_files(self.folder / "projects", self.folder / "projects-by-slurm")
        before = {name: (self.folder / "results" / name).stat().st_mtime_ns for name in results}
        self.ask("bash", "-euo", "pipefail", "-c", by_xargs)  # all is done
        self.assertEqual({name: (self.folder / "results" / name).stat().st_mtime_ns for name in results}, before)

        (self.folder / "tools").symlink_to(SCRIPTS.parent)
        write_tiff(self.folder / "scans" / "large.tif", (1.0, 1.0, 1.0))
        self.assertEqual(large.count("submit 16"), 2)
        large = large.replace("submit 16", "submit 2").replace('="--dep', f'="{self.environment["SBATCH_OPTIONS"]} --dep')
        job = self.ask("bash", "-euo", "pipefail", "-c", large).strip()
        self.assertEqual(self.wait_for_end(job), {job: "COMPLETED"}, self.told())
        self.assertTrue((self.folder / "projects" / "large").is_dir())
        (self.folder / "large.zarr").rename(self.folder / "joined.zarr")
        self.ask("shvr", "label", "projects/large", "--threshold", "120", "-o", "large.zarr")
        self.assert_equal_files(self.folder / "large.zarr", self.folder / "joined.zarr")

    def test_some_tasks_of_an_array_run_again_where_their_indices_give_the_same_number(self):
        volume = Volume.noise((20, 20, 40), seed=3).write(self.folder)
        command = ("label", volume, "--threshold", 128, "-o", self.folder / "labels.nrrd")
        self.ask(Path(SHVR).resolve(), *command, "--task", "1/8")
        pieces = self.folder / "labels.nrrd.pieces"
        for indices, ends in (("0,7", {"COMPLETED"}), ("3,7", {"FAILED"})):
            job = self.ask("sbatch", "--parsable", "--cpus-per-task=1", "--mem=100M", f"--array={indices}",
                           SCRIPTS / "task.sbatch", *command).strip()
            self.assertEqual(set(self.wait_for_end(job).values()), ends, self.told())
        self.assertEqual([index for index in range(8) if (pieces / f"piece-{index}").exists()], [0, 1, 7])
        log = (self.folder / f"shvr-{job}-3.log").read_text()
        self.assertIn("the job is split into 8 tasks, and this is one of", log)

    def test_a_job_has_as_many_threads_as_processors(self):
        report = self.folder / "doctor.json"
        job = self.ask("sbatch", "--parsable", "--cpus-per-task=1", "--mem=100M", f"--output={report}",
                       "--wrap", f"{Path(SHVR).resolve()} doctor --json 2> /dev/null").strip()
        self.wait_for_end(job)
        self.assertEqual(json.loads(report.read_text())["memory"]["processors"], 1)


if __name__ == "__main__":
    unittest.main()
