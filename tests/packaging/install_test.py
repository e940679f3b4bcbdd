#!/usr/bin/env python3
"""Uses what `cmake --install` and `cpack` make: install_test.py PROGRAM BUILD_FOLDER SAMPLES

run.sh in this folder also installs the Debian packages, in a fresh Debian.
"""

import gzip
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

PROGRAM, BUILD, SAMPLES = (pathlib.Path(word).resolve() for word in sys.argv[1:4])
MODULE = "polyrecon_pictures.so"
CONSUMER = pathlib.Path(__file__).resolve().parent / "consumer"
EXAMPLE = pathlib.Path(__file__).resolve().parents[2] / "docs" / "guide" / "examples" / "denoise.c"
INCLUDE = pathlib.Path(__file__).resolve().parents[2] / "include"


def run(*words):
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True)
    if done.returncode != 0:
        raise AssertionError(f"{' '.join(map(str, words))}: exit code {done.returncode}\n{done.stdout}\n{done.stderr}")
    return done.stdout


class Folder(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, self.folder)


class Install(Folder):
    def test_a_foreign_program_builds_against_the_installed_library(self):
        prefix, build = self.folder / "prefix", self.folder / "build"
        run("cmake", "--install", BUILD, "--prefix", prefix)
        for name in ("bin/polyrecon", "share/man/man1/polyrecon.1", "share/zsh/site-functions/_polyrecon"):
            self.assertTrue((prefix / name).is_file(), name)
        run("cmake", "-S", CONSUMER, "-B", build, "-G", "Ninja", f"-DCMAKE_PREFIX_PATH={prefix}")
        run("cmake", "--build", build)
        noisy, ours, theirs = SAMPLES / "study_small_0.exr", self.folder / "ours.exr", self.folder / "theirs.exr"
        run(prefix / "bin/polyrecon", "denoise", "-i", noisy, "-o", ours, "--quiet")
        run(build / "consumer", noisy, theirs)
        run("/usr/bin/oiiotool", "-a", "--fail", "0", "--hardfail", "0", ours, theirs, "--diff")
        self.assertGreater(
            float(re.search(r"relMSE (\S+)", run(PROGRAM, "compare", noisy, theirs)).group(1)), 1e-4, "nothing changed"
        )

    def test_programs_in_c_build_against_the_shared_library_alone(self):
        prefix = self.folder / "prefix"
        for component in ("runtime", "library"):
            run("cmake", "--install", BUILD, "--prefix", prefix, "--component", component)
        for archive in prefix.rglob("*.a"):
            archive.unlink()
        (pkg_config,) = prefix.rglob("polyrecon.pc")
        environment = {**os.environ, "PKG_CONFIG_PATH": str(pkg_config.parent)}
        words = ["pkg-config", "--cflags", "--libs", "polyrecon"]
        told = subprocess.run(words, env=environment, capture_output=True, text=True, check=True).stdout.split()
        rpath = f"-Wl,-rpath,{pkg_config.parents[1]}"
        run("cc", EXAMPLE, "-o", self.folder / "by_pkg_config", *told, rpath)
        build = self.folder / "build"
        run("cmake", "-S", CONSUMER / "c", "-B", build, "-G", "Ninja", f"-DCMAKE_PREFIX_PATH={prefix}")
        run("cmake", "--build", build)
        for name, program in {"a.exr": self.folder / "by_pkg_config", "b.exr": build / "consumer"}.items():
            run(program, SAMPLES / "study_small_0.exr", self.folder / name)
        run("/usr/bin/oiiotool", "-a", "--fail", "0", self.folder / "a.exr", self.folder / "b.exr", "--diff")

    def test_the_installed_headers_are_the_public_ones(self):
        run("cmake", "--install", BUILD, "--prefix", self.folder, "--component", "library")
        installed = {path.relative_to(self.folder / "include") for path in self.folder.glob("include/**/*.*")}
        public = {path.relative_to(INCLUDE) for path in INCLUDE.glob("polyrecon/*.h")}
        self.assertGreater(len(public), 10)
        self.assertEqual(installed, public)
        for header in public:
            text = (INCLUDE / header).read_text()
            self.assertRegex(
                text, r"\A// \w[^\n]+\.\n", f"{header} does not begin with a sentence that says what it is for"
            )
            named = {pathlib.Path(name) for name in re.findall(r"\w+(?:/\w+)+\.h\b", text)}
            self.assertLessEqual(named, public, f"{header} names headers that are not installed")

    def test_only_pictures_need_the_module_which_may_move_with_the_program(self):
        run("cmake", "--install", BUILD, "--prefix", self.folder / "first", "--component", "program")
        prefix = (self.folder / "first").rename(self.folder / "second")
        program, clean, picture = prefix / "bin/polyrecon", self.folder / "clean.exr", self.folder / "clean.png"
        run(program, "denoise", "-i", SAMPLES / "study_small_0.exr", "-o", clean, "--quality", "draft", "--quiet")
        for words, expected in ((["inspect", clean], False), (["preview", clean, "-o", picture], True)):
            debug = {**os.environ, "LD_DEBUG": "files"}
            loaded = subprocess.run([program, *words], env=debug, capture_output=True, text=True).stderr
            self.assertEqual("libOpenImageIO.so" in loaded, expected, words)
        (module,) = prefix.rglob(MODULE)
        # A signal handler removes the temporary files in the program's list; the module must not have another list.
        self.assertNotIn("remove_temporaries", run("nm", "--demangle", module))
        module.unlink()
        run(program, "inspect", clean)
        words = ["preview", clean, "-o", picture, "--overwrite"]
        without = subprocess.run([program, *words], capture_output=True, text=True)
        self.assertEqual(without.returncode, 4)
        self.assertRegex(without.stderr, rf"\Apolyrecon: .*{MODULE}.*\n\Z")


class DebianPackages(Folder):
    def setUp(self):
        super().setUp()
        run("cpack", "--config", BUILD / "CPackConfig.cmake", "-G", "DEB", "-B", self.folder)
        self.packages = {path.name.split("_")[0]: path for path in self.folder.glob("*.deb")}

    def unpacked(self):
        """The program and its module in the unpacked package."""
        run("dpkg-deb", "--extract", self.packages["polyrecon"], self.folder / "root")
        (module,) = (self.folder / "root").rglob(MODULE)
        return self.folder / "root/usr/bin/polyrecon", module

    def test_files_are_where_debian_expects_them(self):
        self.assertEqual(sorted(self.packages), ["libpolyrecon-dev", "libpolyrecon1", "polyrecon"])
        names = {}
        for package, path in self.packages.items():
            lines = [line.split(None, 5) for line in run("dpkg-deb", "--contents", path).splitlines()]
            names[package] = [line[5].lstrip(".") for line in lines]
            for line in lines:
                self.assertEqual(line[1], "root/root", line)
                if not line[0].startswith("l"):  # links have all rights
                    self.assertNotEqual(line[0][8], "w", line)
            for document in ("copyright", "changelog.gz"):
                self.assertIn(f"/usr/share/doc/{package}/{document}", names[package])
            self.assertIn("md5sums", run("dpkg-deb", "--ctrl-tarfile", path))
        self.assertLessEqual(
            {
                "/usr/bin/polyrecon",
                "/usr/share/man/man1/polyrecon.1.gz",
                "/usr/share/man/man1/polyrecon-denoise.1.gz",
                "/usr/share/bash-completion/completions/polyrecon",
                "/usr/share/zsh/vendor-completions/_polyrecon",
                "/usr/share/fish/vendor_completions.d/polyrecon.fish",
            },
            set(names["polyrecon"]),
        )
        self.assertTrue(any(name.endswith(f"/polyrecon/{MODULE}") for name in names["polyrecon"]), names["polyrecon"])
        library = names["libpolyrecon-dev"]
        self.assertIn("/usr/include/polyrecon/reconstruct.h", library)
        self.assertTrue(any(name.endswith("/libpolyrecon_core.a") for name in library), library)
        self.assertTrue(any(name.endswith("/polyreconConfig.cmake") for name in library), library)
        self.assertTrue(any(name.endswith("/pkgconfig/polyrecon.pc") for name in library), library)
        shared = names["libpolyrecon1"]
        self.assertTrue(any("/libpolyrecon.so.1 " in f"{name} " for name in shared), shared)
        files = [{name for name in names[package] if not name.endswith("/")} for package in names]
        self.assertEqual(sum(map(len, files)), len(set().union(*files)), "a file is in two packages")
        control = run("dpkg-deb", "--ctrl-tarfile", self.packages["libpolyrecon1"])
        self.assertIn("shlibs", control)
        self.assertIn("ldconfig", control)
        self.assertIn(" polyrecon_execute@POLYRECON_1.0 0.1.0\n", control)

    def test_dependencies_are_debian_packages_and_complete(self):
        depends = run("dpkg-deb", "--field", self.packages["polyrecon"], "Depends")
        for word in (
            "libc6",
            "libopenimageio",
            "libopenexr",
            "libopencolorio",
            "libtbb",
            "libfmt",
            "fonts-dejavu-core",
        ):
            self.assertIn(word, depends)
        # Every library that the program and its module load belongs to a package named there.
        needed = re.findall(r"NEEDED\)\s+Shared library: \[(\S+)\]", run("readelf", "--dynamic", *self.unpacked()))
        self.assertIn("libOpenImageIO.so", "".join(needed))
        for library in needed:
            owners = re.findall(r"^([\w.+-]+)(?::\w+)?: ", run("dpkg-query", "--search", f"*/{library}"), re.M)
            self.assertTrue(any(owner in depends for owner in owners), (library, owners, depends))

    def test_packed_program_and_pages_work(self):
        program, module = self.unpacked()
        self.assertEqual(run(program, "--version"), run(PROGRAM, "--version"))
        sections = run("readelf", "--sections", program, module)
        self.assertNotIn(".symtab", sections)
        self.assertNotIn(".comment", sections)
        run(program, "preview", SAMPLES / "study_small_0.exr", "-o", self.folder / "look.png")
        page = gzip.decompress((self.folder / "root/usr/share/man/man1/polyrecon.1.gz").read_bytes())
        self.assertIn(b"Exit codes", page)
        maintainer = run("dpkg-deb", "--field", self.packages["polyrecon"], "Maintainer").strip()
        changelog = gzip.decompress((self.folder / "root/usr/share/doc/polyrecon/changelog.gz").read_bytes())
        self.assertIn(f" -- {maintainer}  ", changelog.decode())


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
