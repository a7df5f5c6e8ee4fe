"""All photographs of test_view_photographs.py: every panel, dialog and menu in both themes, at both scales."""
import os
import unittest

os.environ["SHVR_ALL_PHOTOGRAPHS"] = "1"
from test_view_photographs import *  # noqa: E402,F401,F403: what it skips otherwise

if __name__ == "__main__":
    unittest.main()
