"""Every call of every entry point fails once in each work, with each of its errors."""
import unittest

import test_faults


class EveryFault(test_faults.Faults):
    numbers = staticmethod(test_faults.all_numbers)

    def tries(self, name, call, error):
        return True


if __name__ == "__main__":
    unittest.main(defaultTest="EveryFault")
