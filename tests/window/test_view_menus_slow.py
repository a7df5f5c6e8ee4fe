"""Every entry of every menu, chosen with the mouse; test_view_menus.py chooses one of each kind."""
import unittest

import test_view_menus


class AllMenus(test_view_menus.MenuWalk):
    def check(self, title):
        self.open_window()
        self.check_menu(title, chooses_all=True)
        self.finish()


for menu, _ in test_view_menus.MENUS:
    setattr(AllMenus, f"test_{menu.lower()}", lambda self, title=menu: self.check(title))

if __name__ == "__main__":
    unittest.main()
