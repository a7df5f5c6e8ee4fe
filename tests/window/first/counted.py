"""Counts clicks and keys until a task is done: a typed text, a drop and a click count as one each."""
from seen import Seen


class Counted(Seen):
    most = {}   # inputs, by task
    inputs = 0

    def click(self, text, window=None):
        self.click_on(text, window)
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
