"""Starts the window on a virtual display (Xvfb), drives it by real key and mouse events (xdotool) and closes it."""
import json
import os
import subprocess
import time

from harness import ENVIRONMENT, SHVR, CliTest, read_png_header

PATIENCE_S = 60
WINDOW = (900, 600)
SIDE_PANEL = 350   # pixels, as it ships


class Display:
    """A separate virtual screen."""

    def __init__(self, size="1000x700"):
        read_end, write_end = os.pipe()
        self.server = subprocess.Popen(["Xvfb", "-noreset", "-displayfd", str(write_end), "-screen", "0", f"{size}x24"],
                                       pass_fds=[write_end], stderr=subprocess.DEVNULL)
        os.close(write_end)
        with os.fdopen(read_end) as told:
            self.name = ":" + told.readline().strip()

    def close(self):
        self.server.terminate()
        self.server.wait()

    def do(self, *arguments):
        """Runs one chain of xdotool commands; returns its output."""
        return subprocess.run(["xdotool", *map(str, arguments)], capture_output=True, text=True, timeout=PATIENCE_S,
                              env={**os.environ, "DISPLAY": self.name}).stdout


class Window(CliTest):
    """Starts the window, drives it and closes it."""

    @classmethod
    def setUpClass(cls):
        cls.display = Display()
        cls.addClassCleanup(cls.display.close)

    def start(self, *arguments, environment=None):
        self.program = subprocess.Popen(
            [SHVR, "view", *self.with_size([*map(str, arguments), "--json"])],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
            env={**ENVIRONMENT, "DISPLAY": self.display.name, **{k: str(v) for k, v in (environment or {}).items()}})
        self.addCleanup(self.program.kill)

    def with_keys(self, **keys):
        """The environment of a person who has given shortcuts those keys."""
        folder = self.folder / "configuration" / "shvr"
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "preferences.json").write_text(json.dumps(
            {"shvr_preferences": 1, "hints_seen": 3, "keys": {name: {"keys": chord} for name, chord in keys.items()}}))
        return {"XDG_CONFIG_HOME": folder.parent}

    @staticmethod
    def with_size(arguments):
        return arguments if "--size" in arguments else [*arguments, "--size", f"{WINDOW[0]}x{WINDOW[1]}"]

    def wait_for_window(self, title):
        end = time.monotonic() + PATIENCE_S
        while time.monotonic() < end and self.program.poll() is None:
            if self.display.do("search", "--name", title).strip():
                return
            time.sleep(0.1)
        self.fail(f"no window named {title}: {self.program.communicate(timeout=5)}")

    def do(self, *arguments, pause_s=0.3):
        self.display.do(*arguments)
        time.sleep(pause_s)

    def put_probe(self, x, y, *before, pause_s=0.7):
        """Onto what is seen there, by a double click; `before`: other commands, at that place."""
        self.do("mousemove", x, y, *before, "click", "--repeat", 2, "--delay", 60, 1, pause_s=pause_s)

    def stroke(self, *places, before_end=(), pause_s=1.0):
        """With the key that paints held down from the first place on; `before_end`: other commands before it goes up."""
        moves = [word for place in places[1:] for word in ("mousemove", *place)]
        self.do("mousemove", *places[0], "keydown", "f", *moves, *before_end, "keyup", "f", pause_s=pause_s)

    def wait_for_file(self, path):
        end = time.monotonic() + PATIENCE_S
        while not path.exists():
            self.assertLess(time.monotonic(), end, f"{path} is not written")
            time.sleep(0.05)

    def finish(self):
        """Closes the window by its key; returns the report. A validation message makes this fail."""
        self.do("key", "ctrl+q", pause_s=0)
        output, errors = self.program.communicate(timeout=PATIENCE_S)
        self.assertEqual(self.program.returncode, 0, errors)
        return json.loads(output)

    def open(self, path):
        """By the menu, as a user does."""
        for at in [(20, 10), (30, 32)]:   # File, Open...
            self.do("mousemove", *at, "sleep", 0.2, "mousedown", 1, "sleep", 0.2, "mouseup", 1, pause_s=0.5)
        self.do("type", "--delay", 30, path)
        self.do("keydown", "Return", "sleep", 0.2, "keyup", "Return", pause_s=2)

    def write_ball(self, **keys):
        return self.write_session(
            camera="front",
            transfer_function={"points": [{"intensity": 100, "color": "#c0a080", "opacity": 0.0},
                                          {"intensity": 160, "color": "#ffe0c0", "opacity": 0.9},
                                          {"intensity": 255, "color": "#ffffff", "opacity": 1.0}]},
            **{"volume": {"procedural": "sphere", "size": [64, 64, 64]},
               "probe": {"radius_voxels": 5, "group": 3, "paint_threshold": 120}, **keys})

    def middle(self):
        """Centre of the graphics window: left of the side panel, between menu and status bar."""
        return (WINDOW[0] - SIDE_PANEL) // 2, WINDOW[1] // 2

    def check_photograph(self, session, photograph):
        """The picture equals `shvr render` of the saved session, except for the probe's ball."""
        size = read_png_header(photograph)
        picture = self.folder / "render.png"
        self.check("render", session, "-o", picture, "--size", f"{size[0]}x{size[1]}")
        difference = self.check_json("compare", photograph, picture)
        self.assertLess(difference["fraction_over_1"], 0.03)
