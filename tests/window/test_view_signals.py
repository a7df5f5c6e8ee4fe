"""SIGTERM, SIGHUP and Ctrl-C end the window in every state, also while a disk, a device or a peer never answers. Nothing
that was done is lost: what was not saved is in the journal, and an import goes on from the folder that is named."""
import base64
import hashlib
import json
import signal
import socket
import threading
import time
import unittest

from harness import run
from seen import Seen
from test_import import content_of
from window import PATIENCE_S


class Peer:
    """A WebSocket peer where an Inverse3 is looked for; it sends pings without end, and nothing else."""
    PINGS = b"\x89\0" * 20_000

    def __init__(self):
        self.listener = socket.socket()
        self.listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        end = time.monotonic() + PATIENCE_S
        while True:
            try:
                self.listener.bind(("127.0.0.1", 10001))
                break
            except OSError:   # another program has the port
                if time.monotonic() > end:
                    raise
                time.sleep(0.5)
        self.listener.listen(8)
        self.sent = 0
        threading.Thread(target=self.accept, daemon=True).start()

    def close(self):
        self.listener.shutdown(socket.SHUT_RDWR)
        self.listener.close()

    def accept(self):
        while True:
            try:
                client, _ = self.listener.accept()
            except OSError:
                return
            threading.Thread(target=self.flood, args=(client,), daemon=True).start()

    def flood(self, client):
        with client:
            try:
                request = b""
                while b"\r\n\r\n" not in request:
                    request += client.recv(4096)
                key = request.partition(b"Sec-WebSocket-Key: ")[2].partition(b"\r\n")[0]
                accept = base64.b64encode(hashlib.sha1(key + b"258EAFA5-E914-47DA-95CA-C5AB0DC85B11").digest())
                client.sendall(b"HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                               b"Sec-WebSocket-Accept: " + accept + b"\r\n\r\n")
                while True:
                    client.sendall(self.PINGS)
                    self.sent += len(self.PINGS)
            except OSError:
                pass


class Signals(Seen):
    """Times are no verdict: a state in which the window would wait never ends by itself."""

    def end_by(self, number, is_cut_off):
        """`is_cut_off`: whether something is awaited that never comes, so that only the signal itself can end it."""
        self.program.send_signal(number)
        output, errors = self.program.communicate(timeout=PATIENCE_S)
        name = "Ctrl-C" if number == signal.SIGINT else number.name
        self.assertIn(f"shvr: stopped by {name}", errors)
        if is_cut_off or self.program.returncode != 0:   # on a busy machine it may be cut off elsewhere, too
            self.assertEqual(self.program.returncode, -number, errors)
            self.assertIn(f"shvr: stopped by {name} before everything had ended; no file is left half written", errors)
        return output, errors

    def hung(self):
        """A session whose annotation is on a disk that answers until `answers` is removed."""
        (self.folder / "hung").mkdir()
        session = self.write_ball(annotation={"mask": str(self.folder / "hung" / "paint.mask"),
                                              "trace": str(self.folder / "hung" / "trace.graphml")})
        self.answers = self.folder / "answers"
        self.answers.write_text("")
        return session, self.hung_disk(self.answers, self.folder / "hung.log")

    def paint(self):
        x, y = self.middle()
        self.check_probe(x, y)
        self.check_stroke((x, y), (x + 20, y))
        self.see("Painted ", "Status")
        self.see_kept()

    def voxels(self, session):
        """Of group 3, when the project is opened again."""
        exported = self.folder / "exported.mask"
        result = run("export", session, "--mask", exported, "--json")
        self.assertEqual(result.returncode, 0, result.stderr)
        return json.loads(result.stdout)["voxels_by_group"].get("3", 0)

    def test_while_a_chooser_is_open(self):
        self.view(preferences={"hints_seen": 3})
        self.see("Open the example")
        self.press("Ctrl+O")
        self.see_at_rest("Hidden")
        self.end_by(signal.SIGTERM, is_cut_off=False)

    def test_while_a_scan_is_opened_from_a_disk_that_does_not_answer(self):
        session, disk = self.hung()
        self.answers.unlink()
        for number in (signal.SIGINT, signal.SIGTERM):
            self.view(session, preferences={"hints_seen": 3}, environment=disk)
            self.see("Opening ")
            self.end_by(number, is_cut_off=True)

    def test_while_a_save_hangs(self):
        session, disk = self.hung()
        self.open_scan(session, "--outside", preferences={"hints_seen": 3}, environment=disk)
        self.paint()
        self.answers.unlink()
        self.press("Ctrl+S")
        self.see("saving ")
        self.end_by(signal.SIGTERM, is_cut_off=True)
        self.assertEqual(list((self.folder / "hung").iterdir()), [])
        self.assertGreater(self.voxels(session), 50)

    def test_while_an_export_hangs(self):
        session, disk = self.hung()
        self.open_scan(session, "--outside", preferences={"hints_seen": 3}, environment=disk)
        self.paint()
        self.click_on("File", "##MainMenuBar")
        self.click_on("Export...", "##Menu_00")
        self.see("Cancel", "Export annotation")
        self.do("key", "ctrl+a", "type", "--delay", 40, self.folder / "hung" / "out", pause_s=0)
        self.see(str(self.folder / "hung" / "out"), "Export annotation")
        self.answers.unlink()
        self.click_on("Export", "Export annotation")
        self.end_by(signal.SIGINT, is_cut_off=True)
        self.assertEqual(list((self.folder / "hung").iterdir()), [])
        self.assertGreater(self.voxels(session), 50)

    def begin_import(self, hung_path, **environment):
        """Starts an import on a disk that does not answer about those paths until `answers` is there."""
        self.scan, self.project = self.folder / "scan.nrrd", self.folder / "hung" / "project"
        self.part = self.project.with_name("project.part")
        self.project.parent.mkdir(exist_ok=True)
        self.scan.write_bytes(b"NRRD0004\ntype: uint8\ndimension: 3\nsizes: 80 70 66\nencoding: raw\n\n" +
                              bytes(number * 7 % 251 for number in range(80 * 70)) * 66)
        self.answers = self.folder / "answers"
        self.answers.unlink(missing_ok=True)
        self.view(preferences={"hints_seen": 3}, environment={
            **self.hung_disk(self.answers, self.folder / "hung.log"), "SHVR_HUNG_PATH": hung_path, **environment})
        self.see("Open the example")
        self.click_on("File", "##MainMenuBar")
        self.click_on("Import as project...", "##Menu_00")
        self.type_into("Scan", self.scan, "Import as project")
        self.type_into("Project", self.project, "Import as project")
        self.click_on("Import", "Import as project")

    def check_goes_on(self, errors):
        """The message names the folder, and the same import goes on from there to what it makes elsewhere."""
        self.assertIn(str(self.part), errors)
        # The window, where it has the time, says what its banner offers.
        self.assertRegex(errors, "goes on from there; rm -r removes it|can be resumed or deleted")
        self.assertTrue(self.part.is_dir())
        self.check("import", self.scan, self.project)
        self.check_is_whole()

    def check_is_whole(self):
        other = self.folder / "other" / self.project.name
        other.parent.mkdir()
        self.check("import", self.scan, other)
        self.assertEqual(content_of(self.project), content_of(other))

    def test_while_an_import_hangs(self):
        self.begin_import("/project.part/0/")
        self.until(lambda: (self.part / "shvr" / "import.state").exists(), "begun import")
        _, errors = self.end_by(signal.SIGHUP, is_cut_off=True)
        self.check_goes_on(errors)

    def test_while_removing_what_an_import_writes_hangs(self):
        self.begin_import("/project.part/shvr/.shvr-", SHVR_HUNG_REMOVALS="1")
        self.until(lambda: any(self.part.glob("shvr/.shvr-*")), "temporary file")
        _, errors = self.end_by(signal.SIGTERM, is_cut_off=True)
        self.assertTrue(any(self.part.glob("shvr/.shvr-*")))
        self.check_goes_on(errors)
        self.assertFalse(any(self.project.rglob(".shvr-*")))

    def test_while_an_import_goes_on(self):
        self.begin_import("/project.part/1/0/")
        self.until(lambda: any(self.part.glob("0/0/*/*")), "chunk")
        self.program.send_signal(signal.SIGINT)
        self.answers.write_text("")   # the disk answers again, before or after the program is cut off
        _, errors = self.program.communicate(timeout=PATIENCE_S)
        self.assertIn(self.program.returncode, (0, -signal.SIGINT))
        if self.project.exists():   # the import had ended before the signal was heard
            self.check_is_whole()
        else:
            self.check_goes_on(errors)

    def test_while_the_device_hangs(self):
        session = self.write_ball()
        held = self.folder / "held"
        self.open_scan(session, preferences={"hints_seen": 3},
                       environment={"VK_INSTANCE_LAYERS": "VK_LAYER_SHVR_waits", "SHVR_WAITS_HELD": held})
        self.paint()
        held.write_text("")
        self.wander(3)
        self.end_by(signal.SIGTERM, is_cut_off=True)
        self.assertGreater(self.voxels(session), 50)

    def test_while_a_peer_floods_it_with_pings(self):
        session = self.write_ball()
        peer = Peer()
        self.addCleanup(peer.close)
        self.open_scan(session, preferences={"hints_seen": 3})
        self.until(lambda: peer.sent > 1_000_000, "flood")
        self.paint()
        self.end_by(signal.SIGTERM, is_cut_off=False)
        self.assertGreater(self.voxels(session), 50)


if __name__ == "__main__":
    unittest.main()
