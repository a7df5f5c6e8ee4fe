"""Every key of both sets, pressed on a real keyboard; test_view_keys.py presses one of each kind."""
import unittest

import test_view_keys


class AllKeys(test_view_keys.KeySet):
    def test_each_key_of_today_does_what_the_table_says(self):
        self.check_set("today", "modern")

    def test_each_key_of_the_thesis_does_what_the_table_says(self):
        self.check_set("thesis", "thesis")


if __name__ == "__main__":
    unittest.main()
