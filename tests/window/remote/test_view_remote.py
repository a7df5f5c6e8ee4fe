"""A volume at an address in the window: opened by the command line, the chooser and the palette, over a network that is
slow and fails at times; nothing waits for it; and imported, or annotated in a session of this machine."""
import json
import random
import re
import shutil
import sys
import threading
import time
import unittest
from pathlib import Path

TESTS = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(TESTS / "window"), str(TESTS / "cli" / "remote")]
import store_server as faults  # noqa: E402
from harness import IS_SLOW, Volume  # noqa: E402
from pyramid_server import PyramidServer  # noqa: E402
from seen import Seen  # noqa: E402
from store_server import StoreServer  # noqa: E402
from window import PATIENCE_S  # noqa: E402

SIZE = (70, 66, 40)
LATENCY_S = 0.2
FAILING = 0.01


class Remote(Seen):
    def serve(self, fault=None):
        """An OME-Zarr at an address of this machine. A cache of its own, and limits that end no wait in a test."""
        header = Volume.noise(SIZE, seed=7, voxel_type="uint16", high=999, spacing=(1, 1, 1)).write(self.folder)
        served = self.folder / "served"
        served.mkdir()
        self.check("import", header, served / "x.zarr", "--unit", "um", "--spacing", "1,1,1", "--quiet")
        for name in ("shvr", "labels"):
            shutil.rmtree(served / "x.zarr" / name, ignore_errors=True)
        server = StoreServer(served, fault)
        server.__enter__()
        self.addCleanup(server.__exit__)
        return server

    def look(self, *arguments, **environment):
        self.view(*arguments, preferences={"hints_seen": 3},
                  environment={"SHVR_REMOTE_CACHE": self.folder / "cache", "SHVR_REMOTE_STALL_S": "500", **environment})
        self.do("mousemove", *self.middle(), pause_s=0)

    def type_address(self, address):
        """Into the dialog that asks what to open."""
        self.see_at_rest("Hidden", "Open a volume")
        self.do("key", "ctrl+a", "type", "--delay", 30, address, pause_s=0)
        self.see(address, "Open a volume")
        self.check_key("Enter", "open")

    def annotate_without_a_copy(self):
        """Returns the session on this machine that names the address of the open volume."""
        session = self.folder / "mine.json"
        self.click_on("Annotate without a copy...", "On another machine")
        self.see_at_rest("Hidden")
        self.do("key", "ctrl+a", "type", "--delay", 30, session, pause_s=0)
        self.see(str(session), "Annotate a volume")
        self.check_key("Enter", "work_on_copy")
        self.wait_for_window("x.* - SHVR$")
        self.see_sharp()
        return session

    def see_sharp(self):
        self.until(lambda: self.frame()["sharp"], "sharp picture")

    def see_message(self, text):
        self.until(lambda: any(text in seen["text"] for seen in self.seen()), f"'{text}'")

    def ends(self):
        """The window closes, although the server never answers."""
        begun = time.monotonic()
        report = self.finish()
        self.assertLess(time.monotonic() - begun, PATIENCE_S)
        return report

    def check_nowhere(self, secret, *folders):
        for folder in folders:
            for path in folder.rglob("*"):
                self.assertTrue(not path.is_file() or secret.encode() not in path.read_bytes(), path)


class View(Remote):
    # Kind (Servers): the window opens an address over a network with 200 ms and 1 % failures, and imports the volume
    def test_an_address_is_opened_looked_at_and_imported(self):
        chance, lock = random.Random(5), threading.Lock()

        def slow(*_):
            time.sleep(LATENCY_S)
            with lock:
                return faults.status(503, Retry_After="0") if chance.random() < FAILING else None
        server = self.serve(slow)
        self.look(server.address("x.zarr"))
        self.wait_for_window(r"x.* - SHVR \(read only\)")
        self.see_sharp()
        self.see(f"Read only: {server.address('x.zarr')} lies on another machine", "On another machine")
        # Nothing can be saved.
        self.press("Ctrl+S")
        self.see_message(f"Error: {server.address('x.zarr')}: is no")
        project = self.folder / "local.zarr"
        self.click_on("Import as project...", "On another machine")
        self.see(server.address("x.zarr"), "Import as project")
        self.type_into("Project", project, "Import as project")
        self.click_on("Import", "Import as project")
        self.wait_for_window("local.* - SHVR$")
        self.see_sharp()
        self.check_key("Ctrl+S", "save")
        messages = self.finish()["messages"]
        self.assertTrue(any(line.startswith(f"Opened {project}") for line in messages), messages)
        self.assertEqual(self.check_json("info", project)["size"], list(SIZE))

    def test_annotation_without_a_copy_is_kept_in_a_session_of_this_machine(self):
        server = self.serve()
        self.look(server.address("x.zarr"))
        self.see_sharp()
        session = self.annotate_without_a_copy()
        self.assertFalse(self.seen("Read only"))
        self.finish()
        self.assertEqual(json.loads(session.read_text())["volume"]["path"], server.address("x.zarr"))
        self.assertEqual([path.name for path in Path.cwd().glob("x.session*")], [])

    def test_while_a_server_is_silent_frames_go_on_and_cancel_ends_the_opening(self):
        server = self.serve(lambda path, _: faults.silent)
        self.look()
        self.press("Ctrl+O")
        self.type_address(server.address("x.zarr"))
        self.see("measuring x.zarr", "Jobs")
        self.until(lambda: server.busy > 0, "request")
        self.see_frames(5)
        self.click_on("Cancel", "Jobs")
        self.see_message("Cancelled: opening x.zarr")
        self.see_no_more("measuring x.zarr", "Jobs")
        # Opened again; this time it is the window that closes.
        self.press("Ctrl+O")
        self.see_at_rest(server.address("x.zarr"), "Open a volume")
        self.check_key("Enter", "open")
        self.see("measuring x.zarr", "Jobs")
        self.ends()

    def test_reads_of_a_picture_end_when_the_window_closes(self):
        server = PyramidServer(2048, holds=False)
        server.fault = lambda path, _: faults.silent if re.search(r"/x.zarr/[012]/\d", path) else None
        server.__enter__()
        self.addCleanup(server.__exit__)
        self.look(server.address("x.zarr"))
        self.wait_for_window("x.* - SHVR")
        self.until(lambda: server.busy > 0, "request that is not answered")
        self.see_frames(5)
        self.ends()

    # Kind (Servers): what was looked at before is shown from the cache when its server is gone, and the window says so
    def test_what_was_seen_before_is_shown_without_its_server(self):
        server = self.serve()
        self.look(server.address("x.zarr"))
        self.see_sharp()
        self.finish()
        server.__exit__()
        self.look(server.address("x.zarr"))
        self.wait_for_window(r"x.* - SHVR \(read only\)")
        self.see("1 warning")
        self.see_sharp()
        messages = self.finish()["messages"]
        self.assertTrue(any("taken from the cache on this machine" in line for line in messages), messages)
        self.assertFalse([line for line in messages if "cannot be read" in line], messages)

    # Kind (Servers): servers that refuse, never end, and lead elsewhere; the dialog says why, and another address opens
    def test_what_a_server_does_wrong_is_said_where_the_address_was_typed(self):
        served = self.serve()
        hostile = StoreServer(self.folder / "served")
        hostile.__enter__()
        self.addCleanup(hostile.__exit__)
        self.look()
        self.press("Ctrl+O")
        for fault, says in [(faults.status(403), "access is refused"), (faults.endless, "the body is longer than"),
                            (faults.status(302, Location="ftp://host/x"), "redirect")]:
            hostile.fault = lambda *_, fault=fault: fault
            self.type_address(hostile.address("x.zarr"))
            self.until(lambda says=says: any(says in seen["text"] for seen in self.seen(window="Open a volume")), says)
        self.type_address(served.address("x.zarr"))
        self.see_sharp()
        self.finish()

    # Kind (Servers): a presigned address, by the palette, in none of the files that the window writes
    def test_a_query_stays_in_memory(self):
        server, secret = self.serve(), "sig=T0pSecret"
        server.check = lambda path, _: path.endswith("?" + secret)
        self.look()
        self.press("Ctrl+Shift+P")
        self.until(lambda: self.seen(window="Find anything"), "palette")
        self.do("type", "--delay", 30, f"{server.address('x.zarr')}?{secret}", pause_s=0)
        self.see(f"Open {server.address('x.zarr')}", "Find anything")
        self.check_key("Enter", "open")
        self.see_sharp()
        self.annotate_without_a_copy()
        self.words.unlink()   # what is on the screen, as typed
        report = self.finish()
        self.words.unlink(missing_ok=True)
        self.assertNotIn("Secret", json.dumps(report))
        self.check_nowhere("Secret", self.folder)
        recent = json.loads((self.configuration / "preferences.json").read_text())["recent"]
        self.assertIn(server.address("x.zarr"), [each["path"] for each in recent])


# Sequential round trips until a picture of a volume of 2048^3 voxels is on the screen, as counted: the first object, since
# a client must learn whether its connection takes several requests at once; the root's other metadata; all levels'
# metadata; a level of 128^3 voxels, which is measured; the coarsest level, which is shown.
MOST_ROUNDS = 5


class Rounds(Remote):
    def shows_volume(self):
        """Whether the volume, above the middle of the graphics window, differs from the background right of it. In the
        middle, a text says that the first picture is being made."""
        self.see_frames(5)
        x, y = self.middle()
        row = self.pixels()[2][y - 60]
        inside, outside = (row[3 * at:3 * at + 3] for at in (x - 60, 2 * x - 40))
        return bool(self.seen("Read only")) and inside != outside

    def rounds(self, server):
        """The number of round trips, one after the other, until the volume is seen."""
        server.__enter__()
        self.addCleanup(server.__exit__)
        self.addCleanup(server.release)
        self.look(server.address("x.zarr"), SHVR_REMOTE_CACHE_MIB="0")
        for rounds in range(2 * MOST_ROUNDS):
            # Sharper pictures follow without a request: while they are drawn, the program does not rest.
            self.until(lambda: self.shows_volume() or (server.held and server.rests(self.program, self.drawn_number)),
                       f"request that is waited for after {rounds} round trips")
            if self.shows_volume():
                self.finish()
                return rounds
            server.release()
        self.fail(f"no picture after {2 * MOST_ROUNDS} round trips: {server.paths()}")

    # Kind (Servers): the sequential round trips until the first picture of a pyramid of 2048^3 voxels, counted
    def test_the_first_picture_takes_few_round_trips(self):
        server = PyramidServer(2048)
        self.assertLessEqual(self.rounds(server), MOST_ROUNDS, server.paths())

    @unittest.skipUnless(IS_SLOW, "the gate can fail")
    def test_another_round_trip_is_counted(self):
        server = PyramidServer(2048)
        hold = server.fault

        def redirect(path, count):
            hold(path, count)
            return faults.status(302, Location=path + "?again") if path.endswith("/x.zarr/5/0/0/0") else None
        server.fault = redirect
        self.assertEqual(self.rounds(server), MOST_ROUNDS + 1, server.paths())


if __name__ == "__main__":
    unittest.main()
