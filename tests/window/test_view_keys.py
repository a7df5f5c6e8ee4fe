"""Every key of both sets, pressed: each must do what ui/workbench/bindings/KEYS.md says of it. What an action then
changes is the workbench's own test (tests/gpu/workbench/actions_test.cpp)."""
import json
import pathlib
import re
import time
import unittest

from test_view import Window

KEYS_FILE = pathlib.Path("ui/workbench/bindings/KEYS.md")
NAMES = {",": "comma", ".": "period", "/": "slash", "=": "equal", "-": "minus", "[": "bracketleft", "]": "bracketright",
         "PageUp": "Prior", "PageDown": "Next", "Space": "space", "Enter": "Return", "Esc": "Escape"}
# What must be done first, so that there is something to do: other shortcuts, by their id.
FIRST = {"undo": ["add_node"], "redo": ["add_node", "undo"], "deselect": ["add_node"], "delete_selected": ["add_node"],
         "select_segment": ["add_node"], "drag_node": ["add_node"], "link_nearest": ["add_node"]}


def rows():
    """[{id, does, today, thesis, action}], in order."""
    found = []
    for line in KEYS_FILE.read_text().splitlines():
        cells = [cell.strip() for cell in line.strip().strip("|").split(" | ")]
        if line.startswith("| `") and len(cells) == 5:
            found.append(dict(zip(["id", "does", "today", "thesis", "action"], [cells[0].strip("`"), *cells[1:]])))
    return found


def chords(cell):
    return cell.strip("`").split()


def pressed(chord):
    """As xdotool spells it."""
    *modifiers, key = re.split(r"\+(?=.)", chord)
    return "+".join([*(m.lower() for m in modifiers), NAMES.get(key, key.lower() if len(key) == 1 else key)])


class Keys(Window):
    # They end the test, or open what takes the keys; each has a test of its own.
    LEFT_OUT = {"quit", "open", "help", "messages", "palette", "full_screen", "preferences"}

    def press(self, chord, name):
        """Presses it; returns the actions that were logged meanwhile, in short as KEYS.md has them."""
        before = len(self.log.read_text().splitlines())
        self.do("keydown", pressed(chord), "sleep", 0.06, "keyup", pressed(chord), pause_s=0.1)
        for _ in range(40):
            lines = self.log.read_text().splitlines()[before:]
            found = [self.in_short(json.loads(line)) for line in lines]
            if name in found:
                break
            time.sleep(0.1)
        return found

    @staticmethod
    def in_short(action):
        """"orbit", "set probe.brush": as KEYS.md."""
        def names(patch, prefix):
            for key, value in patch.items():
                if isinstance(value, dict) and value:
                    yield from names(value, f"{prefix}{key}.")
                else:
                    yield prefix + key
        if action["op"] != "set":
            return action["op"]
        return "set " + ", ".join(names(action["values"], ""))

    def check_set(self, column, key_set):
        session = self.write_ball()
        self.log = self.folder / "log.jsonl"
        configuration = self.folder / "configuration" / "shvr"
        configuration.mkdir(parents=True)
        (configuration / "preferences.json").write_text(json.dumps({"shvr_preferences": 1, "key_set": key_set}))
        self.start(session, "--log", self.log, environment={"XDG_CONFIG_HOME": configuration.parent})
        self.wait_for_window("sphere.* - SHVR")
        x, y = self.middle()
        self.do("mousemove", x, y, pause_s=0.5)
        table = {row["id"]: row for row in rows()}
        wrong = []
        for row in table.values():
            if row["id"] in self.LEFT_OUT:
                continue
            for chord in chords(row[column]):
                for first in FIRST.get(row["id"], []):
                    self.press(chords(table[first][column])[0], table[first]["action"])
                found = self.press(chord, row["action"])
                if row["action"] not in found:
                    wrong.append(f"{row['id']}: {chord} made {found}; expected {row['action']}")
        report = self.finish()
        self.assertEqual(wrong, [], report["messages"][-20:])

    def test_keys_of_today(self):
        self.check_set("today", "modern")

    def test_keys_of_the_thesis(self):
        self.check_set("thesis", "thesis")


if __name__ == "__main__":
    unittest.main()
