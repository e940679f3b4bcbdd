"""Tests that take long and assert what shorter ones assert of something similar."""

import os
import unittest

long_test = unittest.skipUnless("POLYRECON_LONG_TESTS" in os.environ, "long: set POLYRECON_LONG_TESTS")
