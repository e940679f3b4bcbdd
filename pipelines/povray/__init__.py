"""POV-Ray behind the loop's interface, and its passes: see README.md."""
