"""The window's choice of quality is the command line's: the names that it lists, and what each sets, chosen by the mouse
in the panel and drawn by `shvr render` beside `--set render.quality=NAME`."""
import json
import re
import unittest

from seen import Seen, only_panel


def merged(patch, onto):
    """As a merge patch has it: null takes a key away, which then is as it ships."""
    for key, value in patch.items():
        if value is None:
            onto.pop(key, None)
        elif isinstance(value, dict):
            onto[key] = merged(value, dict(onto.get(key, {})))
        else:
            onto[key] = value
    return onto


class Quality(Seen):
    def names_of_command_line(self, session):
        """From the sentence about a quality that there is not."""
        refused = self.check_refused("info", session, "--set", "render.quality=best", says=["render.quality"])
        return re.findall(r'"(\w+)"', refused.split("expected")[1])

    def drawn(self, session, settings, name):
        """Counters and the picture's bytes."""
        output = self.folder / name
        told = self.check_json("render", session, "-o", output, "--size", "64x48",
                               *(word for setting in settings for word in ("--set", setting)))
        return told["counters"], output.read_bytes()

    def listed(self, name):
        """Its line in the opened list, which is drawn last."""
        return [seen for seen in self.seen(name) if seen["text"] == name and "Combo" in seen["window"]]

    def test_each_quality_sets_what_the_command_line_sets(self):
        session = self.write_ball()
        names = self.names_of_command_line(session)
        self.assertEqual(names, ["draft", "interactive", "good", "reference"])
        self.open_scan(session, preferences=only_panel("quality"))
        self.see("Quality")
        shown, render, pictures = "interactive", {}, {}
        for name in [*names, "draft"]:  # at last from the most exact to the fastest: every key comes back
            begun = len(self.done())
            _, top, right, _ = next(seen for seen in self.seen("Quality") if seen["text"] == "Quality")["box"]
            on_row = [seen for seen in self.seen(shown) if abs(seen["box"][1] - top) < 4 and seen["box"][0] > right]
            x, y = self.middle_of(on_row[-1])
            self.do("mousemove", x, y, pause_s=0.2)
            self.do("click", 1, pause_s=0.3)
            self.until(lambda: all(self.listed(each) for each in names), "list of qualities")
            x, y = self.middle_of(self.listed(name)[-1])
            self.do("mousemove", x, y, pause_s=0.2)
            self.do("click", 1, pause_s=0.3)
            if name != shown:
                self.until(lambda: len(self.done()) > begun, f"choice of {name}")
            for action in self.done(begun):
                self.assertEqual(action["op"], "set")
                self.assertEqual(list(action["values"]), ["render"])
                render = merged(action["values"]["render"], render)
            shown = name
            settings = [f"render.{key}={json.dumps(value)}" for key, value in render.items()]
            of_window = self.drawn(session, settings, "window.png")
            self.assertEqual(of_window, self.drawn(session, [f"render.quality={name}"], "command.png"), (name, settings))
            pictures[name] = of_window
        # They are four: no two take the same samples.
        self.assertEqual(len({counters["samples"] for counters, _ in pictures.values()}), 4)
        self.finish()


if __name__ == "__main__":
    unittest.main()
