"""The version of the drivers. It is that of the program; tests/packaging/pip_test.py compares them."""

VERSION = "0.1.0"
