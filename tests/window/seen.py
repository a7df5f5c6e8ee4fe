"""What is seen and done in the window, for its tests: the words on the screen with their places (ui/screen_text.h), and
the log of actions. Tests wait on these, never on times."""
import json
import re
import signal
import struct
import subprocess
import time
from pathlib import Path

from harness import ENVIRONMENT, SHVR
from window import PATIENCE_S, SIDE_PANEL, WINDOW, Window

KEY_NAMES = {",": "comma", ".": "period", "/": "slash", "=": "equal", "-": "minus", "[": "bracketleft",
             "]": "bracketright", "PageUp": "Prior", "PageDown": "Next", "Space": "space", "Enter": "Return"}

PANELS = {"transfer_function": "Transfer function", "groups": "Colour groups", "probe": "Brush and probe",
          "touch": "Touch and guidance", "trace": "Tracing", "trace_list": "Tracing list",
          "measurements": "Measurements", "meshes": "Meshes", "light": "Light and depth",
          "occlusion": "Ambient occlusion", "cuts": "Cutting planes", "quality": "Render quality",
          "aids": "What is shown", "views": "Views", "history": "History"}   # with their titles


def keys_file():
    """The table of shortcuts, in whichever room of the program its bindings are."""
    found = [path for room in ("engine", "ui") for path in Path(room).rglob("KEYS.md")]
    if len(found) != 1:
        raise FileNotFoundError(f"KEYS.md: {len(found)} files below engine and ui; expected one, run from the tree's root")
    return found[0]


def shortcut_rows():
    """The table of shortcuts: [{id, does, today, thesis, action}], in order."""
    found = []
    for line in keys_file().read_text().splitlines():
        cells = [cell.strip() for cell in line.strip()[1:-1].split("|")]
        if line.startswith("| `") and len(cells) == 5:
            found.append(dict(zip(["id", "does", "today", "thesis", "action"],
                                  [cell.strip("`") for cell in cells[:4]] + [cells[4]])))
    return found


def pressed(chord):
    """A chord as xdotool spells it."""
    *modifiers, key = re.split(r"\+(?=.)", chord)
    return "+".join([*(m.lower() for m in modifiers), KEY_NAMES.get(key, key.lower() if len(key) == 1 else key)])


def in_short(action):
    """"orbit", "set probe.brush": an action of the log, as the table of shortcuts has it."""
    def names(patch, prefix):
        for key, value in patch.items():
            if isinstance(value, dict) and value:
                yield from names(value, f"{prefix}{key}.")
            else:
                yield prefix + key
    return action["op"] if action["op"] != "set" else "set " + ", ".join(names(action["values"], ""))


def shift_of(mask):
    """How many zero bits are below a channel's mask."""
    return (mask & -mask).bit_length() - 1


def read_xwd(data):
    """Width, height and rows of red, green and blue of what xwd writes, in whatever whole bytes a pixel and order of
    bytes its header states."""
    header = struct.unpack(">25I", data[:100])
    header_bytes, image_format, width, height, order = header[0], header[2], header[4], header[5], header[7]
    bits, line, masks, colors = header[11], header[12], header[14:17], header[19]
    if image_format != 2 or bits % 8 or bits < 24 or any(mask >> shift != 255 for mask, shift in
                                                         zip(masks, map(shift_of, masks))):
        raise ValueError(f"xwd: format {image_format}, {bits} bits a pixel, masks {masks}; expected format 2 (ZPixmap), "
                         "24 or 32 bits and 8 bits a channel: start Xvfb with -screen 0 ...x24")
    size = bits // 8
    places = [shift_of(mask) // 8 if order == 0 else size - 1 - shift_of(mask) // 8 for mask in masks]
    begin = header_bytes + 12 * colors
    rows = []
    for y in range(height):
        row = data[begin + y * line: begin + y * line + size * width]
        pixels = bytearray(3 * width)
        for channel, place in enumerate(places):
            pixels[channel::3] = row[place::size]
        rows.append(bytes(pixels))
    return width, height, rows


def only_panel(unfolded):
    """Preferences in which it is the only panel that is unfolded."""
    folds = {name: {"folded": name != unfolded} for name in PANELS}
    return {"layout": {"panels": folds}, "hints_seen": 3}


class Seen(Window):
    last_seen = (-1, 0.0)   # number of a frame, and when it was seen first

    def view(self, *arguments, preferences=None, environment=None):
        """Starts the window with a configuration of its own, a log, and its words in a file."""
        self.log, self.words = self.folder / "log.jsonl", self.folder / "words.json"
        self.configuration = self.folder / "configuration" / "shvr"
        self.configuration.mkdir(parents=True, exist_ok=True)
        if preferences is not None:
            text = json.dumps({"shvr_preferences": 1, **preferences})
            (self.configuration / "preferences.json").write_text(text)
        for before in (self.log, self.words):   # left by a window that was closed
            before.unlink(missing_ok=True)
        self.start(*arguments, "--log", self.log,
                   environment={"XDG_CONFIG_HOME": self.configuration.parent, "SHVR_SCREEN_TEXTS": self.words,
                                **(environment or {})})
        self.until(lambda: self.words.exists(), "a first frame")

    def hung_disk(self, answers, log):
        """The environment of a program whose disk does not answer about what is in a folder `hung` until the file
        `answers` is there, and which writes into `log` what its main thread asks there."""
        disk = Path(SHVR).resolve().parent / "stubs" / "libhung_disk.so"
        if subprocess.run([SHVR, "--version"], env={**ENVIRONMENT, "LD_PRELOAD": str(disk)}).returncode:
            self.skipTest("the program's sanitizer wants to be loaded first")
        return {"LD_PRELOAD": disk, "SHVR_HUNG_UNTIL": answers, "SHVR_HUNG_LOG": log}

    def until(self, holds, what, patience_s=PATIENCE_S):
        """Waits until `holds` returns something true, and returns that."""
        end = time.monotonic() + patience_s
        while True:
            found = holds()
            if found:
                return found
            if self.program.poll() is not None:
                self.fail(f"the program has ended before there was {what}: {self.program.communicate(timeout=5)}")
            if time.monotonic() > end:
                self.fail(f"there is no {what}; on the screen: {[seen['text'] for seen in self.seen()]}")
            time.sleep(0.02)

    def soon(self, holds, patience_s=2):
        """Whether that becomes true before long."""
        end = time.monotonic() + patience_s
        while not holds() and time.monotonic() < end:
            time.sleep(0.02)
        return holds()

    # ---- What is seen

    def frame(self):
        return json.loads(self.words.read_text())

    def seen(self, text=None, window=None):
        """The words on the screen, in the order of drawing; those that begin so, in windows whose name begins so."""
        return [seen for seen in self.frame()["texts"]
                if (text is None or seen["text"].startswith(text))
                and (window is None or seen["window"].startswith(window))]

    def see(self, text, window=None):
        """Waits for words; returns the last that were drawn, those that are no more than these first."""
        found = self.until(lambda: self.seen(text, window), f"'{text}'")
        return [*found, *(seen for seen in found if seen["text"] == text)][-1]

    def see_at_rest(self, text, window=None):
        """The same once it stays where it is: a menu finds its place in its first frames."""
        seen = self.see(text, window)
        while True:
            time.sleep(0.06)
            before, seen = seen, self.see(text, window)
            if seen["box"] == before["box"]:
                return seen

    def see_frames(self, count=2):
        """Waits for frames that begin from now on: they show what was sent before. A key without a meaning keeps them
        coming."""
        last = self.frame()["frame"] + count

        def are_drawn():
            nonlocal last
            now = self.drawn_number()
            last = min(last, now + count)   # a device that is started again counts from 0
            return now >= last
        self.until(are_drawn, f"frame {last}")

    def drawn_number(self):
        """The number of the frame that was drawn last. At rest, a key without a meaning asks for more frames."""
        now = time.monotonic()
        number = self.frame()["frame"]
        if number != self.last_seen[0]:
            self.last_seen = number, now
        elif now - self.last_seen[1] > 0.2:
            self.last_seen = number, now
            self.do("key", "Menu", pause_s=0)
        return number

    def see_picture(self):
        """Waits for the picture that what was sent before leads to, with nothing left to be refined."""
        self.see_frames()
        self.until(lambda: self.frame()["sharp"], "sharp picture")

    def see_kept(self):
        """Waits for the picture that was led to, and until the journal holds the view: the window writes no more."""
        self.see_picture()

        def is_kept():
            self.drawn_number()
            return self.frame()["sharp"] and self.frame()["kept"]
        self.until(is_kept, "view in the journal")

    def probe_rests(self):
        """Waits until the probe has come to where the pointer leads it: its label stands still over three frames, of
        those that begin from now on."""
        first, places = self.frame()["frame"] + 2, {}

        def stands_still():
            self.drawn_number()
            frame = self.frame()
            if frame["frame"] >= first:
                places[frame["frame"]] = [seen["box"] for seen in frame["texts"]
                                          if seen["window"] == "##Background" and seen["text"].endswith(" deep")]
            last = list(places.values())[-3:]
            return len(last) == 3 and all(place and place == last[0] for place in last)
        self.until(stands_still, "probe at rest")

    def lead_probe(self, x, y):
        """Moves the pointer, and waits until the probe has followed it."""
        self.do("mousemove", x, y, pause_s=0)
        self.probe_rests()

    def open(self, path):
        """By the menu, as a user does."""
        self.click_on("File", "##MainMenuBar")
        self.click_on("Open...", "##Menu_00")
        self.see_at_rest("Hidden")
        self.do("key", "ctrl+a", "type", "--delay", 30, path, pause_s=0)
        self.see(str(path), "Open a volume")
        self.check_key("Enter", "open")

    def see_no_more(self, text, window=None):
        self.until(lambda: not self.seen(text, window), f"screen without '{text}'")

    def open_scan(self, session, *arguments, **others):
        self.view(session, *arguments, **others)
        self.until(lambda: self.frame()["sharp"] and self.rests(), "sharp picture")

    @staticmethod
    def stays(measure, seconds):
        before = measure()
        time.sleep(seconds)
        return measure() == before

    def rests(self):
        """No frame is drawn any more: the window has its size, and its panels their places."""
        before = time.monotonic()
        frame = self.frame()["frame"]
        self.until(lambda: self.frame()["frame"] > frame or time.monotonic() > before + 0.4, "frame")
        return self.frame()["frame"] == frame

    @staticmethod
    def middle_of(seen):
        x0, y0, x1, y1 = seen["box"]
        return round((x0 + x1) / 2), round((y0 + y1) / 2)

    def click_on(self, text, window=None, button=1):
        """With the mouse, where the words are; the pointer rests and the button is held for some frames, as by a
        hand."""
        x, y = self.middle_of(self.see_at_rest(text, window))
        self.do("mousemove", x - 2, y, "mousemove", x, y, pause_s=0)
        self.see_frames()   # headings of panels take a press only where the frame before had the pointer over them
        for step in ("mousedown", "mouseup"):
            before = self.frame()["frame"]
            self.do(step, button, pause_s=0)
            self.until(lambda: self.program.poll() is not None or self.frame()["frame"] > before, "a frame")

    def type_into(self, field, text, window="Export annotation"):
        """Into the field beside that word, which begins right of it, in place of what it holds."""
        x0, y0, x1, y1 = self.see_at_rest(field, window)["box"]
        others = [seen["box"] for seen in self.seen(window=window)]
        left = min(box[0] for box in others if box[0] > x1 and box[1] < y1 and box[3] > y0)
        self.do("mousemove", round(left) + 20, round((y0 + y1) / 2), "sleep", 0.1, "mousedown", 1, "sleep", 0.1,
                "mouseup", 1, pause_s=0.2)
        self.press("Ctrl+A")
        if str(text):
            self.do("type", "--delay", 40, "--", text, pause_s=0)
        else:
            self.press("BackSpace")

    def window_named(self, title):
        """The window's number, for xdotool. A search ends without an answer where another window goes away meanwhile."""
        return self.until(lambda: self.display.do("search", "--name", title), f"window named {title}").split()[-1]

    def pixels(self):
        """Width, height and rows of the screen."""
        return read_xwd(subprocess.run(["xwd", "-root", "-silent", "-display", self.display.name], capture_output=True,
                                       check=True).stdout)

    def wander(self, steps=40):
        """Over the panels, which are drawn anew for it."""
        x, y = WINDOW[0] - SIDE_PANEL // 2, WINDOW[1] // 2
        chain = [word for step in range(steps) for word in ("mousemove", x + step % 7, y + 3 * (step % 11), "sleep", 0.035)]
        self.do(*chain, pause_s=0)

    def write_fog(self):
        """A session of which a picture takes many seconds."""
        return self.write_session(
            camera="front", volume={"procedural": "fog", "size": [160, 160, 160]}, render={"step_voxels": 0.1},
            transfer_function={"points": [{"intensity": 0, "opacity": 0.0}, {"intensity": 255, "opacity": 0.01}]})

    def press(self, chord):
        """Held for a moment."""
        self.do("keydown", pressed(chord), "sleep", 0.03, "keyup", pressed(chord), pause_s=0)

    def select_all(self):
        """Of the text in the field that is typed into: Ctrl+A is held until a frame has seen it."""
        before = self.frame()["frame"]
        self.do("keydown", "ctrl+a", pause_s=0)
        self.until(lambda: self.frame()["frame"] > before + 1, "a frame with Ctrl+A")
        self.do("keyup", "ctrl+a", pause_s=0)

    def at_once(self, *commands):
        """All in one turn of the program, as beside a frame that takes longer than a hand: it stands still meanwhile."""
        self.program.send_signal(signal.SIGSTOP)
        try:
            self.do(*commands, pause_s=0)
        finally:
            self.program.send_signal(signal.SIGCONT)

    def unfold(self, panel, instead_of):
        """Folds the panel that only_panel() left open, and unfolds this one."""
        for each in (instead_of, panel):
            self.check_follows(lambda: self.click_on(PANELS[each], "Side panel"), "prefer")

    # ---- What was done

    def done(self, since=0):
        """The actions of the log from one on, without their times; it holds those alone that could be applied."""
        if not self.log.exists():
            return []
        lines = self.log.read_text().split("\n")[:-1]
        return [{key: value for key, value in json.loads(line).items() if key != "time"} for line in lines[since:]]

    def what_follows(self, cause, wanted, patience_s=PATIENCE_S):
        """Calls `cause`, and waits until one of the actions that it leads to is `wanted`; returns what was logged."""
        before = len(self.done())
        cause()
        end = time.monotonic() + patience_s
        while True:
            found = [in_short(action) for action in self.done(before)]
            if wanted in found or time.monotonic() > end or self.program.poll() is not None:
                return found
            time.sleep(0.02)

    def check_follows(self, cause, wanted):
        """Calls `cause`, which must lead to the action `wanted`."""
        found = self.what_follows(cause, wanted)
        self.assertIn(wanted, found, f"awaited for {PATIENCE_S} s, with the program ended: {self.program.poll()}")

    def check_key(self, chord, wanted):
        self.check_follows(lambda: self.press(chord), wanted)

    def press_first(self, chord, wanted):
        """Presses what prepares something else; what it prepares may be so already: then it leads to another action, or
        to none."""
        before = len(self.done())
        self.press(chord)
        last = self.frame()["frame"] + 3

        def is_answered():
            return wanted in map(in_short, self.done(before)) or self.drawn_number() >= last
        self.until(is_answered, f"answer to {chord}")

    def check_drag(self, begin, way, wanted):
        """From a place over others, with the left button; frames see the pointer at rest, the button held, and each
        place."""
        def drag():
            self.do("mousemove", *begin, pause_s=0)
            self.see_frames()
            self.do("mousedown", 1, pause_s=0)
            for place in way:
                self.see_frames()
                self.do("mousemove", *place, pause_s=0)
            self.see_frames()
            self.do("mouseup", 1, pause_s=0)
        self.check_follows(drag, wanted)

    def check_probe(self, x, y):
        """Puts the probe onto what is seen there."""
        self.check_follows(lambda: self.put_probe(x, y, pause_s=0), "probe_onto")

    def check_stroke(self, *places, **others):
        """Paints along these places by the key that paints."""
        self.check_follows(lambda: self.stroke(*places, pause_s=0, **others), "paint_here")

    def saved(self, session):
        """The session as the file has it once it was saved; something in it must have changed."""
        before = session.read_text()
        self.check_key("Ctrl+S", "save")
        self.until(lambda: session.read_text() != before, "saved session")
        return json.loads(session.read_text())
