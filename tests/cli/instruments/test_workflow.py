"""tools/golden/workflow.yml, which people copy into their own repository: its steps, run in a fresh folder."""
import os
import re
import subprocess
import textwrap
import unittest
from pathlib import Path

from harness import ENVIRONMENT, SHVR, CliTest

ROOT = Path(__file__).resolve().parents[3]
WORKFLOW = (ROOT / "tools/golden/workflow.yml").read_text()
PAGE = (ROOT / "tools/golden/USING.md").read_text()
SPHERE = re.search(r"^```json golden/spheres.json\n(.*?)^```", PAGE, re.M | re.S)[1]


def steps():
    """What each step with a name runs, in order."""
    found = {}
    for name, block, line in re.findall(r"^      - name: (.+)\n(?:        \w.*\n)*?        run: (?:\|\n((?:          .*\n)+)|(.+)\n)",
                                        WORKFLOW, re.M):
        found[name] = textwrap.dedent(block) if block else line
    return found


class Workflow(CliTest):
    """Cloning, building and installing are stood in for; that the program builds is what all other tests show."""

    def setUp(self):
        super().setUp()
        self.kept = self.folder / "opt"
        self.project = self.folder / "project"
        (self.project / "golden").mkdir(parents=True)
        (self.project / "golden/spheres.json").write_text(SPHERE)
        self.log = self.folder / "log"
        self.tools = self.folder / "bin"
        self.script(self.tools / "apt-get", f'echo apt-get "$@" >> {self.log}')
        self.repository = self.folder / "shvr.git"
        self.script(self.repository / "tools/setup", f"echo setup >> {self.log}")
        self.script(self.repository / "tools/build", f'''echo build "$@" >> {self.log}
            mkdir -p build/"$1" && ln -sfn {Path(SHVR).resolve()} build/"$1"/shvr''')
        for command in (["init", "-q", "-b", "main"], ["add", "."],
                        ["-c", "user.name=a", "-c", "user.email=a@b", "commit", "-qm", "all"]):
            subprocess.run(["git", *command], cwd=self.repository, check=True)

    def script(self, path, text):
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("#!/bin/bash\nset -e\n" + text + "\n")
        path.chmod(0o755)

    def step(self, name, status=0):
        text = steps()[name].replace("/opt/shvr", str(self.kept))
        environment = {**ENVIRONMENT, "PATH": f"{self.tools}:{os.environ['PATH']}", "CI": "true",
                       "SHVR_REPOSITORY": str(self.repository), "SHVR_REVISION": "main"}
        # As the service runs a step: stop at the first command that fails.
        done = subprocess.run(["bash", "-e", "-c", text], cwd=self.project, env=environment, capture_output=True,
                              text=True, timeout=300, check=False)
        self.assertEqual(done.returncode, status, done.stdout + done.stderr)

    def bless(self):
        at_home = {key: value for key, value in ENVIRONMENT.items() if key != "CI"}
        subprocess.run([Path(SHVR).resolve(), "golden", "bless", "--reason", "first"], cwd=self.project, env=at_home,
                       check=True, capture_output=True)

    def test_its_steps_are_those_that_are_run_here(self):
        self.assertEqual(list(steps()), ["Build SHVR where it is not kept", "Draw and compare"])
        self.assertEqual(sorted(set(re.findall(r"\$\{?\{? ?(?:env\.)?(\w+)", WORKFLOW))),
                         ["SHVR_REPOSITORY", "SHVR_REVISION"])
        for tool in ("tools/setup", "tools/build"):
            self.assertTrue(os.access(ROOT / tool, os.X_OK))
            self.assertIn(tool, WORKFLOW)
        presets = (ROOT / "CMakePresets.json").read_text()
        for preset in re.findall(r"tools/build (\w+)", WORKFLOW):
            self.assertIn(f'"name": "{preset}"', presets)

    def test_a_new_folder_is_built_then_kept_and_its_pictures_pass(self):
        self.bless()
        for _ in range(2):
            self.step("Build SHVR where it is not kept")
            self.step("Draw and compare")
        self.assertEqual(self.log.read_text().splitlines(),
                         ["apt-get update", "apt-get install -y git", "setup", "build release"] * 2)
        self.assertTrue((self.project / "golden-results/report.html").is_file())

    def test_a_picture_that_changed_and_one_never_blessed_fail_and_leave_the_report_that_is_kept(self):
        self.step("Build SHVR where it is not kept")
        self.step("Draw and compare", status=3)
        self.bless()
        changed = self.project / "golden/spheres.json"
        changed.write_text(changed.read_text().replace("#204080", "#c04080"))
        self.step("Draw and compare", status=3)
        kept = re.search(r"path: (golden-results)$", WORKFLOW, re.M)[1]
        self.assertTrue((self.project / kept / "report.html").is_file())


if __name__ == "__main__":
    unittest.main()
