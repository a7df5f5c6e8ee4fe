"""Shared by the tests of the command line: running the program, tiny volumes, and brushes in plain Python."""
import itertools
import json
import math
import os
import random
import re
import struct
import subprocess
import sys
import tempfile
import unittest
from collections import deque
from pathlib import Path

SHVR = os.environ.get("SHVR", "build/dev/shvr")
TIMEOUT_S = 500  # of one start; ctest ends a file after 600

# A line of progress on standard error, printed by any command that takes longer than a second.
PROGRESS = re.compile(r": (\d+ %(, [\d.]+ MB/s|, frame \d+ of \d+)?(, (\d+ (h|min|s) ?)+ left)?|(\d+ (h|min|s) ?)+ so far)$")

# Tests neither read nor change the user's own preferences.
CONFIGURATION = tempfile.TemporaryDirectory(prefix="shvr-config-")

# SHVR_SLOW=1 repeats each proof on every input; the everyday run repeats it on a selection that covers all cases.
IS_SLOW = os.environ.get("SHVR_SLOW") == "1"

# The file whose starts of a command the Vulkan validation layer watches every day: the layer costs a third of a start.
# Any message of it makes the command fail. SHVR_SLOW=1 watches every start of every file.
VALIDATED = {"annotate": "test_annotate.py", "bench": "test_bench.py", "compare": "test_compare.py",
             "doctor": "test_doctor.py", "evaluate": "test_evaluate.py", "export": "test_export.py", "golden": "test_golden.py",
             "gather": "test_label_tasks.py", "haptics": "test_haptics.py", "import": "test_import.py", "info": "test_info.py",
             "label": "test_label.py", "phantom": "test_phantom.py", "profile": "test_profile.py",
             "render": "test_render.py", "study": "test_study.py", "view": "test_view.py"}
IS_VALIDATED = IS_SLOW or Path(sys.argv[0]).name in VALIDATED.values()

# The environment of every start. Hazards are validated between submissions, too. All files share the shaders that Mesa
# compiled, while the program's own cache is new for each file.
BUILD = Path(SHVR).resolve().parent
ENVIRONMENT = {"no_proxy": "127.0.0.1,localhost",  # the servers of tests
               "VK_LAYER_ENABLES": "VALIDATION_CHECK_ENABLE_SYNCHRONIZATION_VALIDATION_QUEUE_SUBMIT",
               "VK_ADD_LAYER_PATH": str(BUILD / "layers"), "MESA_SHADER_CACHE_DIR": str(BUILD / "cache"),
               **os.environ, "SHVR_VALIDATION": "1" if IS_VALIDATED else "", "LC_ALL": "C",
               "XDG_CONFIG_HOME": CONFIGURATION.name, "XDG_CACHE_HOME": CONFIGURATION.name}


def commands(*command):
    """The names of the program's commands, or of those of a command, as --help lists them."""
    listed = run(*command, "--help").stdout.partition("\nSubcommands:\n")[2].partition("\n\n")[0]
    return re.findall(r"^  (\w+) ", listed, re.M)


def covering(*factors):
    """Tuples of a value from each factor, such that every pair of values of two factors is in one of them.

    Greedy, and the same in every run: each tuple takes, factor by factor, the value that adds the most new pairs."""
    pairs = {(i, a, j, b) for i, j in itertools.combinations(range(len(factors)), 2)
             for a in range(len(factors[i])) for b in range(len(factors[j]))}
    chosen = []
    while pairs:
        i, a, j, b = min(pairs)
        row = {i: a, j: b}
        for k in range(len(factors)):
            if k not in row:
                row[k] = max(range(len(factors[k])), key=lambda value, k=k: sum(
                    (min((k, value), other) + max((k, value), other)) in pairs for other in row.items()))
        pairs -= {(*one, *other) for one, other in itertools.combinations(sorted(row.items()), 2)}
        chosen.append(tuple(factors[k][row[k]] for k in range(len(factors))))
    return chosen


def run(*arguments, environment=None):
    """Runs shvr; the result has returncode, stdout and stderr."""
    return subprocess.run([SHVR, *map(str, arguments)], capture_output=True, text=True, timeout=TIMEOUT_S,
                          env={**ENVIRONMENT, **(environment or {})})


class CliTest(unittest.TestCase):
    """Every test has its own empty folder."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="shvr-cli-")
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def check(self, *arguments, status=0):
        result = run(*arguments)
        self.assertEqual(result.returncode, status, f"shvr {arguments}\n{result.stdout}\n{result.stderr}")
        return result

    def check_json(self, *arguments, status=0):
        """The JSON object on standard output."""
        result = self.check(*arguments, "--json", status=status)
        value = json.loads(result.stdout)
        self.assertIsInstance(value, dict)
        return value

    def check_refused(self, *arguments, status=1, says=()):
        """Expects a failure: one sentence with all of `says` on standard error, nothing on standard output."""
        result = self.check(*arguments, status=status)
        self.assertEqual(result.stdout, "")
        lines = [line for line in result.stderr.splitlines()
                 if not line.startswith("warning: ") and not PROGRESS.search(line)]
        self.assertEqual(len(lines), 1, result.stderr)
        self.assertTrue(lines[0].startswith("shvr: "), result.stderr)
        for word in says:
            self.assertIn(word, result.stderr)
        return result.stderr

    def assert_keys(self, value, keys):
        self.assertEqual([key for key in keys if key not in value], [])

    def mask_of(self, project):
        """The groups of a project as bytes, x fastest."""
        path = self.folder / "exported.mask"
        self.check("export", project, "--mask", path, "--quiet")
        return path.read_bytes()

    def write_json(self, name, value):
        path = self.folder / name
        path.write_text(json.dumps(value))
        return path

    def write_script(self, name, operations):
        path = self.folder / name
        path.write_text("".join(json.dumps(operation) + "\n" for operation in operations))
        return path

    def write_session(self, name="session.json", volume=None, **keys):
        """A session of a tiny picture, with the mask "paint.mask"."""
        return self.write_json(name, {"shvr_session": 1,
                                      "volume": volume or {"procedural": "sphere", "size": [24, 24, 24]},
                                      "transfer_function": {"points": [
                                          {"intensity": 60, "color": "#204080", "opacity": 0.0},
                                          {"intensity": 200, "color": "#ffe0c0", "opacity": 0.5}]},
                                      "render": {"size": [24, 16]},
                                      "annotation": {"mask": "paint.mask"},
                                      **keys})


class Volume:
    """Voxels in Python: a list with x fastest."""

    TYPES = {"uint8": "B", "int8": "b", "uint16": "H", "int16": "h", "int32": "i", "float": "f"}

    def __init__(self, size, values, spacing=(1.0, 1.0, 1.0), voxel_type="uint8"):
        self.size, self.values, self.spacing, self.type = size, list(values), spacing, voxel_type

    @staticmethod
    def noise(size, seed, high=255, spacing=(1.0, 1.0, 1.0), voxel_type="uint8"):
        numbers = random.Random(seed)
        count = size[0] * size[1] * size[2]
        return Volume(size, [numbers.randint(0, high) for _ in range(count)], spacing, voxel_type)

    def write(self, folder, name="volume", endian="little"):
        """NAME.raw with its header NAME.nhdr; returns the header."""
        order = "<" if endian == "little" else ">"
        packed = struct.pack(f"{order}{len(self.values)}{self.TYPES[self.type]}", *self.values)
        (folder / f"{name}.raw").write_bytes(packed)
        header = folder / f"{name}.nhdr"
        header.write_text("NRRD0004\n"
                          f"type: {self.type}\ndimension: 3\nsizes: {' '.join(map(str, self.size))}\n"
                          f"spacings: {' '.join(map(str, self.spacing))}\n"
                          f"encoding: raw\nendian: {endian}\ndata file: {name}.raw\n")
        return header

    def index(self, voxel):
        return voxel[0] + self.size[0] * (voxel[1] + self.size[1] * voxel[2])

    # ---- Brushes by their definitions, slow and simple ----

    def region(self, shape, position, radius):
        """Voxels of a ball (centres within the radius, measured along x, in physical units) or of its box."""
        reach = radius * self.spacing[0]

        def belongs(voxel):
            away = [(voxel[i] + 0.5 - position[i]) * self.spacing[i] for i in range(3)]
            if shape == "box":
                return all(abs(a) <= reach for a in away)
            return sum(a * a for a in away) <= reach * reach

        near = [range(max(0, math.floor(position[i] - reach / self.spacing[i]) - 1),
                      min(self.size[i], math.ceil(position[i] + reach / self.spacing[i]) + 1)) for i in range(3)]
        return {voxel for voxel in itertools.product(*near) if belongs(voxel)}

    def component(self, seed, allowed, connectivity):
        """The voxels connected to `seed` within `allowed`, breadth first."""
        found, queue = {seed}, deque([seed])
        while queue:
            voxel = queue.popleft()
            for step in NEIGHBOURS[connectivity]:
                next_voxel = tuple(a + b for a, b in zip(voxel, step))
                if next_voxel in allowed and next_voxel not in found:
                    found.add(next_voxel)
                    queue.append(next_voxel)
        return found

    def select(self, operation):
        """The voxels that a paint operation paints."""
        selected = set()
        connectivity = operation.get("connectivity", 6)
        for position in stroke(operation["path"]):
            region = self.region(operation["region"], position, operation["radius"])
            above = {voxel for voxel in region if self.values[self.index(voxel)] >= operation["threshold"]}
            if operation["brush"] == "fill":
                selected |= above
            elif operation["brush"] == "flood":
                seed = tuple(math.floor(p) for p in position)
                if seed in above:
                    selected |= self.component(seed, above, connectivity)
            else:
                # The edge of a region: its voxels with a face neighbour outside it.
                edge = {voxel for voxel in region
                        if any(tuple(a + b for a, b in zip(voxel, step)) not in region for step in NEIGHBOURS[6])}
                rest = set(above)
                while rest:
                    found = self.component(next(iter(rest)), above, connectivity)
                    rest -= found
                    if not found & edge:
                        selected |= found
        return selected


NEIGHBOURS = {6: [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)],
              26: [step for step in itertools.product((-1, 0, 1), repeat=3) if step != (0, 0, 0)]}


def stroke(path):
    """The probe's positions: the points, and between them enough that neighbours are at most a voxel apart."""
    positions = [path[0]]
    for a, b in zip(path, path[1:]):
        steps = max(1, math.ceil(max(abs(q - p) for p, q in zip(a, b))))
        positions += [[p + (q - p) * i / steps for p, q in zip(a, b)] for i in range(1, steps + 1)]
    return positions


def read_png_header(path):
    """(width, height) of a PNG file."""
    data = Path(path).read_bytes()
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    return struct.unpack(">II", data[16:24])
