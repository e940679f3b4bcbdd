import unittest

import numpy as np

from pipelines.povray.crops import Crop, cover


class Cover(unittest.TestCase):
    def test_nothing_one_pixel_everything(self):
        grid = np.zeros((9, 16), int)
        self.assertEqual(cover(grid, 10), [])
        grid[3, 5] = 4
        self.assertEqual(cover(grid, 10), [(Crop(5, 3, 6, 4), 4)])
        self.assertEqual(cover(np.full((9, 16), 2), 10), [(Crop(0, 0, 16, 9), 2)])

    def test_every_pixel_gets_its_grid_and_cuts_are_made_where_they_save_subpixels(self):
        grid = np.zeros((40, 60), int)
        grid[:5, :5] = 4
        grid[30:, 50:] = 2
        grid[32, 52] = 8
        crops = cover(grid, 20)
        given = np.zeros(grid.shape, int)
        for crop, n in crops:
            self.assertEqual(given[crop.y0 : crop.y1, crop.x0 : crop.x1].max(), 0)
            given[crop.y0 : crop.y1, crop.x0 : crop.x1] = n
        self.assertTrue((given >= grid).all())
        self.assertLess((given**2).sum(), 25 * 16 + 100 * 4 + 12 * 64)
        self.assertGreater(len(crops), 2)
        self.assertEqual(len(cover(grid, 1e9)), 1)


if __name__ == "__main__":
    unittest.main()
