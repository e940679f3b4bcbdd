"""Types of command line arguments."""

import argparse


def positive(word):
    value = float(word)
    if not 0 < value < float("inf"):
        raise argparse.ArgumentTypeError(f"{word}: not above 0")
    return value
