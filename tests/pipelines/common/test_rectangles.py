import unittest

import numpy as np

from pipelines.common.rectangles import area, bounding_box, cover, level

SIZE = (180, 320)
# Costs of the rectangles of two earlier planners, of which Blender's driver had one and POV-Ray's the other, on these
# maps: {map: [(overhead, cost of level rectangles, cost of covering rectangles with four times the overhead)]}.
FORMER_COSTS = {
    "waves": [(1000, 360968, 7289092), (10000, 740841, 7569200)],
    "blobs": [(1000, 169639, 4543896), (10000, 407144, 4986656)],
    "spots": [(1000, 112532, 119274), (10000, 430105, 467624)],
    "ramp": [(1000, 65336, 1365700), (10000, 129206, 1588020)],
}


def maps():
    """Counts as sample maps have them: {name: counts[y, x]}, each 0 or a power of two."""
    random = np.random.default_rng(1)
    y, x = np.mgrid[: SIZE[0], : SIZE[1]]
    waves = 3 + 2.5 * np.sin(x / 11) * np.cos(y / 17) + random.normal(0, 0.5, SIZE)
    blobs = sum(
        strength * np.exp(-((x - centre_x) ** 2 + (y - centre_y) ** 2) / 2 / radius**2)
        for strength, centre_x, centre_y, radius in random.uniform((5, 0, 0, 6), (100, 320, 180, 48), (8, 4))
    )
    spots = np.full(SIZE, -1.0)
    for left, top, width, height, exponent in random.integers((0, 0, 2, 2, 0), (300, 160, 30, 30, 7), (12, 5)):
        spots[top : top + height, left : left + width] = exponent
    ramp = 6 * x / SIZE[1] + random.normal(0, 0.2, SIZE)
    exponents = {"waves": waves, "blobs": np.log2(blobs), "spots": spots, "ramp": ramp}
    return {name: np.where(found < -0.5, 0, 2.0 ** np.rint(found)) for name, found in exponents.items()}


def times_held(boxes, shape):
    held = np.zeros(shape, int)
    for x0, y0, x1, y1 in boxes:
        held[y0:y1, x0:x1] += 1
    return held


def cover_cost(grid, boxes, overhead):
    return sum(area(box) * part_of(grid, box).max() ** 2 + overhead for box in boxes)


def level_cost(counts, boxes, overhead):
    """The cost by the definition in level's docstring, pixel by pixel."""
    cost = 0.0
    for box in boxes:
        found = part_of(counts, box)
        cost += overhead + ((found**2).sum() / found.mean() - found.sum() if found.any() else 0)
    return cost


def part_of(values, box):
    x0, y0, x1, y1 = box
    return values[y0:y1, x0:x1]


class BoundingBox(unittest.TestCase):
    def test_around_all_and_within_a_box(self):
        inside = np.zeros((6, 9), bool)
        self.assertIsNone(bounding_box(inside))
        inside[1, 2] = inside[4, 7] = True
        self.assertEqual(bounding_box(inside), (2, 1, 8, 5))
        self.assertEqual(bounding_box(inside, (3, 0, 9, 6)), (7, 4, 8, 5))
        self.assertIsNone(bounding_box(inside, (3, 0, 7, 6)))


class Cover(unittest.TestCase):
    def test_nothing_one_pixel_everything(self):
        grid = np.zeros((9, 16), int)
        self.assertEqual(cover(grid, np.square, 10), [])
        grid[3, 5] = 4
        self.assertEqual(cover(grid, np.square, 10), [(5, 3, 6, 4)])
        self.assertEqual(cover(np.full((9, 16), 2), np.square, 10), [(0, 0, 16, 9)])

    def test_random_maps_are_covered_by_disjoint_bounding_boxes(self):
        random = np.random.default_rng(3)
        for _ in range(30):
            grid = random.integers(0, 4, size=random.integers(1, 30, 2)) * (random.random() < 0.9)
            grid = grid * (random.random(grid.shape) < random.random())
            boxes = cover(grid, np.square, 5)
            held = times_held(boxes, grid.shape)
            self.assertLessEqual(held.max(initial=0), 1)
            self.assertTrue((held[grid > 0] == 1).all())
            for box in boxes:
                self.assertEqual(bounding_box(grid > 0, box), box)
            self.assertLessEqual(cover_cost(grid, boxes, 5), grid.size * int(grid.max()) ** 2 + 5)

    def test_a_cut_that_pays_only_with_the_next_ones_is_found(self):
        """Four squares like a chessboard's: either part of the first cut still has the largest value."""
        grid = np.kron([[8, 1], [1, 8]], np.ones((15, 15), int))
        self.assertEqual(len(cover(grid, np.square, 5000)), 4)
        self.assertEqual(len(cover(grid, np.square, 10000)), 1)

    def test_noise_does_not_exhaust_the_stack(self):
        grid = np.random.default_rng(4).integers(0, 64, (1500, 3))
        self.assertGreaterEqual(len(cover(grid, np.square, 1)), 1)


class Level(unittest.TestCase):
    def test_even_counts_are_one_rectangle(self):
        self.assertEqual(level(np.full((60, 80), 4), 100), [(0, 0, 80, 60)])
        self.assertEqual(level(np.zeros((60, 80)), 100), [(0, 0, 80, 60)])

    def test_two_halves_are_two_rectangles_if_the_overhead_is_low(self):
        counts = np.full((60, 80), 1)
        counts[:, 40:] = 32
        self.assertEqual(sorted(level(counts, 100)), [(0, 0, 40, 60), (40, 0, 80, 60)])
        self.assertEqual(len(level(counts, 1e9)), 1)
        self.assertEqual(sorted(level(counts.T, 100)), [(0, 0, 60, 40), (0, 40, 60, 80)])

    def test_rectangles_fill_the_frame(self):
        for counts in maps().values():
            self.assertTrue((times_held(level(counts, 300), counts.shape) == 1).all())


class NoWorseThanTwoPlanners(unittest.TestCase):
    def test_costs(self):
        """A map costs at most 3 % more than with the earlier planners, and all maps together cost less."""
        former, shared = np.zeros(2), np.zeros(2)
        for name, counts in maps().items():
            grid = np.ceil(np.sqrt(counts))
            for overhead, former_level, former_cover in FORMER_COSTS[name]:
                costs = np.array(
                    [
                        level_cost(counts, level(counts, overhead), overhead),
                        cover_cost(grid, cover(grid, np.square, 4 * overhead), 4 * overhead),
                    ]
                )
                self.assertTrue((costs <= 1.03 * np.array([former_level, former_cover])).all(), (name, overhead, costs))
                former += former_level, former_cover
                shared += costs
        self.assertTrue((shared < former).all(), (shared, former))


if __name__ == "__main__":
    unittest.main()
