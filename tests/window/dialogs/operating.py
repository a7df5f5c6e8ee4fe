"""The window of operations on groups, for tests that work in it."""
import json

from seen import Seen

OPERATIONS = "Operations on groups"


class Operating(Seen):
    def open_operations(self):
        self.click_on("Edit", "##MainMenuBar")
        self.click_on("Operations on groups...", "##Menu_00")
        self.see("gives a group all", OPERATIONS)

    def choose_operation(self, title):
        """In the window of operations, which shows Grow."""
        self.open_operations()
        self.click_on("Grow", OPERATIONS)
        self.click_on(title, "##Combo_00")

    def note(self, begin):
        """What the window says above its buttons, which begins so, with all of its lines."""
        def found():
            texts = [seen["text"] for seen in self.seen(window=OPERATIONS)]
            first = max((i for i, text in enumerate(texts) if text.startswith(begin)), default=len(texts))
            end = next((i for i in range(first, len(texts)) if texts[i].startswith("Apply")), first)
            return " ".join(texts[first:end])
        return self.until(found, f"'{begin}' above the buttons")

    def see_note(self, words):
        """Waits until the window has those words, on one line or more."""
        self.until(lambda: words in " ".join(seen["text"] for seen in self.seen(window=OPERATIONS)),
                   f"'{words}' in the window")

    @staticmethod
    def as_done(previewed):
        """The words of a preview, once it was carried out."""
        return previewed.replace(" would be ", " ").replace(",", "")

    def see_done(self, previewed):
        """Waits until the status bar says what was previewed; it has one line."""
        begin = self.as_done(previewed).split(";")[0]
        self.until(lambda: any(seen["text"].replace(",", "").startswith(begin) for seen in self.seen(window="Status")),
                   f"'{begin}' in the status bar")

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

    def previews(self):
        """The operations that were previewed, in order."""
        return [json.loads(line["operation"]) for line in self.done()
                if line["op"] == "preview_operation" and "operation" in line]

    def previewed(self):
        """The operation that was previewed last."""
        return self.previews()[-1]
