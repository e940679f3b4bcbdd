"""Options of `polyrecon denoise` that drivers know. A test, tests/docs/test_command_line.py, compares the two."""

QUALITIES = ("draft", "standard", "best")  # --quality, from fast to accurate
DEFAULT_QUALITY = "standard"
DEFAULT_OUTPUTS = "input"
ON_MISS = ("keep", "fail")  # --on-miss, the default first
DEFAULT_FRAME_RADIUS = 2  # --frame-radius of a sequence
