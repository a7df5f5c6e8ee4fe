"""shvr render and shvr annotate on a driver that fails: calls of each entry point, each error that they may return, by
a layer (tests/layers/faults.cpp). On a clock that tells the work alone (tests/layers/clocks.cpp), and with one worker,
so that every run makes the same calls, but for those of VARYING, and every fault fires. Each pair of an entry point and
an error is tried in one of the works that make that call; test_faults_slow.py tries every call of every work."""
import concurrent.futures
import os
import subprocess
import tempfile
import unittest
import zlib
from pathlib import Path

from harness import ENVIRONMENT, PROGRESS, SHVR, TIMEOUT_S, CliTest

HOST, DEVICE, LOST = "out_of_host_memory", "out_of_device_memory", "device_lost"
# Errors that calls may return; calls not listed may run out of host memory or device memory.
ERRORS = {"vkMapMemory": [HOST], "vkCreatePipelineCache": [HOST], "vkResetFences": [DEVICE],
          "vkQueueSubmit2": [HOST, DEVICE, LOST], "vkGetFenceStatus": [HOST, LOST],
          "vkWaitForFences": [HOST, DEVICE, LOST], "vkGetQueryPoolResults": [HOST, DEVICE, LOST]}
# Calls whose failure cannot be reported: they have no result that a program could check.
HEEDLESS = ["vkDeviceWaitIdle"]
# Calls whose number depends on the machine: a frame reuses (resets) objects of earlier frames that are done, or makes
# new ones, and waits as long as it must.
VARYING = ["vkAllocateCommandBuffers", "vkCreateCommandPool", "vkCreateDescriptorPool", "vkCreateFence",
           "vkCreateQueryPool", "vkResetCommandPool", "vkResetDescriptorPool", "vkResetFences", "vkWaitForFences"]


def one_number(call, error, count):
    """One call of each pair, the same in every run; of VARYING the first, since a run may make no other."""
    return [1 if call in VARYING else zlib.crc32(f"{call} {error}".encode()) % count + 1]


def all_numbers(_call, _error, count):
    return range(1, count + 1)


class Picture:
    """A picture is drawn, or none is there."""

    def __init__(self, paging, side):
        self.keys = {"volume": {"procedural": "sphere", "size": [side] * 3},
                     "light": {"shaded": True, "occlusion": {"strength": 0.8}},
                     "render": {"size": [24, 16], "paging": paging}}

    def command(self, test, name):
        session = test.write_session(f"{name}/session.json", **self.keys)
        made = session.parent / "picture.pfm"
        return ["render", session, "-o", made, "--json"], made


class Paint:
    """Strokes are painted and saved, or those before one that failed are kept."""

    KEYS = {"volume": {"procedural": "sphere", "size": [40, 36, 34]}, "render": {"size": [24, 16]}}
    STROKES = [{"op": "paint", "brush": brush, "region": "ball", "group": 3, "threshold": 60, "radius": 9,
                "path": [[20, 18, 17], [23, 18, 17]]} for brush in ["fill", "flood", "speckle"]]

    def command(self, test, name):
        session = test.write_session(f"{name}/session.json", **self.KEYS)
        script = test.write_script(f"{name}/strokes.jsonl", [*self.STROKES, {"op": "save"}])
        return ["annotate", session, "--script", script, "--fresh"], session.parent / "paint.mask"


class Faults(CliTest):
    numbers = staticmethod(one_number)
    WORKS = {"picture": Picture("automatic", 24), "picture of paged bricks": Picture("always", 72), "paint": Paint()}

    @classmethod
    def setUpClass(cls):
        """Each work without a fault: how often it makes each call, and the bytes of what it makes."""
        folder = tempfile.TemporaryDirectory(prefix="shvr-faults-")
        cls.addClassCleanup(folder.cleanup)
        cls.counts, cls.made = {}, {}
        for name, work in cls.WORKS.items():
            one = cls("test_calls_of_a_picture_may_fail")
            one.folder, one.work = Path(folder.name), work
            result, log, made = one.run_with(name, "")
            one.assertEqual(result.returncode, 0, result.stderr)
            one.assertNotIn("leaked", log)
            cls.counts[name] = {line.split()[0]: int(line.split()[1]) for line in log.splitlines()}
            one.assertIn("vkQueueSubmit2", cls.counts[name])
            cls.made[name] = made.read_bytes()

    def tries(self, name, call, error):
        """Whether this work is the one, of those that make the call, in which it fails with that error: the same in
        every run."""
        makers = [maker for maker, counts in self.counts.items() if call in counts]
        return makers[zlib.crc32(f"{error} {call}".encode()) % len(makers)] == name

    def run_with(self, name, fault):
        """Returns the process, what the layer says of it, and the file that it makes."""
        (self.folder / name).mkdir()
        arguments, made = self.work.command(self, name)
        log = self.folder / name / "log"
        result = subprocess.run([SHVR, *arguments, "--threads", "1"], capture_output=True, text=True, timeout=TIMEOUT_S,
                                env={**ENVIRONMENT, "SHVR_VALIDATION": "", "SHVR_CLOCKS": "2000",
                                     "VK_INSTANCE_LAYERS": "VK_LAYER_SHVR_faults:VK_LAYER_SHVR_clocks",
                                     "SHVR_FAULTS": fault, "SHVR_FAULTS_LOG": str(log)})
        return result, log.read_text() if log.exists() else "", made

    def check_fault(self, name, fault):
        """What is wrong with how it ends, or nothing."""
        result, log, made = self.run_with(name, fault)
        call, number = fault.split(":")[:2]
        if f"fired {call}" not in log:
            return "" if call in VARYING and number != "1" else f"{fault} did not fire: {result.stderr}"
        if "leaked" in log:
            return f"{fault}: {log}"
        is_whole = made.exists() and made.read_bytes() == self.expected
        if result.returncode == 0:
            # Memory was found at the second attempt, or what needed it was dropped with a warning.
            return "" if is_whole or "warning" in result.stderr else f"{fault}: something else, and nothing said"
        lines = [line for line in result.stderr.splitlines()
                 if not line.startswith("warning: ") and not PROGRESS.search(line)]
        if result.returncode != 1 or len(lines) != 1 or not lines[0].startswith("shvr: "):
            return f"{fault}: status {result.returncode}, {result.stderr}"
        if LOST in fault and "stopped answering" not in lines[0]:
            return f"{fault}: {lines[0]}"
        return f"{fault}: half of it" if made.exists() and not is_whole else ""

    def check_all(self, name):
        self.work, self.expected = self.WORKS[name], self.made[name]
        faults = [f"{call}:{number}:{error}" for call, count in self.counts[name].items() if call not in HEEDLESS
                  for error in ERRORS.get(call, [HOST, DEVICE]) if self.tries(name, call, error)
                  for number in self.numbers(call, error, count)]
        self.assertGreater(len(faults), 5)
        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            wrong = list(pool.map(lambda at: self.check_fault(f"fault-{at[0]}", at[1]), enumerate(faults)))
        self.assertEqual([one for one in wrong if one], [])

    def test_calls_of_a_picture_may_fail(self):
        self.check_all("picture")

    def test_calls_of_a_picture_of_paged_bricks_may_fail(self):
        self.check_all("picture of paged bricks")

    def test_calls_of_painting_may_fail(self):
        self.check_all("paint")

    def test_a_lost_device_is_told_of_with_what_its_driver_says(self):
        session = self.write_session()
        result = subprocess.run([SHVR, "render", session, "-o", self.folder / "a.pfm"], capture_output=True, text=True,
                                timeout=TIMEOUT_S,
                                env={**ENVIRONMENT, "SHVR_VALIDATION": "", "SHVR_LIMITS": "nvidia",
                                     "VK_INSTANCE_LAYERS": "VK_LAYER_SHVR_faults:VK_LAYER_SHVR_limits",
                                     "SHVR_FAULTS": "vkQueueSubmit2:1:device_lost"})
        self.assertEqual(result.returncode, 1)
        self.assertIn("(device lost at vkQueueSubmit2; its driver says: page fault, read at address 0xfeed000, channel "
                      "(code 31)): its driver was reset", result.stderr)

    def test_a_profiled_session_whose_pictures_all_fail_ends(self):
        script = self.write_script("turn.jsonl", [{"op": "orbit", "right_degrees": 30, "up_degrees": 0}])
        result = subprocess.run([SHVR, "profile", self.write_session(), "--script", script], capture_output=True,
                                text=True, timeout=TIMEOUT_S,
                                env={**ENVIRONMENT, "SHVR_VALIDATION": "", "VK_INSTANCE_LAYERS": "VK_LAYER_SHVR_faults",
                                     "SHVR_FAULTS": "vkQueueSubmit2:2+:out_of_device_memory"})
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertIn("memory", result.stderr.splitlines()[-1])


if __name__ == "__main__":
    unittest.main()
