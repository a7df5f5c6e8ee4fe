"""A session names the files that its annotation is saved in. A stranger's could name any file of the user's: outside
the session's own folder nothing is written without --outside. And outputs through symbolic links, and what killed
programs leave behind."""
import os
import signal
import subprocess
import time
import unittest

from harness import ENVIRONMENT, SHVR, CliTest, Volume

DAB = {"op": "paint", "brush": "fill", "region": "ball", "path": [[12, 12, 12]], "radius": 3, "threshold": 0, "group": 3}
NODE = {"op": "node", "at": [12, 12, 12], "radius": 2, "group": 2}


def content(folder):
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


class Outside(CliTest):
    def setUp(self):
        super().setUp()
        self.home, self.project = self.folder / "home", self.folder / "downloads" / "project"
        self.home.mkdir()
        self.project.mkdir(parents=True)
        self.precious = self.home / "precious.mask"
        self.precious.write_bytes(b"\1" * 24 ** 3)
        self.script = self.write_script("s.jsonl", [DAB, NODE, {"op": "save"}])

    def session(self, **annotation):
        return self.write_json("downloads/project/session.json", {
            "shvr_session": 1, "volume": {"procedural": "sphere", "size": [24, 24, 24]}, "render": {"size": [24, 16]},
            "transfer_function": {"points": [{"intensity": 60, "opacity": 0.0}, {"intensity": 200, "opacity": 0.5}]},
            "annotation": annotation})

    def test_nothing_outside_the_folder_is_written_before_the_user_agrees(self):
        (self.project / "link.mask").symlink_to(self.precious)
        (self.project / "far").symlink_to(self.home)
        before = content(self.home)
        for annotation, named in (
                ({"mask": str(self.precious)}, "annotation.mask, which is "),
                ({"mask": "../../home/precious.mask"}, "annotation.mask, which is "),
                ({"mask": "link.mask"}, f", since {self.project / 'link.mask'} is a link"),
                ({"mask": "far/new.mask"}, f", since {self.project / 'far'} is a link"),
                ({"mask": "a.mask", "trace": str(self.home / "t.swc")}, "annotation.trace, which is "),
                ({"mask": "a.mask", "density": "../../home/d.offset"}, "annotation.density, which is ")):
            with self.subTest(annotation=annotation):
                session = self.session(**annotation)
                self.check_refused("annotate", session, "--script", self.script,
                                   says=["session.json: names files outside its folder: ", named, str(self.home),
                                         "--outside writes there"])
                self.assertEqual(content(self.home), before)
                self.assertEqual(sorted(path.name for path in self.project.iterdir()),
                                 ["far", "link.mask", "session.json"])

    def test_with_the_option_it_is_written_there(self):
        session = self.session(mask=str(self.home / "mine.mask"))
        self.check("annotate", session, "--script", self.script, "--outside")
        self.assertEqual((self.home / "mine.mask").stat().st_size, 24 ** 3)

    def test_what_the_command_line_names_is_the_user_s_choice(self):
        session = self.session(mask="a.mask")
        self.check("annotate", session, "--script", self.script, "--set",
                   f"annotation.mask={self.home / 'mine.mask'}")
        self.assertTrue((self.home / "mine.mask").exists())
        self.assertFalse((self.project / "a.mask").exists())

    def test_a_journal_that_is_a_link_creates_nothing(self):
        journal = self.project / "session.journal"
        for target in (self.home / "made.journal", self.precious):
            with self.subTest(target=target):
                journal.symlink_to(target)
                before = content(self.home)
                self.check_refused("annotate", self.session(mask="a.mask"), "--script", self.script,
                                   says=["the journal, which is " + str(target)])
                self.assertEqual(content(self.home), before)
                journal.unlink()

    def test_files_inside_and_a_project_s_own_folders_need_no_option(self):
        (self.project / "sub").mkdir()
        (self.project / "inner.mask").symlink_to("sub/there.mask")
        for mask in ("a.mask", "sub/../b.mask", "sub/c.mask", str(self.project / "d.mask"), "inner.mask"):
            self.check("annotate", self.session(mask=mask), "--script", self.script, "--fresh")
        self.check("import", Volume.noise((24, 24, 24), seed=1).write(self.folder), self.folder / "made")
        self.check("annotate", self.folder / "made", "--script", self.script)


class Links(CliTest):
    def test_an_output_through_a_link_is_written_to_its_target(self):
        real, link = self.folder / "real", self.folder / "link"
        real.mkdir()
        session = self.write_session()
        for extension, command in ((".png", ["render", session, "-o"]), (".mask", ["export", session, "--mask"]),
                                   (".nrrd", ["label", session, "--threshold", "100", "-o"])):
            for is_there in (True, False):   # a link that leads nowhere yet makes its target
                with self.subTest(extension=extension, is_there=is_there):
                    target, output = real / f"{is_there}{extension}", self.folder / f"{is_there}{extension}"
                    output.symlink_to(target)
                    if is_there:
                        target.write_bytes(b"old")
                    self.check(*command, output)
                    self.assertTrue(output.is_symlink())
                    self.assertGreater(target.stat().st_size, 3)
        link.symlink_to(real / "project")
        scan = Volume.noise((8, 8, 8), seed=1).write(self.folder)
        self.check("import", scan, real / "project")
        before = (real / "project" / "shvr" / "volume.json").stat().st_ino
        self.check("import", scan, link, "--overwrite")
        self.assertTrue(link.is_symlink())
        self.assertNotEqual((real / "project" / "shvr" / "volume.json").stat().st_ino, before)


class Leavings(CliTest):
    def test_the_next_opening_collects_what_a_killed_program_left(self):
        session = self.write_session()
        picture = self.folder / "a.png"
        with subprocess.Popen([SHVR, "render", session, "-o", picture, "--size", "65536x65536"],
                              stderr=subprocess.PIPE, env=ENVIRONMENT) as process:
            while not list(self.folder.glob(".shvr-*.tmp")):
                self.assertIsNone(process.poll())
                time.sleep(0.01)
            process.send_signal(signal.SIGKILL)
        left = list(self.folder.glob(".shvr-*.tmp"))
        self.assertEqual(len(left), 1)
        host = left[0].name.split("-", 3)[3]
        mine = self.folder / f".shvr-{os.getpid()}-0-{host}"   # its process lives
        strangers = self.folder / f".shvr-{process.pid}-0-elsewhere.tmp"   # another host wrote it lately
        old = self.folder / f".shvr-{process.pid}-1-elsewhere.tmp"
        user = self.folder / ".shvr-notes.tmp"
        for path in (mine, strangers, old, user):
            path.write_bytes(b"x")
        two_days = time.time() - 2 * 24 * 3600
        os.utime(old, (two_days, two_days))
        os.utime(user, (two_days, two_days))
        self.check("annotate", session, "--script", self.write_script("s.jsonl", [DAB]))
        self.assertEqual(sorted(self.folder.glob(".shvr-*")), sorted([mine, strangers, user]))


if __name__ == "__main__":
    unittest.main()
