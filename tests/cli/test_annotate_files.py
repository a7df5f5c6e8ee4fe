"""Journal, mask, trace, offsets, session and their side files: missing, older, newer, cut, or of another project.

Each file is tried in every state beside each journal, and all files together in states such that every pair occurs,
through the program. What is found is compared with the table in engine/annotation/work/README.md, which `believed`
below states once more. Both for a project, whose mask and offsets are folders, and for a session with a `.mask`.
Every day the table is tried file by file for the session alone: of the project, every pair of a journal and a state of a
file is among those that are tried together. SHVR_SLOW=1 tries it for both, answers questions that are not asked, too,
and tries more states together.
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
STATES = ["as saved", "missing", "older", "newer", "cut", "another's"]


def paint(number):
    """One voxel of each kind of annotation, at a place and with a value of its own."""
    at = [number + 0.5, 0.5, 0.5]
    return [{"op": "paint", "brush": "fill", "region": "box", "group": number, "threshold": 0, "radius": 0.4,
             "path": [at]},
            {"op": "node", "at": at, "radius": 1, "group": number},
            {"op": "density", "brush": "fill", "region": "box", "threshold": 0, "radius": 0.4, "path": [at],
             "offset": number}]


def contents(folder):
    """All files, by their paths in it."""
    return {str(file.relative_to(folder)): file.read_bytes() for file in folder.rglob("*") if file.is_file()}


def part_of(files, name):
    """A file, or those in a folder, by their paths in it."""
    return {path[len(name):]: content for path, content in files.items() if path == name or path.startswith(name + "/")}


class Project:
    """States of one project: 1 is the first save, 2 the last, 3 has steps beyond it, 4 was saved later elsewhere."""

    def __init__(self, path, opened):
        self.path, self.opened, self.states = path, opened, {}

    def go_on(self, name, operations):
        script = self.path.parent / "script.jsonl"
        script.write_text("".join(json.dumps(operation) + "\n" for operation in operations))
        result = run("annotate", self.opened, "--script", script, "--quiet")
        assert result.returncode == 0 and result.stderr == "", result.stderr
        self.states[name] = contents(self.path)


class Files:
    """Tests of one layout: the names in PARTS, JOURNAL_FILE and SESSION, within a folder."""

    @classmethod
    def setUpClass(cls):
        temporary = tempfile.TemporaryDirectory(prefix="shvr-cli-")
        cls.addClassCleanup(temporary.cleanup)
        root = Path(temporary.name)
        project, other = cls.begin(root, 1), cls.begin(root, 2)
        save = [{"op": "save"}]
        project.go_on(1, paint(1) + save)
        project.go_on(2, paint(2) + save)
        project.go_on(3, paint(3))
        project.go_on(4, paint(4) + save)
        other.go_on(5, paint(5) + save)
        cls.states = {**project.states, **other.states}
        cls.pristine = project.path
        journal, saved = (cls.states[number][cls.JOURNAL_FILE] for number in (3, 2))
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
        image = self.image_in(states)
        parts = {part: self.believed(states["journal"], part, states[part], image, belief) for part in self.PARTS}
        for word in ("refused", "asked"):
            if word in parts.values():
                return word
        losses = sum(told for _, told in parts.values())
        losses += states["journal"] in ("cut", "stub")
        # The mask names the journal that is missing, unless it says nothing.
        losses += states["journal"] == "missing" and image not in ("missing", "cut")
        return {part: taken for part, (taken, _) in parts.items()}, losses

    # ---- The project in that state ----

    def files_of(self, name, state):
        """Those of a part in that state, by their paths in the project."""
        if state == "missing":
            return {}
        number = {"older": 1, "newer": 4, "another's": 5}.get(state, 2)
        files = {name + path: content for path, content in part_of(self.states[number], name).items()}
        if state == "cut":
            longest = self.cut_in(name)
            files[longest] = files[longest][:-7]
        return files

    @staticmethod
    def cut_in(name):
        """The file of a part that is cut."""
        return name

    def prepare(self, states):
        project = self.folder / "project"
        if not project.exists():
            shutil.copytree(self.pristine, project)
        for path in [path for path in project.rglob("*") if path.name.startswith(("paint", "session.journal"))]:
            if path.is_dir():
                shutil.rmtree(path)
            else:
                path.unlink(missing_ok=True)  # in a folder that is removed
        files = {}
        for part, name in self.PARTS.items():
            files.update(self.files_of(name, states[part]))
        files.update(self.files_of(self.IMAGE, states["image"]) if self.IMAGE else {})
        journal = {"cut": self.cut_journal, "stub": b"SHVRJRNL\1",
                   "as saved": self.states[3][self.JOURNAL_FILE]}.get(states["journal"])
        files.update({self.JOURNAL_FILE: journal} if journal else self.files_of(self.JOURNAL_FILE, states["journal"]))
        for name, content in files.items():
            (project / name).parent.mkdir(parents=True, exist_ok=True)
            (project / name).write_bytes(content)
        return project

    def annotation_of(self, project, arguments):
        """What `shvr export` takes; refusals and questions as words."""
        offsets = self.folder / "out.offset"
        result = run("export", self.opened(project), "--offset", offsets, "--json", "--quiet", *arguments)
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
        before = contents(project)
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
        self.assertEqual(contents(project), before)

    JOURNALS = STATES + ["stub"]

    def check_each_file_in_each_state_beside_each_journal(self):
        tried = set()
        for journal, part, state in itertools.product(self.JOURNALS, self.KINDS, STATES):
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
        keys = ["journal", *self.KINDS]
        factors = [self.JOURNALS] + [STATES] * len(self.KINDS)
        beliefs = [None, "files", "journal"]
        rows = covering(*factors, beliefs)
        if IS_SLOW:
            combinations = list(itertools.product(*factors))[::29]  # coprime to all numbers of states
            rows += [(*combination, beliefs[number % 3]) for number, combination in enumerate(combinations)]
        for *values, belief in rows:
            states = {"image": "as saved", **dict(zip(keys, values))}
            with self.subTest(**states, belief=belief):
                self.check_belief(states, belief)

    # ---- Working on it ----

    def work(self, project, operations, *arguments, status=0):
        script = self.write_script("script.jsonl", operations)
        return self.check("annotate", self.opened(project), "--script", script, "--quiet", *arguments, status=status)

    def assert_kept(self, project, name, number):
        """The part is kept as NAME.old, as it was in that state."""
        self.assertEqual(part_of(contents(project), f"{name}.old"), part_of(self.states[number], name))

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
        for name in self.PARTS.values():
            self.assertTrue((project / name).exists())
            self.assertFalse((project / (name + ".old")).exists())

    def test_a_changed_mask_is_a_question_and_nothing_is_done_before_it_is_answered(self):
        for state in ("older", "newer"):
            project = self.left(mask=state)
            before = contents(project)
            said = self.work(project, paint(4) + [{"op": "save"}], status=1).stderr
            self.assertIn(f"{self.PARTS['mask']}: ", said)
            self.assertIn("--believe files", said)
            self.assertEqual(said.count("\n"), 1)
            self.assertEqual(contents(project), before)

    def test_the_file_is_taken_as_a_step_and_the_journal_keeps_its_own(self):
        project = self.left(mask="older", trace="newer")
        self.work(project, [{"op": "expect", "voxels_in_group": {"1": 1, "2": 0, "3": 0}, "nodes": 4},
                            {"op": "undo"}, {"op": "expect", "voxels_in_group": {"1": 1, "2": 1, "3": 1}, "nodes": 3},
                            {"op": "redo"}, {"op": "save"}], "--believe", "files")
        self.assertEqual([name for name in contents(project) if ".old" in name], [])
        found, lines = self.annotation_of(project, [])
        self.assertEqual((found["mask"], found["trace"], lines), ([1], 4, []))
        # The choice is remembered, with the history.
        self.work(project, [{"op": "undo"}, {"op": "expect", "voxels_in_group": {"3": 1}, "nodes": 3}])

    def test_the_journal_is_taken_and_the_file_is_kept(self):
        project = self.left(mask="newer", offsets="another's")
        said = self.work(project, [{"op": "expect", "voxels_in_group": {"4": 0, "3": 1}, "voxels_with_offset": 3},
                                   {"op": "save"}], "--believe", "journal").stderr
        self.assertIn("is kept as", said)  # even with --quiet
        self.assert_kept(project, self.PARTS["mask"], 4)
        self.assert_kept(project, self.PARTS["offsets"], 5)
        self.work(project, [{"op": "expect", "voxels_in_group": {"3": 1}}])

    def test_a_cut_file_is_kept_and_written_anew(self):
        project = self.left(mask="cut", trace="cut", offsets="cut", image="cut")
        said = self.work(project, [{"op": "save"}]).stderr
        for name in self.PARTS.values():
            self.assertIn(f"{name}.old", said)
            kept = part_of(contents(project), f"{name}.old")
            self.assertEqual({name + path: content for path, content in kept.items()}, self.files_of(name, "cut"))
        found, lines = self.annotation_of(project, [])
        self.assertEqual((found["mask"], found["trace"], lines), ([1, 2, 3], 3, []))

    def test_a_journal_that_is_put_back_brings_everything_back(self):
        """As the first trial did: the mask goes, a script saves, and the journal is put back."""
        project = self.left(journal="missing", mask="missing", trace="missing", offsets="missing", image="missing")
        self.work(project, paint(4) + [{"op": "save"}])
        (project / self.JOURNAL_FILE).write_bytes(self.states[3][self.JOURNAL_FILE])
        self.work(project, [{"op": "save"}], status=1)
        self.work(project, [{"op": "expect", "voxels_in_group": {"1": 1, "2": 1, "3": 1, "4": 0}}, {"op": "save"}],
                  "--believe", "journal")
        self.assertTrue((project / f"{self.PARTS['mask']}.old").exists())

    def test_a_fresh_start_overwrites_nothing_that_the_journal_does_not_hold(self):
        project = self.left(mask="newer")
        for number in (1, 2):
            self.work(project, paint(5) + [{"op": "save"}], "--fresh")
        self.assert_kept(project, self.JOURNAL_FILE, 3)
        self.assert_kept(project, self.PARTS["mask"], 4)
        self.assertTrue((project / f"{self.JOURNAL_FILE}.old2").exists())
        self.assertFalse((project / f"{self.PARTS['mask']}.old2").exists())

    # ---- The session ----

    def test_a_session_that_is_cut_is_refused_and_another_one_brings_its_looks_alone(self):
        project = self.left()
        session = project / self.SESSION
        text = session.read_text()
        session.write_text(text[:-7])
        for arguments in (["export"], ["info"], ["label", "--threshold", "300"]):
            self.check_refused(arguments[0], self.opened(project), *arguments[1:], says=[str(session)])
        self.assertIn(str(session), self.work(project, [], status=1).stderr)
        session.write_bytes(self.states[5][self.SESSION])
        self.work(project, [{"op": "expect", "nodes": 3, "voxels_in_group": {"3": 1}}])
        # One that names other files finds the annotation in the journal.
        document = json.loads(text)
        document["annotation"] = {"mask": self.OTHER}
        session.write_text(json.dumps(document))
        said = self.work(project, [{"op": "expect", "nodes": 3, "voxels_in_group": {"3": 1}}, {"op": "save"}]).stderr
        self.assertIn(f"{self.OTHER}: is missing", said)
        self.assertTrue((session.parent / self.OTHER).exists())


class OfProject(Files, CliTest):
    """Mask and offsets are OME-Zarr; the mask states its image and its journal."""

    PARTS = {"mask": "labels/paint", "trace": "shvr/paint.graphml", "offsets": "shvr/paint.offsets.zarr"}
    KINDS, IMAGE, OTHER = [*PARTS], None, "other.zarr"
    JOURNAL_FILE, SESSION = "shvr/session.journal", "shvr/session.json"

    @staticmethod
    def begin(root, seed):
        path = root / f"project{seed}"
        assert run("import", Volume.noise(SIZE, seed).write(root, f"volume{seed}"), path, "--quiet").returncode == 0
        return Project(path, path)

    @staticmethod
    def opened(project):
        return project

    @staticmethod
    def image_in(states):
        return states["mask"]

    @staticmethod
    def cut_in(name):
        return name if name.endswith((".graphml", ".journal")) else name + "/0/0/0/0"

    if IS_SLOW:
        test_each_file_in_each_state_beside_each_journal = Files.check_each_file_in_each_state_beside_each_journal

    def test_a_project_without_its_session_has_its_annotation(self):
        project = self.left()
        session = project / self.SESSION
        session.unlink()
        for command in (["export", project, "--mask", self.folder / "a.mask"], ["info", project],
                        ["label", project, "--threshold", "300"],
                        ["render", project, "-o", self.folder / "a.png", "--size", "8x8"]):
            said = self.check(*command, "--quiet").stderr
            self.assertIn(f"{session}: is missing; expected", said)
        self.assertEqual(sorted(set((self.folder / "a.mask").read_bytes())), [0, 1, 2, 3])
        self.assertIn("is missing", self.work(project, [{"op": "expect", "nodes": 3}, {"op": "save"}]).stderr)


class OfSession(Files, CliTest):
    """Mask and offsets are files of every voxel; image and journal are stated by MASK.json."""

    PARTS = {"mask": "paint.mask", "trace": "paint.graphml", "offsets": "paint.offset"}
    IMAGE, OTHER = "paint.mask.json", "other.mask"
    KINDS = [*PARTS, "image"]
    JOURNAL_FILE, SESSION = "session.journal", "session.json"

    @staticmethod
    def begin(root, seed):
        path = root / f"work{seed}"
        path.mkdir()
        volume = Volume.noise(SIZE, seed).write(path)
        session = path / "session.json"
        session.write_text(json.dumps({"shvr_session": 1, "volume": {"path": volume.name},
                                       "annotation": {"mask": "paint.mask"}}))
        return Project(path, session)

    @staticmethod
    def opened(project):
        return project / "session.json"

    @staticmethod
    def image_in(states):
        return states["image"]

    test_each_file_in_each_state_beside_each_journal = Files.check_each_file_in_each_state_beside_each_journal

    def test_without_journal_and_side_file_the_files_are_taken_in_silence(self):
        project = self.left(journal="missing", image="missing")
        found, lines = self.annotation_of(project, [])
        self.assertEqual((found["mask"], lines), ([1, 2], []))


if __name__ == "__main__":
    unittest.main()
