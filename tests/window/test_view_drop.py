"""Files dropped onto the window as a file manager drops them, and the menu entry for who cannot: known by what is in
them, whatever they are called."""
import json
import struct
import unittest

from seen import Seen
from xdnd import Source

CURVE = {"points": [{"intensity": 90, "color": "#ff0000", "opacity": 0}, {"intensity": 210, "opacity": 0.75}]}
KEPT = {"note": "Kept by hand.", "extends": False,
        "points": [{"at": 0, "color": "#200000", "opacity": 0}, {"at": 1, "color": "#ffffe0", "opacity": 0.5}]}


class Drop(Seen):
    PREVIEW = "Load annotation"

    def drop(self, *paths):
        window = int(self.window_named("SHVR"))
        source = Source(self.display.name, window)
        self.addCleanup(source.close)
        source.drop(paths, self.middle())

    def told(self, words):
        """Its folders are left out of a path where there is no room."""
        self.until(lambda: any(words in seen["text"] for seen in self.seen(window="Status")), f"'{words}'")

    @staticmethod
    def opacities(session):
        return [point["opacity"] for point in json.loads(session.read_text())["transfer_function"]["points"]]

    def check_saved(self, session, expected):
        self.press("Ctrl+S")
        self.until(lambda: self.opacities(session) == expected, f"session with the opacities {expected}", 20)

    def test_a_transfer_function_is_taken_in_both_its_forms_and_undone(self):
        session = self.write_ball()
        before = self.opacities(session)
        self.open_scan(session, preferences={"hints_seen": 3})
        curve, kept = self.folder / "Kurve für Leitbündel (1)", self.folder / "kept look.json"
        curve.write_text(json.dumps(CURVE))
        kept.write_text(json.dumps(KEPT))
        self.drop(curve)
        self.told(f"{curve.name}; undo takes it back")
        self.check_saved(session, [0, 0.75])
        self.drop(kept)
        self.told(f"{kept.name}; undo takes it back")
        self.check_saved(session, [0, 0.5])
        for expected in ([0, 0.75], before):
            self.press("Ctrl+Z")
            self.check_saved(session, expected)
        self.finish()

    def test_of_several_files_each_is_taken_and_what_is_none_is_told(self):
        self.open_scan(self.write_ball(), preferences={"hints_seen": 3})
        curve, trace, other = (self.folder / name for name in ("curve.json", "line.txt", "notes.txt"))
        curve.write_text(json.dumps(CURVE))
        trace.write_text("-v 30, 32, 32, 1, 2\n")
        other.write_text("nothing that is known\n")
        self.drop(curve, trace)
        self.see("A trace of 1 node and 0 internodes replaces one of 0 nodes", self.PREVIEW)
        self.press("Enter")
        self.told(f"{trace.name}; undo takes it back")
        self.drop(other)
        self.see("Error: ", "Status")
        report = self.finish()
        said = "\n".join(report["messages"])
        self.assertIn("curve.json; undo takes it back", said)
        self.assertIn("line.txt; undo takes it back", said)
        self.assertIn("notes.txt", said)

    def test_a_scan_is_dropped_onto_the_start_page(self):
        session = self.write_ball()
        self.view(preferences={"hints_seen": 3})
        self.see("Open the example")
        self.drop(session)
        self.wait_for_window("sphere.* - SHVR")
        self.finish()

    def test_a_mask_is_no_scan_in_the_menu_and_is_asked_about_where_it_could_be(self):
        session = self.write_ball(volume={"procedural": "sphere", "size": [16, 16, 16]})
        self.open_scan(session, preferences={"hints_seen": 3})
        header = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: {} 16 16\nencoding: raw\n\n"
        mask, small = self.folder / "mask.nrrd", self.folder / "small.nrrd"
        mask.write_bytes(header.format(16).encode() + b"\3" * 4096)
        small.write_bytes(header.format(8).encode() + b"\3" * 2048)

        def load(path):
            self.click_on("File", "##MainMenuBar")
            self.click_on("Load annotation...", "##Menu_00")
            self.see("Cancel", self.PREVIEW)
            self.do("key", "ctrl+a", "type", "--delay", 20, path, pause_s=0)
            self.see(str(path), self.PREVIEW)
        load(small)
        self.see(f"{small}: is a volume of 8 16 16 voxels", self.PREVIEW)   # refused in the dialog
        self.press("Enter")
        self.see("Cancel", self.PREVIEW)
        self.press("Escape")
        self.see_no_more("Cancel", self.PREVIEW)
        load(mask)
        self.see("4096 voxels change their group.", self.PREVIEW)
        self.see("+4096", self.PREVIEW)
        self.click_on("Cancel", self.PREVIEW)
        self.see_no_more("Cancel", self.PREVIEW)
        load(mask)
        self.see("+4096", self.PREVIEW)
        self.press("Enter")
        self.told("mask.nrrd; undo takes it back")
        self.press("Ctrl+Z")
        self.see("Undone", "Status")
        self.drop(mask)
        self.click_on("Load as the mask", "Scan or annotation?")
        self.see_no_more("Load as the mask")
        self.click_on("Load", self.PREVIEW)
        self.told("mask.nrrd; undo takes it back")
        self.drop(mask)
        self.see("Open as another scan", "Scan or annotation?")
        self.click_on("Cancel", "Scan or annotation?")
        self.see_no_more("Open as another scan")
        self.wait_for_window("sphere.* - SHVR")
        report = self.finish()
        self.assertNotIn("Opened " + str(mask), "\n".join(report["messages"]))

    def test_a_mask_of_too_many_labels_is_refused_in_the_dialog_with_their_number(self):
        session = self.write_ball(volume={"procedural": "sphere", "size": [16, 16, 16]})
        labels = self.folder / "labels.nrrd"
        header = "NRRD0004\ntype: uint16\ndimension: 3\nsizes: 16 16 16\nencoding: raw\nendian: little\n\n"
        labels.write_bytes(header.encode() + struct.pack("<4096H", *(voxel % 301 for voxel in range(4096))))
        self.open_scan(session, preferences={"hints_seen": 3})
        self.click_on("File", "##MainMenuBar")
        self.click_on("Load annotation...", "##Menu_00")
        self.see("Cancel", self.PREVIEW)
        self.do("key", "ctrl+a", "type", "--delay", 20, labels, pause_s=0)
        self.see(str(labels), self.PREVIEW)
        self.click_on("mask", self.PREVIEW)

        def is_told():   # in as many lines as the dialog's width asks for
            said = " ".join(seen["text"] for seen in self.seen(window=self.PREVIEW))
            return "holds 300 labels, the highest 300, of type uint16; expected at most 255 labels" in said
        self.until(is_told, "number of the labels")
        self.press("Enter")   # loads nothing
        self.see_frames()
        self.assertTrue(is_told())
        self.click_on("Cancel", self.PREVIEW)
        self.see_no_more("Cancel", self.PREVIEW)
        self.assertEqual(self.finish()["voxels_in_group"], {})

    def test_a_preview_that_appears_long_after_the_last_event_is_laid_out(self):
        side = 320  # so that its preview takes longer than the interface is drawn after an event
        session = self.write_ball(volume={"procedural": "sphere", "size": [side] * 3})
        mask = self.folder / "mask.nrrd"
        header = f"NRRD0004\ntype: uint8\ndimension: 3\nsizes: {side} {side} {side}\nencoding: raw\n\n"
        mask.write_bytes(header.encode() + b"\3" * side**3)
        self.open_scan(session, preferences={"hints_seen": 3})
        self.click_on("File", "##MainMenuBar")
        self.click_on("Load annotation...", "##Menu_00")
        self.see("Cancel", "Load annotation")
        self.do("key", "ctrl+a", "type", "--delay", 20, mask, pause_s=0)
        self.see(str(mask), "Load annotation")
        self.see("Undo takes it back.", self.PREVIEW)
        self.see(f"+{side**3}", self.PREVIEW)
        self.click_on("Cancel", self.PREVIEW)
        self.finish()

    def test_a_dropped_file_that_states_that_it_is_a_mask_is_previewed(self):
        session = self.write_ball(volume={"procedural": "sphere", "size": [16, 16, 16]})
        self.open_scan(session, preferences={"hints_seen": 3})
        mask = self.folder / "mask.nrrd"
        mask.write_bytes(b"NRRD0004\ntype: uint8\ndimension: 3\nsizes: 16 16 16\nencoding: raw\n"
                         b"shvr_content:=mask\n\n" + b"\0" * 2048 + b"\2" * 2048)
        for button in ("Cancel", "Load"):
            self.drop(mask)
            self.see("2048 voxels change their group.", self.PREVIEW)
            self.see("+2048", self.PREVIEW)
            self.see("Cancel", self.PREVIEW)   # the buttons, which the title's "Load" is not
            self.click_on(button, self.PREVIEW)
            self.see_no_more("Cancel", self.PREVIEW)
            if button == "Cancel":
                self.assertFalse(any("Loaded the mask" in seen["text"] for seen in self.seen(window="Status")))
        self.told("mask.nrrd; undo takes it back")
        self.assertEqual(self.finish()["voxels_in_group"], {"2": 2048})

    def test_a_label_image_opened_as_a_scan_is_told_of_and_loaded_into_its_scan(self):
        session = self.write_ball(volume={"procedural": "sphere", "size": [16, 16, 16]})
        labels = self.folder / "labels.nrrd"
        labels.write_bytes(b"NRRD0004\ntype: uint8\ndimension: 3\nsizes: 16 16 16\nencoding: raw\n\n" +
                           b"\0" * 2048 + b"\2" * 2048)
        self.view(labels, preferences={"hints_seen": 3})
        self.see("labels.nrrd looks like a label image, not like a scan", "Labels")
        self.click_on("Open its scan...", "Labels")
        self.see("Cancel", "Open the scan of a label image")
        self.do("key", "ctrl+a", "type", "--delay", 20, session, pause_s=0)
        self.see(str(session), "Open the scan of a label image")
        self.press("Enter")
        self.told("labels.nrrd; undo takes it back")
        self.see_no_more("Open its scan...")
        report = self.finish()
        self.assertEqual(report["voxels_in_group"], {"2": 2048})

    def test_the_menu_takes_what_could_be_dropped(self):
        self.open_scan(self.write_ball(), preferences={"hints_seen": 3})
        curve = self.folder / "curve.json"
        curve.write_text(json.dumps(CURVE))
        self.click_on("File", "##MainMenuBar")
        self.click_on("Load annotation...", "##Menu_00")
        self.see("Cancel", "Load annotation")
        self.do("key", "ctrl+a", "type", "--delay", 20, self.folder / "gone.json", pause_s=0)
        self.see(str(self.folder / "gone.json"), "Load annotation")
        self.see(f"{self.folder / 'gone.json'}: there is no such file", "Load annotation")
        def is_emptied():   # a Ctrl+A may come between two frames
            self.select_all()
            self.press("BackSpace")
            self.see_frames()
            return self.seen("mask, offsets, trace, transfer function or mesh", "Load annotation")
        self.until(is_emptied, "empty field")
        self.do("type", "--delay", 20, curve, pause_s=0)
        self.see(str(curve), "Load annotation")
        self.see("The transfer function would be replaced.", self.PREVIEW)
        self.press("Enter")
        self.told(f"{curve.name}; undo takes it back")
        self.see_no_more("Cancel", "Load annotation")
        self.finish()


if __name__ == "__main__":
    unittest.main()
