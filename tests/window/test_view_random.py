"""Things done at random by real keys and mouse, under validation: no message, no crash, and what is there at the end is
what the log replays to without a window. SHVR_SLOW=1 does 200, SHVR_SEED chooses others; where it fails, the log stays
beside the program."""
import json
import math
import os
import random
import shutil
import subprocess
import unittest
from pathlib import Path

from harness import ENVIRONMENT, SHVR
from seen import Seen, pressed, shortcut_rows
from window import PATIENCE_S, SIDE_PANEL

EVENTS = 200 if os.environ.get("SHVR_SLOW") == "1" else 40
SIZE = (680, 420)   # small, since replaying draws it for every action
# They ask for files, leave the window, cover the picture or take long; each has a test of its own.
LEFT_OUT = {"quit", "open", "palette", "full_screen", "large_screenshot", "screenshot", "focus_menu", "focus_panels",
            "help", "preferences", "side_panels", "save_as", "load_annotation", "import_scan", "export_work"}


class Random(Seen):
    def hand(self, seed):
        """Events, one after the other: what xdotool is to do."""
        dice = random.Random(seed)
        chords = [row["today"].split()[0] for row in shortcut_rows() if row["today"] and row["id"] not in LEFT_OUT]
        # The most frequent actions of users.
        often = ["N", "Ctrl+Z", "Ctrl+Y", "Alt+2", "Alt+3", "Alt+4", "Alt+5", "Alt+1", "Escape", "F6", "F10", "."]
        middle_x, middle_y = self.middle_of_picture()

        def in_picture():
            return middle_x + dice.randint(-80, 80), middle_y + dice.randint(-90, 90)

        def way(places, button, modifier=None):
            events = ["mousemove", *places[0], *(["keydown", modifier] if modifier else []), "mousedown", button]
            for place in places[1:]:
                events += ["mousemove", *place, "sleep", 0.02]
            return [*events, "mouseup", button, *(["keyup", modifier] if modifier else [])]

        for _ in range(EVENTS):
            kind = dice.randrange(20)
            if kind < 6:
                chord = pressed(dice.choice(chords))
                yield ["mousemove", *in_picture(), "keydown", chord, "sleep", 0.05, "keyup", chord]
            elif kind < 9:
                chord = pressed(dice.choice(often))
                yield ["mousemove", *in_picture(), "key", chord]
            elif kind < 14:
                x, y = in_picture()
                places = [(x, y)] + [(x + dice.randint(-20, 20) * i, y + dice.randint(-20, 20) * i) for i in (1, 2, 3)]
                yield way(places, dice.choice([1, 1, 1, 2, 3]), dice.choice([None, None, None, "alt", "shift", "ctrl"]))
            elif kind < 15:
                yield ["mousemove", *in_picture(), "click", "--repeat", 2, "--delay", 60, 1]
            elif kind < 17:
                yield ["mousemove", *in_picture(), "click", "--repeat", dice.randint(1, 4), "--delay", 30,
                       dice.choice([4, 5])]
            else:   # in the panels at the side
                x, y = SIZE[0] - dice.randint(40, SIDE_PANEL - 80), dice.randint(80, SIZE[1] - 60)
                # A field that was clicked would take the keys.
                if kind == 17:
                    yield ["mousemove", x, y, "sleep", 0.05, "click", dice.choice([4, 5])]
                elif kind == 18:
                    yield ["mousemove", x, y, "sleep", 0.05, "mousedown", 1, "sleep", 0.03, "mouseup", 1,
                           "sleep", 0.1, "key", "Escape"]
                else:
                    yield [*way([(x, y), (x + dice.randint(-60, 60), y)], 1), "sleep", 0.1, "key", "Escape"]

    @staticmethod
    def middle_of_picture():
        return (SIZE[0] - SIDE_PANEL) // 2, SIZE[1] // 2

    def test_what_was_done_at_random_is_replayed_to_the_same_end(self):
        seed = int(os.environ.get("SHVR_SEED", "18"))
        session = self.write_ball(volume={"procedural": "sphere", "size": [40, 40, 40]},
                                  probe={"radius_voxels": 3, "group": 3, "paint_threshold": 120})
        again = self.folder / "again" / session.name
        again.parent.mkdir()
        shutil.copy(session, again)
        self.open_scan(session, "--size", f"{SIZE[0]}x{SIZE[1]}", preferences={"hints_seen": 3})
        kept = Path(SHVR).resolve().parent / f"random-{seed}.jsonl"
        try:
            for event in self.hand(seed):
                self.do(*event, pause_s=0.02)
                self.assertIsNone(self.program.poll(), "the program has ended")
            self.check_end(session, again)
        except BaseException:
            shutil.copy(self.log, kept)
            if (self.folder / "said.txt").exists():
                shutil.copy(self.folder / "said.txt", kept.with_suffix(".txt"))
            print(f"the log is kept as {kept}")
            raise

    def probe_has_arrived(self):
        """Two keys without an effect log the probe at one place, or not at all where it does not follow the pointer."""
        for _ in range(2):
            self.press("Escape")
            self.see_frames()
        last = self.done()[-4:]
        places = [action["voxel"] for action in last if action["op"] == "place_probe"]
        return all(action["op"] == "set" for action in last) or (len(places) == 2 and math.dist(*places) < 1e-9)

    def replay(self, session, script):
        """What the command line reports; each action draws a picture, which on a busy machine takes a second."""
        done = subprocess.run([SHVR, "annotate", session, "--actions", script, "--json"], capture_output=True, text=True,
                              timeout=8 * PATIENCE_S, env=ENVIRONMENT, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(done.stdout)

    def check_end(self, session, again):
        self.do("mousemove", *self.middle_of_picture(), "key", "Escape", "key", "Escape", pause_s=0)
        self.until(self.probe_has_arrived, "probe at rest")
        report = self.finish()
        said = self.folder / "said.txt"
        said.write_text("\n".join(report["messages"]))
        lines = [json.dumps(action) for action in self.done() if action["op"] != "quit"]
        self.assertGreater(len(lines), EVENTS)
        script = self.folder / "again.jsonl"
        script.write_text("\n".join([*lines, '{"op":"save"}']) + "\n")
        replayed = self.replay(again, script)
        self.assertEqual(replayed["voxels_in_group"], report["voxels_in_group"])
        self.assertEqual(replayed["undoable"], report["undoable"])
        for name in ("paint.mask", "paint.graphml"):
            here, there = session.parent / name, again.parent / name
            self.assertEqual(here.exists(), there.exists(), name)
            if here.exists():
                self.assertEqual(here.read_bytes(), there.read_bytes(), name)
        kept, replayed_session = json.loads(session.read_text()), json.loads(again.read_text())
        # The servo still moves the probe by a last bit between the log's last place and the save.
        self.assertLess(math.dist(kept["probe"].pop("voxel"), replayed_session["probe"].pop("voxel")), 1e-6)
        self.assertEqual(kept, replayed_session)


if __name__ == "__main__":
    unittest.main()
