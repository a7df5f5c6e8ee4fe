"""The window of operations on groups, for tests that work in it."""
import json

from seen import Seen

OPERATIONS = "Operations on groups"


class Operating(Seen):
    def open_operations(self):
        self.click_on("Edit", "##MainMenuBar")
        self.click_on("Operations on groups...", "##Menu_00")
        self.see("gives a group all voxels within a distance of it", OPERATIONS)

    def choose_operation(self, title):
        """In the window of operations, which shows Grow."""
        self.open_operations()
        self.click_on("Grow", OPERATIONS)
        self.click_on(title, "##Combo_00")

    def painted_scan(self):
        self.open_scan(self.write_ball(), preferences={"hints_seen": 3})
        x, y = self.middle()
        self.check_probe(x, y)
        self.check_stroke((x, y), (x + 20, y))
        self.see("Painted ", "Status")
        return x, y

    def click_right_of(self, row):
        """In the field of a row, which begins nine letters' heights right of its name."""
        word = self.until(lambda: next((seen for seen in self.seen(window=OPERATIONS) if seen["text"].startswith(row)),
                                       None), f"row {row}")
        self.do("mousemove", word["box"][0] + 9 * 14 + 60, self.middle_of(word)[1], pause_s=0)
        self.see_frames()
        for step in ("mousedown", "mouseup"):
            self.do(step, 1, pause_s=0)
            self.see_frames(1)

    def see_among(self, text):
        """A number that is close to other words, with which it is one text on the screen."""
        return self.until(lambda: any(text in seen["text"] for seen in self.seen(window=OPERATIONS)), f"'{text}'")

    def choose_of(self, row, present, wanted):
        """In a list, from the words of its row."""
        self.see_at_rest(row, OPERATIONS)
        self.click_right_of(row)
        self.see(wanted, "##Combo_00")
        self.click_on(wanted, "##Combo_00")

    def previewed(self):
        """The operation that was previewed last."""
        lines = [line for line in self.done() if line["op"] == "preview_operation" and "operation" in line]
        return json.loads(lines[-1]["operation"])
