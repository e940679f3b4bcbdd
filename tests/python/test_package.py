"""The Python package: the bits of the program, arrays of every kind, errors, progress, threads."""

import _thread
import os
import pathlib
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import numpy as np
import polyrecon

PROGRAM = os.environ["POLYRECON"]
SAMPLES = pathlib.Path(os.environ["POLYRECON_SAMPLES"])
SMALL = SAMPLES / "study_small_0.exr"


class Folder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def assert_error(self, code, text, function, *arguments, **named):
        with self.assertRaises(polyrecon.Error) as raised:
            function(*arguments, **named)
        self.assertEqual(raised.exception.exit_code, code, raised.exception)
        self.assertIn(text, str(raised.exception))
        self.assertNotIn("\n", str(raised.exception))


class Denoise(Folder):
    @classmethod
    def setUpClass(cls):
        cls.render = polyrecon.read(SMALL)
        cls.draft = polyrecon.denoise(cls.render, quality="draft")

    def by_program(self, *options, noisy=SMALL):
        clean = self.folder / "clean.exr"
        subprocess.run([PROGRAM, "denoise", "-q", "-i", noisy, "-o", clean, *options], check=True)
        return polyrecon.read(clean)["beauty"]

    def test_the_result_is_that_of_the_program(self):
        merged = self.folder / "merged.exr"  # floats, as a file of half floats would round the result
        render = polyrecon.merge(sorted(SAMPLES.glob("study_small_*.exr"))[:2], merged)
        np.testing.assert_array_equal(polyrecon.denoise(render).image, self.by_program(noisy=merged))

    def test_the_written_file_is_that_of_the_program(self):
        ours = self.folder / "ours.exr"
        polyrecon.write(ours, self.draft, like=SMALL)
        expected = self.by_program("--quality", "draft")
        np.testing.assert_array_equal(polyrecon.read(ours)["beauty"], expected)
        compared = ["/usr/bin/oiiotool", "-a", "--fail", "0", ours, self.folder / "clean.exr", "--diff"]
        self.assertEqual(subprocess.run(compared, capture_output=True).returncode, 0)

    def test_arrays_of_any_layout_give_the_same_bits(self):
        def same(name, array):
            got = polyrecon.denoise({**self.render, name: array}, quality="draft").image
            np.testing.assert_array_equal(got, self.draft.image)

        beauty = self.render["beauty"]
        same("beauty", np.asfortranarray(beauty))
        same("beauty", beauty[::-1, ::-1].copy()[::-1, ::-1])
        same("beauty", beauty.astype(np.float64))
        same("beauty", beauty.astype(">f4"))
        padded = np.zeros((*beauty.shape[:2], 5), np.float32)
        padded[:, :, 1:4] = beauty
        same("beauty", padded[:, :, 1:4])
        frozen = beauty.copy()
        frozen.flags.writeable = False
        same("beauty", frozen)
        same("depth", self.render["depth"][:, :, np.newaxis])

    def test_half_floats_and_repeated_arrays_are_taken(self):
        beauty = self.render["beauty"].astype(np.float16)
        grey = np.broadcast_to(np.float32(0.5), beauty.shape)
        clean = polyrecon.denoise(beauty, grey, quality="draft")
        rounded = polyrecon.denoise(beauty.astype(np.float32), np.full(beauty.shape, 0.5, np.float32), quality="draft")
        np.testing.assert_array_equal(clean.image, rounded.image)

    def test_arguments_are_the_passes_of_their_names(self):
        named = {name: self.render[name] for name in ("beauty", "albedo", "normal", "depth")}
        by_name = polyrecon.denoise(named, quality="draft")
        noisy, albedo, normal, depth = named.values()
        by_place = polyrecon.denoise(noisy, albedo, normal, depth, quality="draft")
        np.testing.assert_array_equal(by_name.image, by_place.image)
        half = noisy * np.float32(1.1)
        pair = (half, 2 * noisy - half)
        with_halves = polyrecon.denoise(noisy, albedo, halves=pair, quality="draft")
        self.assertEqual(with_halves.report["variance_source"], "from the half buffers")
        with_variance = polyrecon.denoise(noisy, variance={"beauty": 0.01 * noisy**2}, quality="draft")
        self.assertEqual(with_variance.report["variance_source"], "from the file")

    def test_what_comes_out(self):
        height, width = self.render["beauty"].shape[:2]
        for name, shape in {"image": (height, width, 3), "mse": (height, width, 3), "relmse": (height, width)}.items():
            array = getattr(self.draft, name)
            self.assertEqual((array.shape, array.dtype), (shape, np.float32))
            self.assertTrue(np.isfinite(array).all())
        estimated = self.draft.report["estimated_relmse"]
        self.assertAlmostEqual(float(self.draft.relmse.mean(dtype=np.float64)), estimated, delta=1e-5 * estimated)
        self.assertIsNone(self.draft.samples)
        energy = self.render["beauty"].mean(dtype=np.float64)
        self.assertAlmostEqual(self.draft.image.mean(dtype=np.float64) / energy, 1, places=3)

    def test_further_layers_add_up(self):
        beauty = self.render["beauty"]
        part = (beauty * np.float32(0.25)).astype(np.float32)
        clean = polyrecon.denoise(beauty, aovs={"Diffuse": part, "Other": beauty - part}, quality="draft")
        total = clean.aovs["Diffuse"] + clean.aovs["Other"]
        np.testing.assert_allclose(total, clean.image, atol=2e-4, rtol=2e-3)

    def test_sample_maps(self):
        within = polyrecon.denoise(self.render, quality="draft", budget=16)
        alone = polyrecon.sample_map(within, budget=16, sample_count=self.render.get("sample-count"))
        np.testing.assert_array_equal(alone, within.samples)
        self.assertAlmostEqual(float(alone.mean()), 16, places=2)
        counts = self.render["sample-count"].astype(int)
        np.testing.assert_array_equal(polyrecon.sample_map(within, budget=16, sample_count=counts), alone)
        cost = np.ones_like(alone)
        cost[: len(cost) // 2] = 4
        dear = polyrecon.sample_map(within, budget=16, cost=cost)
        top = slice(None, len(cost) // 2)
        self.assertLess(dear[top].mean(), alone[top].mean())

    def test_mistakes(self):
        beauty = self.render["beauty"]
        self.assert_error(2, "type uint8; float16", polyrecon.denoise, (beauty * 255).astype(np.uint8))
        self.assert_error(2, "polyrecon.read", polyrecon.denoise, SMALL)
        self.assert_error(2, "is None", polyrecon.denoise, beauty, halves=(beauty, None))
        self.assert_error(2, "has a mask", polyrecon.denoise, np.ma.array(beauty))
        self.assert_error(2, "dimensions", polyrecon.denoise, beauty[0, 0])
        self.assert_error(2, "the beauty has", polyrecon.denoise, beauty, beauty[:10])
        self.assert_error(2, "quality 'superb'", polyrecon.denoise, beauty, quality="superb")
        self.assert_error(2, "no image 'beauty'", polyrecon.denoise, {"albedo": beauty})
        for halves in ((beauty,), beauty, 1):
            self.assert_error(2, "(A, B)", polyrecon.denoise, beauty, halves=halves)
        self.assert_error(2, "by name", polyrecon.denoise, beauty, aovs=[beauty])
        self.assert_error(2, "null character", polyrecon.denoise, beauty, aovs={"Dif\0fuse": beauty})
        for threads in (-1, 10**400, 1j):
            self.assert_error(2, "'threads'", polyrecon.denoise, beauty, threads=threads)
        self.assert_error(6, "no pixel is finite", polyrecon.denoise, np.full_like(beauty, np.nan))
        self.assert_error(33, "", polyrecon.denoise, beauty, max_memory=1000)
        self.assert_error(4, "missing.exr", polyrecon.read, self.folder / "missing.exr")
        self.assert_error(4, "Nothing", polyrecon.read, SMALL, aovs=["Nothing"])
        self.assert_error(5, "/dev/null", polyrecon.write, "/dev/null/x.exr", beauty)
        self.assert_error(2, ".exr", polyrecon.write, self.folder / "x.png", beauty)
        self.assert_error(2, "pixels", polyrecon.write, self.folder / "x.exr", beauty[:9], like=SMALL)
        self.assert_error(2, "budget", polyrecon.sample_map, self.draft)
        self.assert_error(2, "the result", polyrecon.sample_map, beauty, 4)
        self.assert_error(2, "path", polyrecon.read, None)
        for renders in (beauty, SMALL, str(SMALL), self.render):
            self.assert_error(2, "several are needed", polyrecon.merge, renders)
        self.assert_error(3, "renders[1]: does not fit renders[0]", polyrecon.merge, [beauty, beauty[:9]])
        self.assertEqual(list(self.folder.iterdir()), [])


class Progress(Folder):
    def setUp(self):
        super().setUp()
        self.render = polyrecon.read(SMALL)

    def test_progress_is_told_and_can_stop(self):
        seen = []
        polyrecon.denoise(self.render, quality="draft", progress=lambda phase, done: seen.append((phase, done)))
        self.assertIn("polynomials", {phase for phase, _ in seen})
        self.assertTrue(all(0 <= done <= 1 for _, done in seen))
        with self.assertRaises(polyrecon.StoppedError) as stopped:
            polyrecon.denoise(self.render, progress=lambda phase, done: phase != "polynomials")
        self.assertEqual(stopped.exception.exit_code, 130)

    def test_what_progress_raises_comes_out(self):
        def fail(phase, done):
            raise KeyError(phase)

        with self.assertRaises(KeyError):
            polyrecon.denoise(self.render, progress=fail)

    def test_ctrl_c_stops_the_work(self):
        def interrupt(phase, done):
            if phase == "polynomials":
                _thread.interrupt_main()

        with self.assertRaises(KeyboardInterrupt):
            polyrecon.denoise(self.render, quality="best", progress=interrupt)

    def test_after_ctrl_c_the_library_has_stopped(self):
        """One that works on would use memory that Python has freed. The third interrupt arrives while it stops."""
        script = """if True:
            import os, signal, sys, time, polyrecon
            render = polyrecon.read(sys.argv[1])

            def interrupt(phase, done):
                if phase == "polynomials":
                    for _ in range(3):
                        os.kill(os.getpid(), signal.SIGINT)
                        time.sleep(0.01)

            try:
                polyrecon.denoise(render, quality="best", progress=interrupt)
            except KeyboardInterrupt:
                time.sleep(1)
                print("interrupted")
        """
        done = subprocess.run([sys.executable, "-c", script, SMALL], capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stdout), (0, "interrupted\n"), done.stderr)

    def test_other_threads_go_on(self):
        """With the interpreter's lock held, the counter would stand still for the whole time."""
        counts, done = [0], threading.Event()

        def count():
            while not done.is_set():
                counts[0] += 1
                time.sleep(0.001)

        thread = threading.Thread(target=count)
        thread.start()
        begun = time.monotonic()
        polyrecon.denoise(self.render)
        seconds = time.monotonic() - begun
        done.set()
        thread.join()
        self.assertGreater(counts[0], 20 * seconds)

    def test_several_at_once(self):
        expected = polyrecon.denoise(self.render, quality="draft").image
        results = {}
        threads = [
            threading.Thread(target=lambda i=i: results.update({i: polyrecon.denoise(self.render, quality="draft")}))
            for i in range(3)
        ]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        for index in range(3):
            np.testing.assert_array_equal(results[index].image, expected)


class Files(Folder):
    def test_merged_arrays_are_merged_files(self):
        paths = sorted(SAMPLES.glob("study_small_*.exr"))[:4]
        merged = self.folder / "merged.exr"
        subprocess.run([PROGRAM, "merge", "-q", *paths, "--samples", "4", "-o", merged], check=True)
        by_program = polyrecon.read(merged)
        by_path = polyrecon.merge(paths, samples=4)
        by_array = polyrecon.merge([polyrecon.read(path)["beauty"] for path in paths], samples=4)
        for name in ("beauty", "beauty variance", "beauty A", "beauty B"):
            np.testing.assert_array_equal(by_path[name], by_program[name])
            np.testing.assert_array_equal(by_array[name], by_program[name])
        self.assertEqual(by_array.report["merge"]["samples"], 16)

    def test_passes_of_arrays_are_found_again(self):
        render = {name: array for name, array in polyrecon.read(SMALL).items() if name != "sample-count"}
        render = {name: array for name, array in render.items() if " " not in name}
        polyrecon.write(self.folder / "x.exr", render)
        again = polyrecon.read(self.folder / "x.exr")
        self.assertEqual(set(render), set(again))
        for name, array in render.items():
            np.testing.assert_array_equal(again[name], array)

    def test_a_result_is_written_with_its_maps(self):
        clean = polyrecon.denoise(polyrecon.read(SMALL), quality="draft")
        polyrecon.write(self.folder / "x.exr", clean)
        np.testing.assert_array_equal(polyrecon.read(self.folder / "x.exr")["beauty"], clean.image)

    def test_the_version_is_the_program_s(self):
        told = subprocess.run([PROGRAM, "--version"], capture_output=True, text=True, check=True).stdout.split()
        self.assertEqual(told, ["polyrecon", polyrecon.__version__])


if __name__ == "__main__":
    unittest.main()
