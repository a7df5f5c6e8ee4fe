"""The scripts of tools/ that a person runs: what tools/build says while it builds, and which packages tools/setup asks for."""
import errno
import os
import pty
import re
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
STEPS = 40
# Replaces cmake: configures nothing, and prints the lines that ninja prints for each step.
CMAKE = f"""#!/bin/bash
[[ $1 == --build ]] || exit 0
for i in $(seq {STEPS}); do echo "[$i/{STEPS}] Building CXX object some/folder/part_$i.o"; done
echo "part.cpp:1: error: made up" >&2
exit "${{BUILD_STATUS:-0}}"
"""
# Replaces dpkg-query, with nothing installed, and apt-get, which prints its arguments.
APT = """#!/bin/bash
[[ " $* " != *" install "* ]] || printf '%s\\n' "$@" >> "$ASKED"
"""


def read_to_end(terminal):
    """All that was written to the other end, which is closed: a terminal hands it on piece by piece."""
    said = b""
    try:
        while piece := os.read(terminal, 65536):
            said += piece
    except OSError as error:
        if error.errno != errno.EIO:
            raise
    return said.decode()


class Tools(unittest.TestCase):
    def setUp(self):
        self.folder = Path(tempfile.mkdtemp(prefix="shvr-tools-"))
        self.addCleanup(shutil.rmtree, self.folder)
        (self.folder / "tools").mkdir()
        (self.folder / "bin").mkdir()
        for name in ("build", "setup", "packages.txt"):
            shutil.copy(ROOT / "tools" / name, self.folder / "tools" / name)
        self.environment = os.environ | {"PATH": f"{self.folder / 'bin'}:{os.environ['PATH']}",
                                         "ASKED": str(self.folder / "asked")}

    def replace(self, program, text):
        path = self.folder / "bin" / program
        path.write_text(text, encoding="utf-8")
        path.chmod(0o755)

    def build(self, **options):
        self.replace("cmake", CMAKE)
        return subprocess.run([self.folder / "tools/build", "dev", "all"], check=False, text=True, **options)

    def test_a_build_says_sparsely_how_far_it_is(self):
        result = self.build(env=self.environment, capture_output=True)
        self.assertEqual((result.returncode, result.stdout), (0, ""))
        said = re.findall(rf"step (\d+) of {STEPS}$", result.stderr, re.MULTILINE)
        self.assertEqual([int(step) for step in said], [STEPS * tenth // 10 for tenth in range(1, 11)])
        log = (self.folder / "build/dev/log.txt").read_text(encoding="utf-8")
        self.assertEqual(log.count("Building CXX object"), STEPS)
        self.assertIn("made up", log)

    def test_on_a_terminal_one_line_is_written_over(self):
        ours, theirs = pty.openpty()
        result = self.build(env=self.environment, stderr=theirs, stdout=subprocess.PIPE)
        os.close(theirs)
        said = read_to_end(ours)
        os.close(ours)
        self.assertEqual(result.returncode, 0)
        self.assertIn(f"\rbuilding dev: step {STEPS} of {STEPS}, part_{STEPS}.o\x1b[K", said)
        self.assertTrue(said.endswith("\r\x1b[K"), said[-40:])  # the line is gone in the end
        self.assertEqual(said.count("\n"), 1)  # that of the announcement

    def test_a_build_that_fails_says_why(self):
        result = self.build(env=self.environment | {"BUILD_STATUS": "1"}, capture_output=True)
        self.assertEqual(result.returncode, 1)
        self.assertIn("part.cpp:1: error: made up", result.stderr)
        self.assertIn("the build of preset dev failed", result.stderr.splitlines()[-1])

    def asked_packages(self, *options):
        self.replace("dpkg-query", "#!/bin/bash\n")
        self.replace("apt-get", APT)
        self.replace("df", "#!/bin/bash\necho Avail\necho 99999999\n")
        self.replace("sudo", '#!/bin/bash\nexec "$@"\n')
        result = subprocess.run([self.folder / "tools/setup", *options], env=self.environment, check=False, text=True,
                                capture_output=True)
        self.assertEqual(result.returncode, 0, result.stderr)
        asked = (self.folder / "asked").read_text(encoding="utf-8").split()
        (self.folder / "asked").unlink()
        return set(asked[asked.index("--no-install-recommends") + 1:])

    def test_what_only_tests_need_is_asked_for_by_them_alone(self):
        to_run, to_test = self.asked_packages(), self.asked_packages("--checks")
        self.assertLess(to_run, to_test)
        self.assertLessEqual({"cmake", "g++", "libimgui-dev", "mesa-vulkan-drivers"}, to_run)
        self.assertLessEqual({"shellcheck", "xvfb", "python3-zarr"}, to_test - to_run)

    def test_each_package_has_a_name_for_each_release(self):
        table = (ROOT / "tools/packages.txt").read_text(encoding="utf-8")
        rows = [line.split(maxsplit=3) for line in table.splitlines() if line and line[0] not in "#["]
        self.assertGreater(len(rows), 30)
        for row in rows:
            self.assertEqual(len(row), 4, row)
            for name in row[:3]:
                self.assertRegex(name, r"^([a-z0-9][a-z0-9+.-]+|=|-)$", row)


class Loops(unittest.TestCase):
    """tools/check_loops.py: loops whose results a driver may lose."""
    LOOP = """
bool first_hit(const Line line)
{
    bool is_hit = false, goes_on = line.begin < line.end;
    uint slot = 0u;
    vec3 place = line.near;
    if (goes_on) do {
        const float to = place.x;
        LINE
        place += line.step;
        goes_on = goes_on && !is_hit && to < line.end;
    } while (goes_on);
    return is_hit && slot > 0u;
}
"""

    def refused(self, line, loop=LOOP):
        with tempfile.NamedTemporaryFile("w", suffix=".comp") as kernel:
            kernel.write(loop.replace("LINE", line))
            kernel.flush()
            done = subprocess.run([ROOT / "tools/check_loops.py", kernel.name], check=False, text=True, capture_output=True)
        self.assertEqual(done.returncode, 1 if done.stderr else 0)
        return done.stderr

    # Kind (Drivers): a value that a loop assigns without carrying it
    def test_a_value_that_a_loop_does_not_carry_is_refused(self):
        for line in ("is_hit = is_set(place);", "if (is_set(place)) is_hit = true;",
                     "if (is_set(place)) { is_hit = true; }", "const bool is_new = true;\nis_hit = is_new;",
                     "for (uint i = 0u; i < 4u; ++i) is_hit = is_set(place + i);"):
            with self.subTest(line=line):
                self.assertIn("is_hit is assigned in a loop without its former value", self.refused(line))
        self.assertIn(".comp:10: slot", self.refused("\nslot = slot_of(place);"))

    def test_a_value_that_is_carried_or_not_read_is_accepted(self):
        for line in ("is_hit = is_hit || (goes_on && is_set(place));", "slot = is_set(place) ? 1u : slot;", "slot += 1u;",
                     "// is_hit = is_set(place);", "bool is_hit = is_set(place); slot |= uint(is_hit);",
                     "is_hit = true;   // same again: it is never false", "place = line.near;"):
            with self.subTest(line=line):
                self.assertEqual(self.refused(line), "")

    def test_a_loop_that_all_lanes_leave_together_is_accepted(self):
        together = "float f()\n{\n    float v = 0.0;\n    for (uint i = 0u; i < COUNT; ++i) {\n        LINE\n    }\n    return v;\n}\n"
        self.assertEqual(self.refused("v = at(i);", together), "")
        self.assertEqual(self.refused("v = at(i);", together.replace("COUNT", "params.levels - 1u")), "")
        self.assertIn("v is assigned", self.refused("v = at(i); if (v > 1.0) break;", together))
        self.assertIn("v is assigned", self.refused("v = at(i);", together.replace("COUNT", "lane_count")))

    CALLING = """
struct March { bool waits; float sum; };
FUNCTIONS
bool march_on(float end, inout March march)
{
    float x = 0.0;
    bool goes_on = x < end;
    if (goes_on) do {
        x += 1.0;
        CALL
        goes_on = x < end && !march.waits;
    } while (goes_on);
    return march.waits;
}
"""

    def refused_call(self, functions, call="step_on(x, march);"):
        return self.refused("", self.CALLING.replace("FUNCTIONS", functions).replace("CALL", call))

    # Kind (Drivers): a value that a function in a loop assigns without carrying it
    def test_what_a_function_assigns_in_a_loop_that_calls_it_is_refused(self):
        step = "void step_on(float x, inout March march)\n{\n    BODY\n}\n"
        for body in ("march.waits = is_set(x);", "if (is_set(x)) march.waits = true;",
                     "const bool is_new = is_set(x); march.waits = is_new;",
                     "for (uint i = 0u; i < 4u; ++i) march.waits = is_set(x + i);"):
            with self.subTest(body=body):
                self.assertIn(".comp:5: march is assigned in a loop", self.refused_call(step.replace("BODY", body)))
        self.assertIn("march is assigned", self.refused_call("", "march.waits = is_set(x);"))
        wait = "void wait(inout bool waits)\n{\n    waits = BODY;\n}\n"
        through = wait + step.replace("BODY", "wait(march.waits);")
        self.assertIn(".comp:5: waits is assigned", self.refused_call(through.replace("BODY", "is_set(1.0)", 1)))
        self.assertEqual(self.refused_call(through.replace("BODY", "waits || is_set(1.0)", 1)), "")
        self.assertIn("waits is assigned", self.refused_call("void is_there(out bool waits)\n{\n    waits = true;\n}\n",
                                                             "is_there(march.waits);"))

    def test_what_a_function_carries_or_the_loop_does_not_keep_is_accepted(self):
        step = "void step_on(float x, inout March march)\n{\n    BODY\n}\n"
        for body in ("march.waits = march.waits || is_set(x);", "march.sum += x;", "const bool w = is_set(x);",
                     "march.waits = true;   // same again: it is never false", "x = 1.0;"):
            with self.subTest(body=body):
                self.assertEqual(self.refused_call(step.replace("BODY", body)), "")
        compensated = "void step_on(float x, inout float sum)\n{\n    const float next = sum + x;\n    sum = next;\n}\n"
        self.assertEqual(self.refused_call(compensated, "step_on(x, march.sum);"), "")
        lost = step.replace("BODY", "march.waits = is_set(x);")
        self.assertEqual(self.refused_call(lost, "March other = march; step_on(x, other);"), "")
        self.assertEqual(self.refused_call(lost, "step_on(x, march);   // same again: all lanes wait"), "")
        self.assertEqual(self.refused_call(lost, "step_on(march);"), "", "another number of parameters")
        itself = step.replace("BODY", "if (x > 1.0) step_on(x - 1.0, march);")
        self.assertEqual(self.refused_call(itself), "")

    def test_functions_of_included_files_are_followed(self):
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "library").mkdir()
            library = Path(folder) / "library/step.glsl"
            library.write_text("void step_on(float x, inout March march)\n{\n    march.waits = is_set(x);\n}\n",
                               encoding="utf-8")
            (Path(folder) / "middle.glsl").write_text('#include "library/step.glsl"\n', encoding="utf-8")
            kernel = Path(folder) / "kernel.comp"
            kernel.write_text(self.CALLING.replace("FUNCTIONS", '#include "middle.glsl"')
                              .replace("CALL", "step_on(x, march);"), encoding="utf-8")
            done = subprocess.run([ROOT / "tools/check_loops.py", kernel], check=False, text=True, capture_output=True)
            self.assertEqual(done.returncode, 1)
            self.assertIn("library/step.glsl:3: march is assigned in a loop", done.stderr)


class Kernels(unittest.TestCase):
    """What shaders/compile_kernel keeps for other clones."""

    def test_a_kernel_is_compiled_once_for_all_clones_and_again_for_other_sources(self):
        folder = Path(tempfile.mkdtemp(prefix="shvr-kernels-"))
        self.addCleanup(shutil.rmtree, folder)
        tried = {}
        for clone in ("one", "two", "changed"):
            shaders = folder / clone / "shaders"
            (shaders / "small").mkdir(parents=True)
            shutil.copy2(ROOT / "shaders/compile_kernel", shaders)
            (shaders / "value.h").write_text(f"const float VALUE = {3 if clone == 'changed' else 2}.0;\n")
            kernel, made = shaders / "small/small.comp", folder / clone / "small.spv"
            kernel.write_text("#version 460\n#extension GL_GOOGLE_include_directive : require\n#include \"../value.h\"\n"
                              "layout(binding = 0) buffer B { float b; };\nvoid main() { b = VALUE; }\n")
            subprocess.run([shaders / "compile_kernel", kernel, made, f"-I{shaders}", "--depfile", f"{made}.d"],
                           check=True, env={**os.environ, "XDG_CACHE_HOME": str(folder / "cache")})
            tried[clone] = made.read_bytes(), Path(f"{made}.d").read_text().replace(str(folder / clone), "CLONE")
            self.assertIn("CLONE/shaders/small/small.comp", tried[clone][1])
            self.assertIn("value.h", tried[clone][1])
            if clone == "one":   # what the second one gets is what is kept
                kept, = (folder / "cache/shvr-kernels").glob("*/*.spv")
                self.assertEqual(kept.read_bytes(), tried["one"][0])
                kept.write_bytes(b"kept")
        self.assertEqual(tried["two"], (b"kept", tried["one"][1]))
        self.assertNotEqual(tried["changed"][0], tried["one"][0])
        self.assertEqual(len(list((folder / "cache/shvr-kernels").iterdir())), 2)


if __name__ == "__main__":
    unittest.main()
