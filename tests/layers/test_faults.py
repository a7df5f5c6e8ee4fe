"""shvr render on a driver that fails: each call of each entry point once, by a layer (tests/layers/faults.cpp)."""
import concurrent.futures
import os
import subprocess
import unittest

from harness import ENVIRONMENT, SHVR, TIMEOUT_S, CliTest

# The error that a call may return beside a lost device.
SHORTAGE = {"vkAllocateMemory": "out_of_device_memory", "vkBindBufferMemory": "out_of_device_memory",
            "vkBindImageMemory": "out_of_device_memory", "vkMapMemory": "out_of_host_memory"}
LOSSES = ["vkQueueSubmit2", "vkGetFenceStatus", "vkWaitForFences", "vkGetQueryPoolResults"]
# Where no memory is refused: it has no result that a program could heed.
HEEDLESS = ["vkDeviceWaitIdle"]
# Of calls that are made often, the first ones, the last ones and some between.
ENDS, BETWEEN = 5, 5


def numbers(count):
    if count <= 2 * ENDS + BETWEEN:
        return range(1, count + 1)
    step = (count - 2 * ENDS) / (BETWEEN + 1)
    return sorted({*range(1, ENDS + 1), *(ENDS + int(step * (i + 1)) for i in range(BETWEEN)),
                   *range(count - ENDS + 1, count + 1)})


class Faults(CliTest):
    def render(self, name, fault):
        """Returns the process and what the layer says of it."""
        log, picture = self.folder / f"{name}.log", self.folder / f"{name}.pfm"
        result = subprocess.run([SHVR, "render", self.session, "-o", picture, "--json"], capture_output=True, text=True,
                                timeout=TIMEOUT_S,
                                env={**ENVIRONMENT, "SHVR_VALIDATION": "", "VK_INSTANCE_LAYERS": "VK_LAYER_SHVR_faults",
                                     "SHVR_FAULTS": fault, "SHVR_FAULTS_LOG": str(log)})
        return result, log.read_text() if log.exists() else "", picture

    def check_fault(self, name, fault):
        """What is wrong with how it ends, or nothing."""
        result, log, picture = self.render(name, fault)
        if f"fired {fault.split(':')[0]}" not in log:
            self.not_fired.append(fault)
            return "" if result.returncode == 0 else f"{fault} did not fire: {result.stderr}"
        if "leaked" in log:
            return f"{fault}: {log}"
        if result.returncode == 0:
            # Memory was had at the second attempt, or what took it gave way, which is said.
            if picture.read_bytes() != self.expected and "warning" not in result.stderr:
                return f"{fault}: another picture, and nothing said"
            return ""
        # A slow machine tells of progress.
        lines = [line for line in result.stderr.splitlines()
                 if not line.startswith(("warning: ", f"drawing {picture}: "))]
        if result.returncode != 1 or len(lines) != 1 or not lines[0].startswith("shvr: "):
            return f"{fault}: status {result.returncode}, {result.stderr}"
        if "device_lost" in fault and "stopped answering" not in lines[0]:
            return f"{fault}: {lines[0]}"
        return f"{fault}: half a picture" if picture.exists() else ""

    def check_all(self, paging, side):
        self.session = self.write_session(volume={"procedural": "sphere", "size": [side] * 3}, light={"shaded": True, "occlusion": {"strength": 0.8}},
                                          render={"size": [24, 16], "paging": paging})
        result, log, picture = self.render("whole", "")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.expected = picture.read_bytes()
        counts = {line.split()[0]: int(line.split()[1]) for line in log.splitlines()}
        self.assertNotIn("leaked", log)
        self.assertIn("vkQueueSubmit2", counts)
        faults = [f"{call}:{number}:{SHORTAGE.get(call, 'out_of_host_memory')}" for call in counts
                  if call not in HEEDLESS for number in numbers(counts[call])]
        faults += [f"{call}:{number}:device_lost" for call in LOSSES if call in counts
                   for number in numbers(counts[call])]
        self.not_fired = []
        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            wrong = list(pool.map(lambda at: self.check_fault(f"fault-{at[0]}", at[1]), enumerate(faults)))
        self.assertEqual([one for one in wrong if one], [])
        # A frame that would take long is cut, by what its passes took: a run may make a few calls less than the first.
        self.assertLess(len(self.not_fired), 0.2 * len(faults), self.not_fired)

    def test_every_call_of_a_picture_may_fail(self):
        self.check_all("automatic", 24)

    def test_every_call_of_a_picture_of_paged_bricks_may_fail(self):
        self.check_all("always", 72)


if __name__ == "__main__":
    unittest.main()
