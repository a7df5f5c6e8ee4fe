"""Journal, mask, trace, offsets, session and their side files: missing, older, newer, cut, or of another project.

Each file is tried in every state beside each journal, and all files together in states such that every pair occurs,
through the program. What is found is compared with the table in engine/annotation/work/README.md, which `believed`
below states once more. SHVR_SLOW=1 answers questions that are not asked, too, and tries more states together.
"""
import itertools
import json
import shutil
import struct
import tempfile
import unittest
from pathlib import Path

from harness import IS_SLOW, CliTest, Volume, covering, run

SIZE = (6, 5, 4)
VOXELS = SIZE[0] * SIZE[1] * SIZE[2]
PARTS = {"mask": "paint.mask", "trace": "paint.graphml", "offsets": "paint.offset"}
STATES = ["as saved", "missing", "older", "newer", "cut", "another's"]


def paint(number):
    """One voxel of each kind of annotation, at a place and with a value of its own."""
    at = [number + 0.5, 0.5, 0.5]
    return [{"op": "paint", "brush": "fill", "region": "box", "group": number, "threshold": 0, "radius": 0.4,
             "path": [at]},
            {"op": "node", "at": at, "radius": 1, "group": number},
            {"op": "density", "brush": "fill", "region": "box", "threshold": 0, "radius": 0.4, "path": [at],
             "offset": number}]


class Project:
    """States of one project: 1 is the first save, 2 the last, 3 has steps beyond it, 4 was saved later elsewhere."""

    def __init__(self, folder, seed):
        self.path = folder / f"project{seed}"
        volume = Volume.noise(SIZE, seed).write(folder, f"volume{seed}")
        assert run("import", volume, self.path, "--quiet").returncode == 0
        self.states = {}

    def go_on(self, name, operations):
        script = self.path.parent / "script.jsonl"
        script.write_text("".join(json.dumps(operation) + "\n" for operation in operations))
        result = run("annotate", self.path, "--script", script, "--quiet")
        assert result.returncode == 0 and result.stderr == "", result.stderr
        self.states[name] = {file.name: file.read_bytes() for file in (self.path / "shvr").iterdir()}


class Files(CliTest):
    @classmethod
    def setUpClass(cls):
        temporary = tempfile.TemporaryDirectory(prefix="shvr-cli-")
        cls.addClassCleanup(temporary.cleanup)
        cls.root = Path(temporary.name)
        project, other = Project(cls.root, 1), Project(cls.root, 2)
        save = [{"op": "save"}]
        project.go_on(1, paint(1) + save)
        project.go_on(2, paint(2) + save)
        project.go_on(3, paint(3))
        project.go_on(4, paint(4) + save)
        other.go_on(5, paint(5) + save)
        cls.states = {**project.states, **other.states}
        cls.pristine = project.path
        journal, saved = (cls.states[number]["session.journal"] for number in (3, 2))
        assert journal.startswith(saved)
        cls.cut_journal = journal[:len(saved) + 30]  # in the midst of the first record after the save

    # ---- The table ----

    # The journal: the state it holds, and that of its last save.
    JOURNAL = {"as saved": (3, 2), "older": (1, 1), "newer": (4, 4), "cut": (2, 2)}
    FILE = {"as saved": 2, "older": 1, "newer": 4, "another's": 5}

    def believed(self, journal, part, state, image, belief):
        """(the state of this part that is taken, how many losses are told); or "asked", or "refused"."""
        file = self.FILE.get(state)  # none: missing or cut
        wrong_image = part == "mask" and image in ("cut", "another's")
        if journal not in self.JOURNAL:  # missing, or without a whole state
            if state == "missing":
                return 0, 0
            return "refused" if file is None or wrong_image else (file, 0)
        holds, saved = self.JOURNAL[journal]
        if file == saved:
            return holds, int(wrong_image)
        if file is None or wrong_image:
            return holds, 1
        if belief is None:
            return "asked"
        return (file if belief == "files" else holds), 0

    def expected(self, states, belief):
        if states["journal"] == "another's":
            return "refused"
        parts = {part: self.believed(states["journal"], part, states[part], states["image"], belief) for part in PARTS}
        for word in ("refused", "asked"):
            if word in parts.values():
                return word
        losses = sum(told for _, told in parts.values())
        losses += states["journal"] in ("cut", "stub")
        # MASK.json names the journal that is missing, unless it says nothing.
        losses += states["journal"] == "missing" and states["image"] not in ("missing", "cut")
        return {part: taken for part, (taken, _) in parts.items()}, losses

    # ---- The project in that state ----

    def content(self, name, state):
        if state == "missing":
            return None
        if state == "cut":
            return self.states[2][name][:-7]
        return self.states[{"as saved": 2, "older": 1, "newer": 4, "another's": 5}[state]][name]

    def prepare(self, states):
        project = self.folder / "project"
        if not project.exists():
            shutil.copytree(self.pristine, project)
        folder = project / "shvr"
        for file in folder.iterdir():
            if file.name.startswith(("paint", "session.journal")):
                file.unlink()
        contents = {PARTS[part]: self.content(PARTS[part], states[part]) for part in PARTS}
        contents["paint.mask.json"] = self.content("paint.mask.json", states["image"])
        contents["session.journal"] = {"as saved": self.states[3]["session.journal"], "cut": self.cut_journal,
                                       "stub": b"SHVRJRNL\1"}.get(states["journal"]) or \
            self.content("session.journal", states["journal"])
        for name, content in contents.items():
            if content is not None:
                (folder / name).write_bytes(content)
        return project

    def annotation_of(self, project, arguments):
        """What `shvr export` takes; refusals and questions as words."""
        offsets = self.folder / "out.offset"
        result = run("export", project, "--offset", offsets, "--json", "--quiet", *arguments)
        lines = result.stderr.splitlines()
        losses = [line for line in lines if line.startswith("warning: ")]
        if result.returncode != 0:
            self.assertEqual(result.returncode, 1, result.stderr)
            self.assertEqual(len(lines) - len(losses), 1, result.stderr)
            return "asked" if "--believe" in lines[-1] else "refused", lines
        self.assertEqual(len(lines), len(losses), result.stderr)
        report = json.loads(result.stdout)
        raised = struct.unpack(f"<{VOXELS}h", offsets.read_bytes())
        return {"mask": sorted(map(int, report["voxels_by_group"])), "trace": report["nodes"],
                "offsets": [value for value in raised if value]}, lines

    @staticmethod
    def looks(part, state):
        """As `annotation_of` shows a state of the project."""
        numbers = [5] if state == 5 else list(range(1, state + 1))
        return len(numbers) if part == "trace" else numbers

    def check_belief(self, states, belief=None):
        project = self.prepare(states)
        before = {file.name: file.read_bytes() for file in (project / "shvr").iterdir()}
        found, lines = self.annotation_of(project, ["--believe", belief] if belief else [])
        expected = self.expected(states, belief)
        if isinstance(expected, str):
            self.assertEqual(found, expected, lines)
        else:
            parts, losses = expected
            self.assertEqual(found, {part: self.looks(part, state) for part, state in parts.items()}, lines)
            self.assertEqual(len(lines), losses, lines)
        for line in lines:  # what was found, what was expected and what was done
            self.assertIn(str(project), line)
            self.assertIn("expected", line)
        # Looking changes nothing.
        self.assertEqual({file.name: file.read_bytes() for file in (project / "shvr").iterdir()}, before)

    JOURNALS = STATES + ["stub"]

    def test_each_file_in_each_state_beside_each_journal(self):
        tried = set()
        for journal, part, state in itertools.product(self.JOURNALS, [*PARTS, "image"], STATES):
            states = {"journal": journal, "mask": "as saved", "trace": "as saved", "offsets": "as saved",
                      "image": "as saved", part: state}
            is_asked = self.expected(states, None) == "asked"
            for belief in (None, "files", "journal") if is_asked or IS_SLOW else (None,):
                case = (*states.values(), belief)
                if case not in tried:  # a part that is as saved is the same case for each part
                    tried.add(case)
                    with self.subTest(**states, belief=belief):
                        self.check_belief(states, belief)

    def test_all_files_in_all_states_at_once(self):
        keys = ["journal", "mask", "trace", "offsets", "image"]
        factors = [self.JOURNALS, STATES, STATES, STATES, STATES]
        beliefs = [None, "files", "journal"]
        rows = covering(*factors, beliefs)
        if IS_SLOW:
            combinations = list(itertools.product(*factors))[::29]  # coprime to all numbers of states
            rows += [(*combination, beliefs[number % 3]) for number, combination in enumerate(combinations)]
        for *values, belief in rows:
            states = dict(zip(keys, values))
            with self.subTest(**states, belief=belief):
                self.check_belief(states, belief)

    # ---- Working on it ----

    def work(self, project, operations, *arguments, status=0):
        script = self.write_script("script.jsonl", operations)
        return self.check("annotate", project, "--script", script, "--quiet", *arguments, status=status)

    def contents(self, project):
        return {file.name: file.read_bytes() for file in (project / "shvr").iterdir()}

    def left(self, **states):
        return self.prepare({"journal": "as saved", "mask": "as saved", "trace": "as saved", "offsets": "as saved",
                             "image": "as saved", **states})

    def test_a_missing_mask_comes_back_and_is_saved_again(self):
        project = self.left(mask="missing", trace="missing", offsets="missing", image="missing")
        said = self.work(project, [{"op": "expect", "nodes": 3, "voxels_with_offset": 3,
                                    "voxels_in_group": {"1": 1, "2": 1, "3": 1}}, {"op": "save"}]).stderr
        self.assertEqual(said.count("is missing; expected the "), 3, said)
        found, lines = self.annotation_of(project, [])
        self.assertEqual((found["mask"], lines), ([1, 2, 3], []))
        for name in PARTS.values():
            self.assertTrue((project / "shvr" / name).exists())
            self.assertFalse((project / "shvr" / (name + ".old")).exists())

    def test_a_changed_mask_is_a_question_and_nothing_is_done_before_it_is_answered(self):
        for state in ("older", "newer"):
            project = self.left(mask=state)
            before = self.contents(project)
            said = self.work(project, paint(4) + [{"op": "save"}], status=1).stderr
            self.assertIn("paint.mask: ", said)
            self.assertIn("--believe files", said)
            self.assertEqual(said.count("\n"), 1)
            self.assertEqual(self.contents(project), before)

    def test_the_file_is_taken_as_a_step_and_the_journal_keeps_its_own(self):
        project = self.left(mask="older", trace="newer")
        self.work(project, [{"op": "expect", "voxels_in_group": {"1": 1, "2": 0, "3": 0}, "nodes": 4},
                            {"op": "undo"}, {"op": "expect", "voxels_in_group": {"1": 1, "2": 1, "3": 1}, "nodes": 3},
                            {"op": "redo"}, {"op": "save"}], "--believe", "files")
        self.assertEqual([name for name in self.contents(project) if ".old" in name], [])
        found, lines = self.annotation_of(project, [])
        self.assertEqual((found["mask"], found["trace"], lines), ([1], 4, []))
        # The choice is remembered, with the history.
        self.work(project, [{"op": "undo"}, {"op": "expect", "voxels_in_group": {"3": 1}, "nodes": 3}])

    def test_the_journal_is_taken_and_the_file_is_kept(self):
        project = self.left(mask="newer", offsets="another's")
        said = self.work(project, [{"op": "expect", "voxels_in_group": {"4": 0, "3": 1}, "voxels_with_offset": 3},
                                   {"op": "save"}], "--believe", "journal").stderr
        self.assertIn("is kept as", said)  # even with --quiet
        kept = self.contents(project)
        self.assertEqual(kept["paint.mask.old"], self.states[4]["paint.mask"])
        self.assertEqual(kept["paint.offset.old"], self.states[5]["paint.offset"])
        self.work(project, [{"op": "expect", "voxels_in_group": {"3": 1}}])

    def test_a_cut_file_is_kept_and_written_anew(self):
        project = self.left(mask="cut", trace="cut", offsets="cut", image="cut")
        said = self.work(project, [{"op": "save"}]).stderr
        for name in PARTS.values():
            self.assertIn(f"{name}.old", said)
            self.assertEqual(self.contents(project)[f"{name}.old"], self.states[2][name][:-7])
        found, lines = self.annotation_of(project, [])
        self.assertEqual((found["mask"], found["trace"], lines), ([1, 2, 3], 3, []))

    def test_a_journal_that_is_put_back_brings_everything_back(self):
        """As the first trial did: the mask goes, a script saves, and the journal is put back."""
        project = self.left(journal="missing", mask="missing", trace="missing", offsets="missing", image="missing")
        self.work(project, paint(4) + [{"op": "save"}])
        (project / "shvr" / "session.journal").write_bytes(self.states[3]["session.journal"])
        self.work(project, [{"op": "save"}], status=1)
        self.work(project, [{"op": "expect", "voxels_in_group": {"1": 1, "2": 1, "3": 1, "4": 0}}, {"op": "save"}],
                  "--believe", "journal")
        self.assertIn("paint.mask.old", self.contents(project))

    def test_a_fresh_start_overwrites_nothing_that_the_journal_does_not_hold(self):
        project = self.left(mask="newer")
        for number in (1, 2):
            self.work(project, paint(5) + [{"op": "save"}], "--fresh")
        kept = self.contents(project)
        self.assertEqual(kept["session.journal.old"], self.states[3]["session.journal"])
        self.assertEqual(kept["paint.mask.old"], self.states[4]["paint.mask"])
        self.assertIn("session.journal.old2", kept)
        self.assertNotIn("paint.mask.old2", kept)

    # ---- The session ----

    def test_a_project_without_its_session_has_its_annotation(self):
        project = self.left()
        session = project / "shvr" / "session.json"
        session.unlink()
        for command in (["export", project, "--mask", self.folder / "a.mask"], ["info", project],
                        ["label", project, "--threshold", "300"],
                        ["render", project, "-o", self.folder / "a.png", "--size", "8x8"]):
            said = self.check(*command, "--quiet").stderr
            self.assertIn(f"{session}: is missing; expected", said)
        self.assertEqual(sorted(set((self.folder / "a.mask").read_bytes())), [0, 1, 2, 3])
        self.assertIn("is missing", self.work(project, [{"op": "expect", "nodes": 3}, {"op": "save"}]).stderr)

    def test_a_session_that_is_cut_is_refused_and_another_one_brings_its_looks_alone(self):
        project = self.left()
        session = project / "shvr" / "session.json"
        text = session.read_text()
        session.write_text(text[:-7])
        for command in (["export", project, "--mask", self.folder / "a.mask"], ["info", project]):
            self.check_refused(*command, says=[str(session)])
        self.assertIn(str(session), self.work(project, [], status=1).stderr)
        session.write_bytes(self.states[5]["session.json"])
        self.work(project, [{"op": "expect", "nodes": 3, "voxels_in_group": {"3": 1}}])
        # One that names other files finds the annotation in the journal.
        document = json.loads(text)
        document["annotation"] = {"mask": "other.mask"}
        session.write_text(json.dumps(document))
        said = self.work(project, [{"op": "expect", "nodes": 3, "voxels_in_group": {"3": 1}}, {"op": "save"}]).stderr
        self.assertIn("other.mask: is missing", said)
        self.assertTrue((project / "shvr" / "other.mask").exists())

    def test_without_journal_and_side_file_the_files_are_taken_in_silence(self):
        project = self.left(journal="missing", image="missing")
        found, lines = self.annotation_of(project, [])
        self.assertEqual((found["mask"], lines), ([1, 2], []))


if __name__ == "__main__":
    unittest.main()
