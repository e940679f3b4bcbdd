import argparse
import contextlib
import io
import unittest

from pipelines.loop import command


class FirstPass(unittest.TestCase):
    def parse(self, *words):
        parser = argparse.ArgumentParser()
        command.add_loop_arguments(parser, 8, "samples of the first pass")
        options = parser.parse_args(words)
        command.check_budget(parser, options)
        return options

    def refused(self, *words):
        """The message about words that end with exit code 2."""
        errors = io.StringIO()
        with contextlib.redirect_stderr(errors), self.assertRaises(SystemExit) as caught:
            self.parse(*words)
        self.assertEqual(caught.exception.code, 2)
        return errors.getvalue()

    def test_it_has_two_samples_for_each_half_or_more(self):
        for number in (-8, -1, 0, 1, 2, 3, 5, 33):
            said = self.refused("--budget-spp", "64", "--first-pass", str(number))
            self.assertIn(f"--first-pass {number}: must be an even number from 4 on", said)
        for number in (4, 6, 64):
            self.assertEqual(self.parse("--target", "0.1", "--first-pass", str(number)).first_pass, number)

    def test_a_budget_holds_the_first_pass(self):
        self.assertIn("--budget-spp 7 is less than --first-pass 8", self.refused("--budget-spp", "7"))


if __name__ == "__main__":
    unittest.main()
