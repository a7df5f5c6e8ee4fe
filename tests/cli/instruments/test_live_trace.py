"""engine/gpu/live_trace.h: what Tracy is told, by a stand-in for its library; and that it costs nothing without it."""
import json
import os
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

from harness import SHVR

ROOT = Path(__file__).resolve().parents[3]
STUB = ROOT / "tests/stubs/tracy"
OPTIONS = ["g++", "-std=c++20", "-O2", "-ffp-contract=off", f"-I{ROOT}"]
TRACED = ["-DSHVR_TRACY", "-DTRACY_ENABLE", "-isystem", STUB]

# A frame of three passes of a clock with 32 bits, ticks of 10 ns; the second overlaps the first, and the clock turns
# over in the third. Then a frame that was measured after it but began before its end, and another device.
PROGRAM = """
#include "engine/gpu/live_trace.h"
using namespace shvr::gpu;
int main()
{
    const TraceSpan whole("a frame");
    {
        const TraceSpan inner("submit");
    }
    const DeviceClock clock{7, 10.0, 0xffffffffu};
    const TracedPass first[] = {{"raycast", 0xffffff00u, 0xffffffc0u}, {"encode", 0xffffffa0u, 0xfffffff0u},
                                {"read back", 0xfffffff0u, 0x10u}};
    trace_passes(clock, first);
    const TracedPass second[] = {{"raycast", 0x8u, 0x110u}};
    trace_passes(clock, second);
    const TracedPass other[] = {{"raycast", 5u, 25u}};
    trace_passes({8, 10.0, 0xffffffffu}, other);
    trace_frame();
}
"""
# Twice the same function, once with all that the executor and the window say.
PLAIN = """
#include "engine/gpu/live_trace.h"
int used(int value);
int work(const char* name, int value)
{
%s
    return used(value) + 1;
}
"""
CALLS = """    const shvr::gpu::TraceSpan span(name);
    if constexpr (shvr::gpu::IS_TRACED) shvr::gpu::trace_passes({}, {});
    shvr::gpu::trace_frame();
"""


class LiveTrace(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="shvr-trace-")
        cls.addClassCleanup(folder.cleanup)
        cls.folder = Path(folder.name)

    def compiled(self, text, *options, output="program"):
        source = self.folder / "source.cpp"
        source.write_text(text)
        done = subprocess.run([*OPTIONS, *options, source, "-o", self.folder / output], capture_output=True, text=True,
                              timeout=120, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        return self.folder / output

    def told(self, **environment):
        program = self.folder / "traced"
        if not program.exists():
            self.compiled(PROGRAM, *TRACED, ROOT / "engine/gpu/live_trace.cpp", STUB / "TracyClient.cpp",
                          output="traced")
        done = subprocess.run([program], capture_output=True, text=True, timeout=20, check=True,
                              env={**os.environ, **environment})
        return [json.loads(line) for line in done.stdout.splitlines()]

    def test_spans_passes_and_frames_are_told(self):
        told = self.told()
        self.assertEqual([one["host begins"] for one in told if "host begins" in one], ["a frame", "submit"])
        self.assertEqual([one["host ends"] for one in told if "host ends" in one], [2, 1])
        self.assertEqual([one["context"] for one in told if "context" in one], [0])
        self.assertEqual([one["pass"] for one in told if "pass" in one],
                         ["raycast", "encode", "read back", "raycast", "raycast"])
        self.assertEqual(sum("frame" in one for one in told), 1)
        at = {one["query"]: one["ns"] for one in told if "query" in one}
        begins = [at[one["begin"]] for one in told if "pass" in one]
        ends = [at[one["end"]] for one in told if "end" in one]
        self.assertEqual(len(at), 10)
        begin = begins[0]
        # 0xc0 ticks; then from the end of the first to 0xf0; then 0x20 across the turn.
        self.assertEqual([(a - begin, b - begin) for a, b in zip(begins[:3], ends[:3])],
                         [(0, 1920), (1920, 2400), (2400, 2720)])
        # 8 ticks before the end of the frame before, as far as Tracy may know.
        self.assertEqual((begins[3] - ends[2], ends[3] - ends[2]), (-80, 2560))
        self.assertEqual(ends[4] - begins[4], 200)
        self.assertGreaterEqual(ends[4], ends[3])

    def test_no_pass_is_told_while_nobody_watches(self):
        self.assertEqual([one for one in self.told(NOBODY_WATCHES="1") if "pass" in one or "query" in one], [])

    def test_without_tracy_not_an_instruction_is_added(self):
        def code(calls, *options):
            text = self.compiled(PLAIN % calls, "-S", *options, output="source.s").read_text()
            return [line for line in text.splitlines() if not re.match(r"\s*\.(file|ident|loc)", line)]
        self.assertEqual(code(CALLS), code(""))
        self.assertNotEqual(code(CALLS, *TRACED), code("", *TRACED))
        symbols = subprocess.run(["nm", "-C", SHVR], capture_output=True, text=True, timeout=120, check=True).stdout
        self.assertEqual([line for line in symbols.splitlines() if "tracy" in line.lower() or "trace_passes" in line], [])

    def test_the_executor_and_the_window_are_told_about(self):
        for file in ("frame_prepare", "frame_record", "frame_collect", "live_trace"):
            done = subprocess.run([*OPTIONS, *TRACED, "-fsyntax-only", "-Wall", "-Wextra", "-Wshadow", "-Wconversion",
                                   "-Werror", "-Wno-missing-field-initializers", ROOT / f"engine/gpu/{file}.cpp"],
                                  capture_output=True, text=True, timeout=120, check=False)
            self.assertEqual(done.returncode, 0, done.stderr)


if __name__ == "__main__":
    unittest.main()
