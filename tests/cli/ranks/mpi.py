"""Shared by the tests of pictures that several processes draw: a build with MPI, and starts of mpirun."""
import os
import re
import shutil
import subprocess
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from harness import ENVIRONMENT, SHVR, TIMEOUT_S, CliTest  # noqa: E402

ROOT = Path(__file__).resolve().parents[3]
OTHER_BUILD = ROOT / "build" / "mpi"  # made by these tests, unless SHVR is a build with MPI
SKIPPED = 77
PATIENCE_S = 20  # for ranks that mpirun has told to end

# OpenMPI as it is installed refuses root and more processes than cores. It is told so by its own variables.
ENVIRONMENT_OF_RANKS = {**ENVIRONMENT, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
                        "OMPI_MCA_rmaps_base_oversubscribe": "1", "OMPI_MCA_btl_vader_single_copy_mechanism": "none"}


def program():
    """A shvr that was built with MPI. Ends the file of tests as skipped, with the reason, if there can be none."""
    for name in ("mpirun", "mpicxx"):
        if not shutil.which(name):
            print(f"skipped: {name} is not installed; packages: openmpi-bin libopenmpi-dev")
            sys.exit(SKIPPED)
    cache = Path(SHVR).resolve().parent / "CMakeCache.txt"
    if cache.is_file() and re.search(r"^SHVR_MPI:BOOL=(ON|1|TRUE)$", cache.read_text(), re.M):
        return str(Path(SHVR).resolve())
    subprocess.run(["cmake", "-S", ROOT, "-B", OTHER_BUILD, "-G", "Ninja", "-DSHVR_MPI=ON"], check=True,
                   stdout=subprocess.DEVNULL)
    subprocess.run(["cmake", "--build", OTHER_BUILD, "--target", "shvr", "-j", "2"], check=True,
                   stdout=subprocess.DEVNULL)
    return str(OTHER_BUILD / "shvr")


PROGRAM = program()


def lines_of_shvr(text):
    """The lines that shvr printed: mpirun adds its own."""
    return [line for line in text.splitlines() if line.startswith(("shvr: ", "warning: "))]


class RanksTest(CliTest):
    def command(self, ranks, *arguments):
        return ["mpirun", "-n", str(ranks), PROGRAM, *map(str, arguments)]

    def mpirun(self, ranks, *arguments, status=0, environment=None):
        result = subprocess.run(self.command(ranks, *arguments), capture_output=True, text=True, timeout=TIMEOUT_S,
                                env={**ENVIRONMENT_OF_RANKS, **(environment or {})})
        self.assertEqual(result.returncode, status, f"{ranks} ranks, {arguments}\n{result.stdout}\n{result.stderr}")
        return result

    def start(self, ranks, *arguments):
        return subprocess.Popen(self.command(ranks, *arguments), stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                text=True, env=ENVIRONMENT_OF_RANKS)

    def process_of(self, mpirun, rank):
        """The process of a rank; null until it has been started."""
        for folder in Path("/proc").iterdir():
            try:
                if folder.name.isdigit() and int((folder / "stat").read_text().rpartition(")")[2].split()[1]) == mpirun:
                    variables = (folder / "environ").read_bytes().split(b"\0")
                    if f"OMPI_COMM_WORLD_RANK={rank}".encode() in variables:
                        return int(folder.name)
            except OSError:
                pass  # it has ended meanwhile
        return None

    def processes(self):
        """mpirun and ranks: the command lines that name a file of this test."""
        found = []
        for folder in Path("/proc").iterdir():
            try:
                words = (folder / "cmdline").read_bytes().decode(errors="replace").split("\0")
            except OSError:
                continue  # it has ended meanwhile, or is no process
            if any(word.startswith(str(self.folder)) for word in words):
                found.append(" ".join(words))
        return found

    def check_no_process_is_left(self):
        end = time.monotonic() + PATIENCE_S
        while self.processes():
            self.assertLess(time.monotonic(), end, self.processes())
            time.sleep(0.05)

    def temporary_files(self):
        return [name for name in os.listdir(self.folder) if name.startswith(".shvr-")]
