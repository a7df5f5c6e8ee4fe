"""Panels on what the workbench knows, by real keys: the palette, and keys that are changed."""
import json
import unittest
from pathlib import Path

from harness import ENVIRONMENT
from test_view import Window

DAB = {"op": "paint", "brush": "fill", "region": "ball", "path": [[32, 32, 32]], "radius": 5, "threshold": 0, "group": 3}


class Panels(Window):
    def view(self, session, log):
        self.start(session, "--log", log)
        self.wait_for_window("sphere.* - SHVR")
        self.do("mousemove", *self.middle())

    def type_in_palette(self, text, *keys):
        self.do("key", "ctrl+shift+p", pause_s=1)
        self.do("type", "--delay", 40, text, pause_s=1)
        for key in (*keys, "Return"):
            self.do("keydown", key, "sleep", 0.15, "keyup", key, pause_s=0.6)

    def actions(self, log):
        return [json.loads(line) for line in log.read_text().splitlines()]

    def test_the_palette_runs_what_is_typed_and_keys_are_changed(self):
        session, log = self.write_ball(), self.folder / "log.jsonl"
        preferences = Path(ENVIRONMENT["XDG_CONFIG_HOME"]) / "shvr" / "preferences.json"
        self.addCleanup(preferences.unlink, missing_ok=True)
        self.check("annotate", session, "--script",
                   self.write_script("s.jsonl", [DAB, {**DAB, "group": 4}, {**DAB, "group": 5}, {"op": "save"}]))
        self.view(session, log)
        self.type_in_palette("light.ambient=0.4")
        self.type_in_palette("undo count=2")
        self.type_in_palette("look_from camera=nowhere")  # refused when it is applied
        self.type_in_palette("keys mouse")                # by its name: the help window
        self.type_in_palette("await_key shortcut=shell")
        self.do("key", "ctrl+j", pause_s=0.6)             # its new key
        self.do("key", "ctrl+j", pause_s=0.6)             # which works
        self.type_in_palette("await_key shortcut=preview")
        self.do("key", "Escape", pause_s=0.6)             # stays as it is
        self.type_in_palette("await_key shortcut=overview")
        self.do("key", "Delete", pause_s=0.6)             # has no key any more
        self.type_in_palette("redo", "Down", "Up")
        report = self.finish()
        lines = self.actions(log)
        self.assertIn({"op": "set", "values": {"light": {"ambient": 0.4}}}, lines)
        self.assertIn({"op": "undo", "count": 2}, lines)
        self.assertNotIn("nowhere", log.read_text())
        self.assertIn("nowhere", "\n".join(report["messages"]))
        self.assertIn({"op": "show_help", "on": True}, lines)
        self.assertIn({"op": "bind_keys", "shortcut": "shell", "keys": "Ctrl+J"}, lines)
        self.assertIn({"op": "set", "values": {"probe": {"shell": True}}}, lines)
        kept = {name: entry.get("keys", "") for name, entry in json.loads(preferences.read_text())["keys"].items()}
        self.assertEqual(kept, {"overview": "", "shell": "Ctrl+J"})
        # The light is a step, so two are undone: it and the third dab.
        self.assertEqual((report["undoable"], report["redoable"]), (3, 1), report["messages"])


if __name__ == "__main__":
    unittest.main()
