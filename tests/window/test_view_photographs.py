"""Every panel, dialog and menu, photographed at two scales and in two themes, with long names and names in other
scripts. The pictures are left beside the program, in photographs/, to be looked at; that no words are cut off, and that
none lie over others, is found out here."""
import json
import os
import struct
import unittest
import zlib
from pathlib import Path

from harness import SHVR
from seen import PANELS, Seen
from window import Display

FOLDER = Path(SHVR).resolve().parent / "photographs"
LONG = "Leitbündel des mittleren Blütenstiels mit seinem Nebenast"
SCRIPTS = ["维管束与细胞壁的边界", "Проводящий пучок", "Αγγειακή δέσμη"]
# A minute each: the others are taken on request only, for visual inspection.
ALL = unittest.skipUnless(os.environ.get("SHVR_ALL_PHOTOGRAPHS"), "SHVR_ALL_PHOTOGRAPHS=1 takes all of them")
SLACK = 1.5   # pixels by which boxes of ink may touch


def write_png(path, width, height, rows):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)) +
                     chunk(b"IDAT", zlib.compress(b"".join(b"\0" + row for row in rows), 1)) + chunk(b"IEND", b""))


class Photographs(Seen):
    maxDiff = None
    size = (1000, 2300)   # at a scale of 1: high enough for most panels at once

    def start(self, *arguments, environment=None):
        width, height = (round(self.scale * side) for side in self.size)
        self.display = Display(f"{width}x{height}")
        self.addCleanup(self.display.close)
        self.window_size = (width, height)
        super().start(*arguments, environment=environment)

    def photograph(self, name):
        """A picture of what is on the screen once that is still; notes what is wrong with its words."""
        before = None
        def is_still():
            nonlocal before
            now = self.seen()
            is_same, before = now == before, now
            return is_same
        for _ in range(2):
            self.do(pause_s=0.15)
            self.until(is_still, "still screen")
        name = f"{name}-{self.theme}-{self.scale:g}"
        FOLDER.mkdir(exist_ok=True)
        write_png(FOLDER / f"{name}.png", *self.pixels())
        for what in self.faults():
            self.wrong.append(f"{name}: {what}")

    def faults(self):
        texts = [seen for seen in self.seen() if not seen["scrolled"]]
        for seen in texts:
            if seen["cut"] and not seen["text"].startswith("/"):   # a path in a field, which scrolls
                yield f"in {seen['window']} '{seen['text']}' is cut off"
            if "\ufffd" in seen["text"] or "??" in seen["text"]:
                yield f"in {seen['window']} '{seen['text']}' lacks characters"
        for i, one in enumerate(texts):
            for other in texts[i + 1:]:
                if one["window"] != other["window"] or one["window"] == "##Background":
                    continue
                a, b = one["box"], other["box"]
                width = min(a[2], b[2]) - max(a[0], b[0])
                height = min(a[3], b[3]) - max(a[1], b[1])
                if width > SLACK and height > SLACK:
                    yield f"in {one['window']} '{one['text']}' and '{other['text']}' lie over one another"

    def write_long_scan(self):
        """Names of groups, views and files in several scripts; a trace, paint and a history."""
        folder = self.folder / f"{LONG} {SCRIPTS[0]}"
        folder.mkdir(exist_ok=True)
        session = folder / f"{SCRIPTS[1]} {LONG}.json"
        names = [LONG, *SCRIPTS, "a"]
        session.write_text(json.dumps({
            "shvr_session": 1, "camera": "front", "cameras": {LONG: {"side": "top"}, SCRIPTS[0]: {"side": "left"}},
            "volume": {"procedural": "sphere", "size": [24, 24, 24], "spacing": [1.25, 1.25, 1.25], "unit": "um"},
            "transfer_function": {"points": [{"intensity": 100, "opacity": 0.0}, {"intensity": 200, "opacity": 1.0}]},
            "groups": {str(i + 1): {"name": name, **({"parent": i} if i in (1, 2) else {})}
                       for i, name in enumerate(names)},
            "view": {"volume": False}, "probe": {"group": 1, "radius_voxels": 4, "paint_threshold": 0,
                                                 "tool": "trace"},
            "annotation": {"mask": "paint.mask"}}))
        script = [{"op": "paint", "brush": "fill", "region": "ball", "group": group, "threshold": 0, "radius": 4,
                   "path": [[6 + group, 12, 12]]} for group in (1, 2, 3)]
        script += [{"op": "node", "at": [4 + i, 12, 12], "radius": 1.5, "group": 1 + i % 4} for i in range(5)]
        self.check("annotate", session, "--script", self.write_script("long.jsonl", [*script, {"op": "save"}]))
        return session

    def check_look(self, scale, theme):
        self.scale, self.theme, self.wrong = scale, theme, []
        session = self.write_long_scan()
        panels = {name: {"folded": False} for name in PANELS}
        self.open_scan(session, "--size", "{}x{}".format(*(round(scale * side) for side in self.size)),
                       preferences={"scale": scale, "theme": theme, "layout": {"panels": panels}, "hints_seen": 3})
        self.photograph("panels")
        for name, chord, window in (("help", "F1", "Keys and mouse"), ("preferences", "Ctrl+,", "Preferences"),
                                    ("palette", "Ctrl+Shift+P", "Find anything"), ("open", "Ctrl+O", "Open a volume")):
            self.press(chord)
            self.see("", window)
            self.photograph(name)
            self.press("Escape")
            self.see_no_more("", window)
        for arrangement, chord in (("stereo", "Shift+F11"), ("overview", "F9"), ("slices", "F6")):
            self.press(chord)
            self.photograph(arrangement)
        self.press("F10")
        for entry in ("Save as...", "Open with options...", "Correct the spacing...", "Import as project...",
                      "Export...", "Label connected parts...", "Compare with a reference...", "Load annotation...",
                      "Figure...", "Movie..."):
            self.click_on("File", "##MainMenuBar")
            self.click_on(entry, "##Menu_00")
            self.see("Cancel")
            self.photograph(entry.strip(".").replace(" ", "_"))
            self.press("Escape")
            self.see_no_more("Cancel")
        for title, entry in (("Help", "Messages"), ("Tools", "GPU passes")):
            self.click_on(title, "##MainMenuBar")
            self.click_on(entry, "##Menu_00")
            self.see(entry, entry)
            self.photograph(entry.replace(" ", "_"))
            self.press("Escape")
            self.see_no_more(entry, entry)
        for title in [seen["text"] for seen in self.seen(window="##MainMenuBar")]:
            self.click_on(title, "##MainMenuBar")
            self.see("", "##Menu_00")
            self.photograph(f"menu_{title}")
            self.press("Escape")
            self.see_no_more("", "##Menu_")
        self.finish()
        self.assertEqual(self.wrong, [])

    def check_start(self, scale, theme):
        self.scale, self.theme, self.wrong = scale, theme, []
        session = self.write_long_scan()
        gone = str(self.folder / f"gone {LONG}" / f"{SCRIPTS[0]}.nrrd")
        self.view("--size", "{}x{}".format(*(round(scale * side) for side in (1000, 700))),
                  preferences={"scale": scale, "theme": theme, "recent": [{"path": str(session)}, {"path": gone}]})
        self.see("Open the example")
        self.photograph("start")
        self.finish()
        self.assertEqual(self.wrong, [])

    def test_dark(self):
        self.check_look(1, "dark")

    @ALL
    def test_light(self):
        self.check_look(1, "light")

    @ALL
    def test_dark_and_large(self):
        self.check_look(2, "dark")

    @ALL
    def test_light_and_large(self):
        self.check_look(2, "light")

    def test_large_words_have_room_in_a_small_window(self):
        self.scale, self.theme, self.wrong, self.size = 2, "dark", [], (640, 400)
        self.open_scan(self.write_ball(), "--size", "1280x800", preferences={"scale": 2, "hints_seen": 3})
        self.see("Logarithmic", "Side panel")
        self.photograph("small")
        bars = [what for what in self.wrong if "in Tools " in what or "in Side panel " in what]
        self.assertEqual(bars, [])
        self.assertEqual([sign for sign in "<>+" if not self.seen(sign, "Tools")], [])
        self.finish()

    def test_start_page(self):
        self.check_start(1, "dark")

    @ALL
    def test_start_page_light_and_large(self):
        self.check_start(2, "light")


if __name__ == "__main__":
    unittest.main()
