"""Headers of EXR files with wrong types, sizes, windows, tiles, channels, names and values."""

import copy
import random
import struct

from tests.attacks import exr_bytes, seeds
from tests.attacks.exr_bytes import Attribute

NAME = "headers"
DOES = "EXR headers with 1 to 3 wrong attributes, bytes or offsets"
INTS = (0, 1, -1, 2, 255, 65535, 2**30, 2**31 - 1, -(2**31), -(2**31) + 1, 2**28, 46341)
FLOATS = (0.0, -0.0, -1.0, float("nan"), float("inf"), float("-inf"), 1e38, 1e-42)
TYPES = (
    "box2f",
    "box2i",
    "chlist",
    "chromaticities",
    "compression",
    "double",
    "envmap",
    "float",
    "floatvector",
    "int",
    "keycode",
    "lineOrder",
    "m33f",
    "m44f",
    "preview",
    "rational",
    "string",
    "stringvector",
    "tiledesc",
    "timecode",
    "v2f",
    "v2i",
    "v3f",
    "opaque",
    "deepImageState",
    "",
    "x" * 300,
    "str\x1bing",
    "string ",
)
TEXTS = (
    b"",
    b"\0",
    b"x" * 300,
    b"x" * 70000,
    b"\xff\xfe\xdf",
    b"\x1b[2J\x1b]0;t\a",
    b"a\nopenjd_fail: forged",
    b"\n@polyrecon {}",
    b"..",
    b"../../x",
    b"/etc/passwd",
    b"%s%n%d",
    b"####",
    b".",
    b"...",
    b"R.",
    b".R",
    b"a..b",
    b"-1",
    b"1e999",
    b"nan",
    b"0x10",
    b"9" * 10000,
    b"8 samples",
    b"-8",
    b"1e-320",
    b"\xe2\x80\xaeevil",
    b"ViewLayer.Combined",
    b"left",
    b"scanlineimage",
    b"tiledimage",
    b"deepscanline",
    b"deeptile",
    b'{"a": 1}',
    b"[" * 50000,
    b'{"layers":' * 2000,
)
NAMES = (
    "channels",
    "compression",
    "dataWindow",
    "displayWindow",
    "lineOrder",
    "pixelAspectRatio",
    "screenWindowCenter",
    "screenWindowWidth",
    "tiles",
    "name",
    "type",
    "version",
    "chunkCount",
    "view",
    "multiView",
    "envmap",
    "preview",
    "chromaticities",
    "whiteLuminance",
    "owner",
    "comments",
    "cycles.ViewLayer.samples",
    "cycles.ViewLayer.render_time",
    "polyrecon/input",
    "polyrecon/settings",
    "polyrecon/version",
    "polyrecon/sharedSamples",
    "polyrecon/merge",
    "polyrecon/estimatedRelMSE",
    "maxSamplesPerPixel",
    "samplesPerPixel",
    "dwaCompressionLevel",
    "arnold/version",
    "renderman/samples",
    "wrapmodes",
    "timeCode",
    "adoptedNeutral",
    "",
)


def _value(kind, rng):
    """Random data, more or less of the type."""
    if kind in ("string", "stringvector", "") or rng.random() < 0.1:
        text = rng.choice(TEXTS)
        return struct.pack("<i", len(text)) + text if kind == "stringvector" and rng.random() < 0.7 else text
    if kind in ("float", "v2f", "v3f", "box2f", "chromaticities", "m33f", "m44f", "floatvector"):
        count = {"float": 1, "v2f": 2, "v3f": 3, "box2f": 4, "chromaticities": 8, "m33f": 9}.get(kind, 16)
        return struct.pack(f"<{count}f", *(rng.choice(FLOATS) for _ in range(count)))
    if kind in ("compression", "lineOrder", "envmap", "deepImageState"):
        return bytes([rng.randrange(256) if rng.random() < 0.5 else rng.randrange(12)])
    if kind == "tiledesc":
        return struct.pack(
            "<IIB", *(rng.choice(INTS) & 0xFFFFFFFF for _ in range(2)), rng.choice((0, 1, 2, 3, 16, 17, 18, 255))
        )
    count = {"int": 1, "v2i": 2, "box2i": 4, "rational": 2, "timecode": 2, "keycode": 7, "preview": 2, "double": 2}.get(
        kind, 3
    )
    return struct.pack(f"<{count}i", *(rng.choice(INTS) for _ in range(count)))


def _window(attribute, rng):
    """A window near the one that is there, or far from it."""
    values = list(struct.unpack("<4i", attribute.data)) if len(attribute.data) == 16 else [0, 0, 9, 9]
    how = rng.randrange(5)
    if how == 0:
        values[rng.randrange(4)] += rng.choice((-1, 1, 2, -5, 16, 1000))
    elif how == 1:
        shift = rng.choice((-7, 2**30, -(2**30), 2**31 - 60, -(2**31)))
        values = [value + shift for value in values]
    elif how == 2:
        values = values[2:] + values[:2]
    elif how == 3:
        values[rng.randrange(4)] = rng.choice(INTS)
    else:
        values[2] = values[0] + rng.choice((0, -1, 10**6))
    return struct.pack("<4i", *(max(-(2**31), min(2**31 - 1, value)) for value in values))


def _channels(attribute, rng):
    """A channel list with one wrong entry."""
    channels = exr_bytes.channels_of(attribute.data) or [(b"R", 2, 1, 1)]
    at, how = rng.randrange(len(channels)), rng.randrange(9)
    name, kind, xs, ys = channels[at]
    if how == 0:
        channels[at] = (rng.choice(TEXTS).replace(b"\0", b"") or b"x", kind, xs, ys)
    elif how == 1:
        channels[at] = (name, rng.choice((0, 1, 2, 3, -1, 2**31 - 1)), xs, ys)
    elif how == 2:
        channels[at] = (name, kind, rng.choice((0, -1, 2, 3, 2**31 - 1)), rng.choice((0, -1, 1, 2, 2**31 - 1)))
    elif how == 3:
        channels.insert(at, channels[at])
    elif how == 4:
        del channels[at]
    elif how == 5:
        rng.shuffle(channels)
    elif how == 6:
        channels += [(f"x{i}.{c}", 1, 1, 1) for i in range(rng.choice((5, 2000))) for c in "RGB"]
    elif how == 7:
        old, new = rng.choice(
            (
                (b"RGB", b"XYZ"),
                (b"RGB", b"rgb"),
                (b"R", b"A"),
                (b"G", b"Y"),
                (b"B", b"V"),
                (b"Combined", b"Combined.Combined"),
                (b".", b""),
            )
        )
        channels = [(name.replace(old, new) or b"x", *rest) for name, *rest in channels]
    else:
        return exr_bytes.channel_list(channels)[: rng.randrange(len(attribute.data))]
    return exr_bytes.channel_list(channels)


def _edit(file, rng):
    """One edit of a parsed file."""
    header = rng.choice(file.headers)
    if not header:
        return
    at = rng.randrange(len(header))
    attribute, how = header[at], rng.randrange(13)
    if how == 0:
        attribute.size = len(attribute.data) + rng.choice((-1, 1, 4, -4, 1000, 2**31, -(10**6)))
    elif how == 1:
        attribute.kind = exr_bytes._name(rng.choice(TYPES))
    elif how == 2:
        attribute.name = exr_bytes._name(rng.choice(NAMES))
    elif how == 3:
        attribute.data = attribute.data[: rng.randrange(len(attribute.data) + 1)] + rng.randbytes(
            rng.choice((0, 1, 7, 3000))
        )
    elif how == 4:
        del header[at]
    elif how == 5:
        header.insert(at, copy.copy(rng.choice(header)))
    elif how == 6:
        kind = rng.choice(TYPES)
        header.insert(at, Attribute(rng.choice(NAMES), kind, _value(kind, rng)))
    elif how == 7:
        file.version = rng.choice((file.version ^ rng.choice((0x200, 0x400, 0x800, 0x1000, 0x2000)), 1, 3, 255, 0))
    elif how == 8 and file.offsets:
        file.offsets[rng.randrange(len(file.offsets))] += rng.choice((1, -1, 8, 10**9, -(10**9), 2**62))
    elif how == 9:
        if rng.random() < 0.5 and len(file.headers) < 2000:
            file.headers.append(copy.deepcopy(header))
        elif len(file.headers) > 1:
            file.headers.remove(header)
    elif how == 10:
        names = [a for a in header if a.name == b"channels"]
        for found in names:
            found.data = _channels(found, rng)
    elif how == 11:
        for found in (a for a in header if a.name in (b"dataWindow", b"displayWindow") and rng.random() < 0.7):
            found.data = _window(found, rng)
    else:
        attribute.data = _value(attribute.kind.decode("latin-1"), rng)


def mutant(file, rng):
    """The bytes of a file with one to three edits."""
    file = copy.deepcopy(file)
    for _ in range(rng.choice((1, 1, 2, 3))):
        _edit(file, rng)
    content = bytearray(file.packed())
    if rng.random() < 0.15:
        for _ in range(rng.choice((1, 3, 40))):
            content[rng.randrange(min(len(content), rng.choice((8, 400, 10**9))))] = rng.randrange(256)
    if rng.random() < 0.05:
        del content[rng.randrange(len(content)) :]
    return bytes(content)


def commands(path, other):
    """All commands that read an EXR file, on this one and an intact one."""
    return {
        "inspect": ["inspect", path, "--json"],
        "inspect text": ["inspect", path],
        "denoise": [
            "denoise",
            "-i",
            path,
            "-o",
            "out.exr",
            "--quality",
            "draft",
            "--overwrite",
            "--report",
            "out.json",
            "--error-map",
            "e.exr",
            "--alpha",
            "--aov",
            "all",
        ],
        "merge": ["merge", path, other, "-o", "merged.exr", "--overwrite"],
        "merge second": ["merge", other, path, "-o", "merged.exr", "--overwrite"],
        "compare": ["compare", path, path, "--json"],
        "compare html": ["compare", path, other, "--html", "c.html", "--overwrite"],
        "preview": ["preview", path, "-o", "p.png", "--overwrite"],
        "samplemap": ["samplemap", "-e", path, "-o", "s.exr", "--budget", "4", "--samples", "8", "--overwrite"],
        "sweep": ["sweep", "-i", path, "--reference", other, "-o", "s.html", "--vary", "quality", "--overwrite"],
        "view": ["view", path, "-o", "v.html", "--overwrite"],
        "prior": ["denoise", "-i", other, "-o", "out.exr", "--quality", "draft", "--overwrite", "--prior", path],
        "map": [
            "denoise",
            "-i",
            other,
            "-o",
            "out.exr",
            "--quality",
            "draft",
            "--overwrite",
            "--map",
            f"albedo={path}",
        ],
    }


# These draw pictures, which takes up to a hundred times longer than the others; they read files as the others do.
DRAWING = {"compare html", "preview", "sweep", "view"}
DRAWN_SHARE = 0.05  # of the inputs


def attack(program, tally, count, more):
    rng = random.Random(tally.seed)
    intact = seeds.files(more)
    other = program.folder / "other.exr"
    for number in range(count):
        if tally.is_over():
            break
        program.clear()
        name = rng.choice(sorted(intact))
        other.write_bytes(intact["plain"].packed())
        path = program.folder / "in.exr"
        path.write_bytes(mutant(intact[name], rng))
        tally.inputs += 1
        chosen = sorted(commands("in.exr", "other.exr").items())
        if rng.random() > DRAWN_SHARE:
            chosen = [item for item in chosen if item[0] not in DRAWING]
        for what, arguments in rng.sample(chosen, min(len(chosen), tally.commands)):
            outcome = program.run(arguments)
            wrong = outcome.faults(tally.memory) + [f"left {path}" for path in program.left_over()]
            tally.count(outcome, wrong, f"{number} {name} {what}", [path])
