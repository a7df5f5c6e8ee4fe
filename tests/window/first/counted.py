"""Counts clicks and keys until a task is done: a typed text, a drop, a click and a double click count as one each."""
from seen import Seen


class Counted(Seen):
    most = {}   # inputs, by task
    inputs = 0

    def click(self, text, window=None):
        self.click_on(text, window)
        self.inputs += 1

    def double_click(self, text, window=None):
        x, y = self.middle_of(self.see_at_rest(text, window))
        self.do("mousemove", x - 2, y, "mousemove", x, y, pause_s=0)
        self.see_frames()
        self.do("click", "--repeat", 2, "--delay", 60, 1, pause_s=0)
        self.inputs += 1

    def key(self, chord):
        self.press(chord)
        self.inputs += 1

    def text(self, text, window):
        self.do("type", "--delay", 30, text, pause_s=0)
        self.see(str(text), window)
        self.inputs += 1

    def drop(self, source, files):
        source.drop(files, self.middle())
        self.inputs += 1

    def took(self, task):
        self.assertGreater(self.inputs, 0)
        self.assertLessEqual(self.inputs, self.most[task], task)
        print(f"{task}: {self.inputs} inputs")
        self.inputs = 0
