"""Ten variants of each kind of attack that once succeeded, each with the exit codes that are right."""

import gzip
import json
import random
import resource
import struct

import numpy as np

from pipelines.common import exr
from tests.attacks import decoders, exr_bytes, seeds
from tests.attacks.exr_bytes import Attribute

NAME = "variants"
REFUSED = {2, 3, 4}
DRAFT = ["--quality", "draft", "--overwrite"]
PLAIN = ["denoise", "-i", "plain.exr", "-o", "o.exr", *DRAFT]
LONG = 300000


class Variant:
    """One attack: files to write, the command, the exit codes that are right, and what more must hold.

    check(program, outcome) returns what is wrong; before() runs in the child; meanwhile(process) while it works."""

    def __init__(self, what, files, arguments, codes, check=None, **run):
        self.what, self.files, self.arguments, self.codes = what, files, arguments, codes
        self.check, self.run = check, run


def tiff(entries, after=b"", magic=b"II*\0", following=0):
    """A TIFF with one directory of (tag, type, count, value)."""
    head = magic + struct.pack("<I", 8) + struct.pack("<H", len(entries))
    return head + b"".join(struct.pack("<HHII", *entry) for entry in entries) + struct.pack("<I", following) + after


def tiff_tags(width=8, height=8, compression=1, photometric=2, samples=3, bits=8, **more):
    tags = {256: width, 257: height, 258: bits, 259: compression, 262: photometric, 273: 200, 277: samples}
    tags.update({278: height, 279: width * height * samples * bits // 8 & 0xFFFFFFFF})
    tags.update({int(tag[1:]): value for tag, value in more.items()})
    return [(tag, 4, 1, value & 0xFFFFFFFF) for tag, value in sorted(tags.items())]


def names_of_formats(rng, folder):
    """Row 1: other formats and broken ones under the names of those that are read."""
    written = decoders.written(folder)
    whole = written["exr"]
    files = {
        "gzip.exr": gzip.compress(whole),
        "loop.tif": tiff(tiff_tags(), bytes(2000), following=8),
        "wide.tif": tiff(tiff_tags(width=2**31 - 1, height=2**31 - 1), bytes(2000)),
        "jpeg.tif": tiff(tiff_tags(compression=7), bytes(2000)),
        "fax.tif": tiff(tiff_tags(compression=4, samples=1, bits=1), rng.randbytes(2000)),
        "subdirectory.tif": tiff(tiff_tags(t330=8, t34665=8), bytes(2000)),
        "huge.pfm": b"PF\n2000000000 2000000000\n-1.0\n" + bytes(1000),
        "negative.pfm": b"PF\n-8 8\n-1.0\n" + bytes(1000),
        "huge.hdr": b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 200000000 +X 200000000\n" + bytes(1000),
        "jpeg.hdr": written["jpg"],
        "exr.tif": whole,
        "ico.pfm": written.get("ico", written["png"]),
    }
    for name, content in files.items():
        for arguments in (["inspect", name], ["preview", name, "-o", "o.png", "--overwrite"]):
            codes = {*REFUSED, 33} | ({0} if name in ("exr.tif", "loop.tif", "subdirectory.tif") else set())
            yield Variant(name, {name: content}, arguments, codes)


def halves(rng, folder):
    """Row 3: halves, and passes of several other kinds, that contradict each other."""
    kinds = {
        "swapped channels": lambda f: f["a"].__setitem__(slice(None), f["a"][::-1].copy()),
        "shifted by a pixel": lambda f: f["a"].__setitem__(slice(None), np.roll(f["a"], 1, axis=2)),
        "equal to the mean": lambda f: f.update(a=f["mean"].copy(), b=f["mean"].copy()),
        "a row of zeros": lambda f: f["a"].__setitem__((slice(None), 5), 0),
        "1.2 times": lambda f: f.update(a=1.2 * f["a"], b=1.2 * f["b"]),
        "a is the mean, b is zero": lambda f: f.update(a=f["mean"].copy(), b=0 * f["b"]),
        "huge": lambda f: f["a"].__setitem__((0, 3, 3), 1e30),
        "one channel zero": lambda f: (f["a"].__setitem__(1, 0), f["b"].__setitem__(1, 0)),
        "sums in place of means": lambda f: f.update(a=4 * f["a"], b=4 * f["b"]),
        "gamma": lambda f: f.update(a=f["a"] ** 0.45, b=f["b"] ** 0.45),
        "minus 0.05": lambda f: f.update(a=f["a"] - 0.05, b=f["b"] - 0.05),
        "variance of zero": lambda f: f.update(variance=0 * f["variance"]),
    }

    def keeps_energy(program, outcome):
        if outcome.code:
            return []
        given, made = exr.read(program.folder / "in.exr"), exr.read(program.folder / "o.exr")
        wrong = []
        for c in "RGB":
            before, after = (planes[f"ViewLayer.Combined.{c}"].sum(dtype=float) for planes in (given, made))
            if abs(after / before - 1) > 0.05 and b"energy" not in outcome.out:
                wrong.append(f"energy of {c}: {before} -> {after}")
        return wrong

    for what, change in kinds.items():
        frame = seeds.scene()
        change(frame)
        content = exr_bytes.build([(None, seeds.planes(frame), None)]).packed()
        yield Variant(
            what, {"in.exr": content}, ["denoise", "-i", "in.exr", "-o", "o.exr", *DRAFT], {0, 6}, keeps_energy
        )


def odd_frames(rng, folder):
    """Row 5: one odd frame of a sequence of three; the others go on."""
    plain = exr_bytes.build([(None, seeds.planes(seeds.scene()), None)])

    def with_attribute(*attribute):
        file = exr_bytes.parse(plain.packed())
        file.headers[0] = [a for a in file.headers[0] if a.name != attribute[0].encode()] + [Attribute(*attribute)]
        return file.packed()

    odd = {
        "name of a layer in Latin-1": exr_bytes.build(
            [(None, {**seeds.planes(seeds.scene()), b"\xe9\xe8.R": np.ones((32, 48), np.float32)}, None)]
        ).packed(),
        "comments in UTF-16": with_attribute("comments", "string", b"\xff\xfea\0b\0"),
        "samples that are no number": with_attribute("cycles.ViewLayer.samples", "string", b"\xffeight"),
        "polyrecon/settings as a float": with_attribute("polyrecon/settings", "float", bytes(4)),
        "view as an int": with_attribute("view", "int", bytes(4)),
        "multiView as a string": with_attribute("multiView", "string", b"left"),
        "chromaticities of NaN": with_attribute(
            "chromaticities", "chromaticities", struct.pack("<8f", *[float("nan")] * 8)
        ),
        "envmap of 200": with_attribute("envmap", "envmap", b"\xc8"),
        "pixelAspectRatio of 0": with_attribute("pixelAspectRatio", "float", bytes(4)),
        "worldToCamera as a string": with_attribute("worldToCamera", "string", b"x"),
        "compression of 99": with_attribute("compression", "compression", b"\x63"),
        "empty": b"",
    }

    def others_are_there(program, outcome):
        missing = [k for k in (1, 3) if not (program.folder / f"o.000{k}.exr").exists()]
        return [f"frames {missing} are missing"] * bool(missing) + [
            w for k in (1, 2, 3) for w in json_faults(program.folder / f"r.000{k}.json")
        ]

    for what, content in odd.items():
        files = {"s.0001.exr": plain.packed(), "s.0002.exr": content, "s.0003.exr": plain.packed()}
        arguments = [
            "denoise",
            "-i",
            "s.####.exr",
            "-o",
            "o.####.exr",
            *DRAFT,
            "--frame-radius",
            "0",
            "--report",
            "r.####.json",
        ]
        yield Variant(what, files, arguments, {0, 3, 4}, others_are_there)
        for command in (["inspect", "s.0002.exr", "--json"], ["compare", "s.0002.exr", "s.0001.exr", "--json"]):
            yield Variant(f"{command[0]} {what}", files, command, {0, *REFUSED}, is_json)


def json_faults(path):
    if not path.exists():
        return []
    try:
        json.loads(path.read_bytes().decode("utf-8"))
    except ValueError as error:
        return [f"{path.name}: {error}"]
    return []


def is_json(program, outcome):
    path = program.folder / "out.json"
    path.write_bytes(outcome.out if outcome.code == 0 else b"{}")
    return json_faults(path)


def printed(rng, folder):
    """Row 8: control characters in every place from which a text is printed."""
    evil = "\x1b[2J\x07a\nopenjd_fail: forged\r\x9b7m\u2028"
    planes = seeds.planes(seeds.scene(16, 12))

    def named(name):
        return {name: exr_bytes.build([(None, planes, None)]).packed()}

    def attribute(name, text):
        return exr_bytes.build([(None, planes, None)], extra=[(name, "string", text.encode())]).packed()

    def layer(name):
        more = {f"{name}.{c}": planes[f"ViewLayer.Combined.{c}"] for c in "RGB"}
        return exr_bytes.build([(None, {**planes, **more}, None)]).packed()

    def part(name):
        return exr_bytes.build(
            [(name, planes, None), (f"{name}2", {"Z": planes["ViewLayer.Denoising Depth.Z"]}, None)]
        ).packed()

    name = "x" + evil.replace("/", "") + ".exr"
    out = ["-o", "o.exr", *DRAFT]
    yield Variant("name", named(name), ["inspect", name], {0})
    yield Variant("layer", {"in.exr": layer(evil.replace(".", ""))}, ["inspect", "in.exr"], {0})
    yield Variant(
        "layer aov",
        {"in.exr": layer(evil.replace(".", ""))},
        ["denoise", "-i", "in.exr", *out, "--aov", "all", "-v"],
        {0},
    )
    yield Variant(
        "layer preview",
        {"in.exr": layer(evil.replace(".", ""))},
        ["preview", "in.exr", "-o", "o.png", "--layer", evil],
        {0},
    )
    yield Variant("part", {"in.exr": part(evil)}, ["inspect", "in.exr"], {0, 3})
    yield Variant(
        "part denoise", {"in.exr": part(evil)}, ["denoise", "-i", "in.exr", *out, "--progress", "openjd"], {0, 3}
    )
    for key in (
        "cycles.ViewLayer.samples",
        "polyrecon/sharedSamples",
        "polyrecon/settings",
        "cycles.ViewLayer.render_time",
        evil,
    ):
        files = {"in.exr": attribute(key, evil), "b.exr": attribute(key, evil + "2")}
        yield Variant(f"attribute {key!r}", files, ["inspect", "in.exr"], {0, 3})
        yield Variant(f"attribute {key!r} merge", files, ["merge", "in.exr", "b.exr", *out[:2]], {0, *REFUSED})
        yield Variant(f"attribute {key!r} again", files, ["denoise", "-i", "in.exr", *out, "-v"], {0, *REFUSED})
    for option in (
        "--quality",
        "--aov",
        "--map",
        "--steps",
        "--frames",
        "--view",
        "--export",
        "--oidn",
        "--outputs",
        "--wrap",
    ):
        yield Variant(f"value of {option}", {}, [*PLAIN, option, evil], {0, *REFUSED})
    yield Variant("prior", {}, [*PLAIN, "--prior", evil], REFUSED)
    yield Variant(
        "page", {"p.json": json.dumps({"title": evil}).encode()}, ["view", "--page", "p.json", "-o", "o.html"], REFUSED
    )


def patterns(rng, folder):
    """Row 13: places for numbers, in folders, in names, twice, with folders that exist or do not."""
    plain = exr_bytes.build([(None, seeds.planes(seeds.scene(16, 12)), None)]).packed()

    def made(*names):
        return lambda program, outcome: [f"{n} is missing" for n in names if not (program.folder / n).exists()]

    for place in ("a#b", "####", "%d", "%04d", "#%d", "%%d", "a%0d", "%20d", "%s", "%1$d", "#" * 60):
        files = {f"{place}/s.0001.exr": plain, f"{place}/s.0002.exr": plain}
        arguments = ["denoise", "-i", f"{place}/s.####.exr", "-o", f"{place}/o.####.exr", *DRAFT]
        yield Variant(f"folder {place}", files, arguments, {0}, made(f"{place}/o.0001.exr", f"{place}/o.0002.exr"))
    for name in ("s%sx.####.exr", "s%n.####.exr", "%100000000d.exr", "%-4d.exr", "%0999d.exr", "%", "s.%%04d.exr"):
        yield Variant(f"name {name}", {}, ["denoise", "-i", name, "-o", "o.####.exr", *DRAFT], REFUSED)


def texts(rng, folder):
    """Row 17: texts of hundreds of thousands of characters in every option that is parsed."""
    for option in (
        "--frames",
        "--map",
        "--aov",
        "--outputs",
        "--steps",
        "--max-memory",
        "--samples",
        "--time-budget",
        "--target",
        "--quality",
        "--view-layer",
        "--prior",
        "--report",
        "--error-map",
        "--wait",
        "--max-pixels",
        "--oidn",
        "--compression",
    ):
        for text in ("1," * (LONG // 2), "9" * LONG, "(" * LONG, "a=" * (LONG // 2)):
            if len(text) < 2**17:
                continue
            codes = {*REFUSED, 5} | ({0} if option == "--max-memory" else set())  # as much as you like
            yield Variant(f"{option} {text[:2]}", {}, [*PLAIN, option, text[:130000]], codes)
    for arguments in (
        ["inspect", "a/" * 60000],
        ["preview", "*" * 120000, "-o", "o.png"],
        ["view", "#" * 120000, "-o", "v.html"],
        ["compare", "plain.exr", "?" * 120000],
        ["merge", "[" * 120000, "-o", "o.exr"],
        ["%" * 120000],
        ["sweep", "-i", "plain.exr", "--reference", "plain.exr", "-o", "s.html", "--vary", "quality=" + "a," * 50000],
    ):
        yield Variant(f"{arguments[0][:20]} long", {}, arguments, REFUSED)


def numbers(rng, folder):
    """Row 18: numbers that are at the ends of what floats hold."""
    kinds = {
        "1e14": 1e14,
        "1e-14": 1e-14,
        "1e-38": 1e-38,
        "9e14": 9e14,
        "1e15": 1e15,
        "1e18": 1e18,
        "1e30": 1e30,
        "3e38": 3e38,
        "1e-44": 1e-44,
        "1e10": 1e10,
    }

    def finite(program, outcome):
        if outcome.code:
            return []
        wrong = []
        for name in ("o.exr", "e.exr", "s.exr"):
            for channel, plane in exr.read(program.folder / name).items():
                if "Sample Count" not in channel and not np.isfinite(plane.astype(np.float64)).all():
                    wrong.append(f"{name} {channel} is not finite")
        return wrong

    maps = ["--error-map", "e.exr", "--sample-map", "s.exr", "--budget", "4", "--samples", "8"]
    for what, scale in kinds.items():
        with np.errstate(all="ignore"):
            content = exr_bytes.build([(None, seeds.planes(seeds.scene(scale=scale)), None)]).packed()
        yield Variant(
            f"exposure {what}",
            {"in.exr": content},
            ["denoise", "-i", "in.exr", "-o", "o.exr", *DRAFT, *maps],
            {0, 6},
            finite,
        )
    for what, counts in {"nan": np.nan, "zero": 0, "negative": -8, "1e38": 1e38, "half": 0.5}.items():
        frame = seeds.scene()
        frame["counts"] = np.where(frame["depth"] > 4, counts, 8.0)
        content = exr_bytes.build([(None, seeds.planes(frame), None)]).packed()
        yield Variant(
            f"counts {what}",
            {"in.exr": content},
            ["denoise", "-i", "in.exr", "-o", "o.exr", *DRAFT, *maps[:6]],
            {0, 6},
            finite,
        )
        yield Variant(
            f"counts {what} merged",
            {"in.exr": content, "b.exr": content[:-1] + content[-1:]},
            ["merge", "in.exr", "plain.exr", "-o", "o.exr", "--overwrite"],
            {0, *REFUSED},
        )
    for option in ("--samples", "--time-budget", "--target", "--budget", "--max-samples", "--wait", "--dwa-level"):
        for value in ("nan", "inf", "-1", "1e999", "1e-999", "0x10", "", "1e308"):
            more = ["--sample-map", "s.exr"] if option in ("--budget", "--max-samples") else []
            more += ["--budget", "2"] if option == "--max-samples" else []
            yield Variant(
                f"{option} {value}",
                {},
                [*PLAIN, *more, option, value, "--wait", "0"] if option != "--wait" else [*PLAIN, option, value],
                {0, 2, 6, 8},
            )


def bombs(rng, folder):
    """Row 16: small files that stand for much memory, in commands with a limit."""

    def header(width, height, channels, compression=3):
        data = exr_bytes.channel_list([(f"c{i}.R".encode(), 2, 1, 1) for i in range(channels)])
        file = exr_bytes.build([(None, {"R": np.zeros((1, 1), np.float32)}, None)])
        window = struct.pack("<4i", 0, 0, width - 1, height - 1)
        for attribute in file.headers[0]:
            if attribute.name == b"channels":
                attribute.data = data
            if attribute.name in (b"dataWindow", b"displayWindow"):
                attribute.data = window
            if attribute.name == b"compression":
                attribute.data = bytes([compression])
        lines = (1, 1, 1, 16, 32, 16, 32, 32, 32, 256)[compression]
        file.offsets = [0] * min(100000, -(-height // lines))
        return file.packed()

    zeros = exr_bytes.build([(None, {c: np.zeros((2000, 2000), np.float32) for c in "RGB"}, None)]).packed()
    many = exr_bytes.build(
        [(None, {f"l{i}.{c}": np.zeros((200, 200), np.float32) for i in range(60) for c in "RGB"}, None)]
    ).packed()
    files = {
        "wide.exr": header(2**28, 1, 3),
        "tall.exr": header(1, 2**28, 3),
        "channels.exr": header(64, 64, 4000),
        "big.exr": header(16000, 16000, 3),
        "zeros.exr": zeros,
        "many.exr": many,
        "dwa.exr": header(16384, 256, 40, 9),
        "attribute.exr": exr_bytes.build(
            [(None, {"R": np.zeros((4, 4), np.float32)}, None)], extra=[("x", "string", bytes(5 * 10**6))]
        ).packed(),
        "parts.exr": exr_bytes.build(
            [(f"p{i}", {"R": np.zeros((2, 2), np.float32)}, None) for i in range(3000)]
        ).packed(),
        "strings.exr": exr_bytes.build(
            [(None, {"R": np.zeros((4, 4), np.float32)}, None)], extra=[("x", "stringvector", bytes(4 * 500000))]
        ).packed(),
    }
    commands = {
        "inspect": ["inspect"],
        "preview": ["preview", "-o", "o.png"],
        "compare": ["compare", "plain.exr"],
        "view": ["view", "-o", "v.html"],
        "merge": ["merge", "plain.exr", "-o", "o.exr"],
        "denoise": ["denoise", "-o", "o.exr", "--quality", "draft", "-i"],
        "samplemap": ["samplemap", "-o", "s.exr", "--budget", "4", "-e"],
        "prior": [*PLAIN, "--prior"],
        "reference": ["sweep", "-i", "plain.exr", "-o", "s.html", "--vary", "quality", "--reference"],
    }
    for name, content in files.items():
        for what in rng.sample(sorted(commands), 3):
            yield Variant(
                f"{what} {name}", {name: content}, [*commands[what], name, "--max-memory", "200M"], {0, *REFUSED, 6, 33}
            )


def threads_and_limits(rng, folder):
    """Rows 11 and 12, and the disk: limits of the system in each command."""
    for what, arguments in {
        "denoise": PLAIN,
        "prior": [*PLAIN, "--prior", "plain.exr"],
        "view": ["view", "plain.exr", "-o", "o.html"],
        "preview": ["preview", "plain.exr", "-o", "o.png"],
        "merge": ["merge", "plain.exr", "second.exr", "-o", "o.exr"],
        "compare": ["compare", "plain.exr", "second.exr", "--html", "o.html"],
        "samplemap": ["denoise", "-i", "plain.exr", "-o", "o.exr", "--sample-map", "s.exr", "--budget", "4", *DRAFT],
        "sweep": ["sweep", "-i", "plain.exr", "--reference", "second.exr", "-o", "s.html", "--vary", "quality"],
        "report": [*PLAIN, "--report", "r.json", "-t", "2"],
        "jpeg": ["preview", "plain.exr", "-o", "o.jpg"],
    }.items():
        for kind, limit, codes in (
            ("file size", (resource.RLIMIT_FSIZE, 2000), {0, 5}),
            ("processor time", (resource.RLIMIT_CPU, 0), {-9, -24, 0, 130, 143}),
            ("open files", (resource.RLIMIT_NOFILE, 33), {0, 33}),
            ("memory", (resource.RLIMIT_AS, 700 * 2**20), {0, 33, 127}),
        ):

            def nothing_left(program, outcome, kind=kind):
                if outcome.code == 0 or kind == "processor time":
                    return []
                return [
                    f"left {n}"
                    for n in ("o.exr", "o.png", "o.jpg", "o.html", "s.html", "s.exr")
                    if (program.folder / n).exists()
                ]

            yield Variant(f"{kind} {what}", {}, arguments, codes, nothing_left, limits=[limit])


ROWS = {
    1: names_of_formats,
    3: halves,
    5: odd_frames,
    8: printed,
    11: threads_and_limits,
    13: patterns,
    16: bombs,
    17: texts,
    18: numbers,
}


def attack(program, tally, count, more):
    """All variants, whatever count says."""
    rng = random.Random(tally.seed)
    plain = exr_bytes.build([(None, seeds.planes(seeds.scene()), None)]).packed()
    for row, variants in ROWS.items():
        program.clear()
        for variant in list(variants(rng, program.folder)):
            if tally.is_over():
                return
            program.clear()
            for name, content in {"plain.exr": plain, "second.exr": plain, **variant.files}.items():
                path = program.folder / name
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_bytes(content)
            tally.inputs += 1
            outcome = program.run(variant.arguments, **variant.run)
            limited = "limits" in variant.run
            wrong = [] if limited else outcome.faults(tally.memory, variant.codes)
            if limited and outcome.code not in variant.codes:
                wrong.append(f"exit code {outcome.code}: {outcome.err[:200]!r}")
            wrong += [f"left {path}" for path in program.left_over()]
            if variant.check:
                wrong += variant.check(program, outcome)
            tally.count(
                outcome,
                wrong,
                f"row {row} {variant.what!r}",
                [program.folder / n for n in variant.files if len(n) < 200],
            )
