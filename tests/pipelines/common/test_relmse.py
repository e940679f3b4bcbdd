import json
import pathlib
import tempfile
import unittest

import numpy as np

from pipelines.common import exr
from pipelines.common.polyrecon_cli import Polyrecon
from tests.bench.relmse import relative_squares


class RelativeError(unittest.TestCase):
    def test_is_that_of_polyrecon_compare(self):
        random = np.random.default_rng(1)
        reference = random.exponential(0.3, (24, 32, 3)).astype(np.float32)
        image = (reference * random.normal(1, 0.2, reference.shape)).astype(np.float32)
        variance = (0.01 * reference**2).astype(np.float32)
        with tempfile.TemporaryDirectory() as folder:
            paths = [str(pathlib.Path(folder, name)) for name in ("image.exr", "reference.exr")]
            exr.write(paths[0], {f"Combined.{c}": image[..., k] for k, c in enumerate("RGB")})
            layers = {"Combined": reference, "Combined Variance": variance}
            exr.write(paths[1], {f"{n}.{c}": a[..., k] for n, a in layers.items() for k, c in enumerate("RGB")})
            found = json.loads(Polyrecon().run("compare", *paths, "--json"))
        expected = relative_squares(image.astype(float), reference.astype(float), variance.astype(float)).mean()
        self.assertAlmostEqual(found["results"][0]["relMSE"] / expected, 1, places=5)
