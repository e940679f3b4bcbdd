"""Files whose contents are of another format than their name says, and damaged files of the right one."""

import random
import struct

import numpy as np
import OpenImageIO as oiio

from tests.attacks import exr_bytes, seeds

NAME = "decoders"
WRITTEN = (
    "tif",
    "png",
    "jpg",
    "bmp",
    "ico",
    "dpx",
    "tga",
    "sgi",
    "iff",
    "rla",
    "ppm",
    "gif",
    "zfile",
    "hdr",
    "fits",
    "jp2",
    "webp",
    "psd",
    "cin",
    "sun",
    "pic",
)
READ = ("exr", "tif", "tiff", "pfm", "hdr")  # What the program reads as input.
OTHERS = ("png", "jpg", "dpx", "ico", "EXR", "TIF", "txt", "")
MAGICS = {
    "tif": b"II*\0\x08\0\0\0",
    "bigtiff": b"II+\0\x08\0\0\0",
    "mm": b"MM\0*\0\0\0\x08",
    "pfm": b"PF\n8 8\n-1\n",
    "hdr": b"#?RADIANCE\n",
    "exr": struct.pack("<II", exr_bytes.MAGIC, 2),
    "psd": b"8BPS\0\1",
    "dds": b"DDS |\0\0\0",
    "cin": b"\x80\x2a\x5f\xd7",
    "webp": b"RIFF\0\0\0\0WEBPVP8 ",
    "jp2": b"\0\0\0\x0cjP  \r\n\x87\n",
    "heif": b"\0\0\0\x18ftypheic",
    "softimage": b"\x53\x80\xf6\x34",
    "ptex": b"Ptex\1\0\0\0",
    "openvdb": b" BDV\0\0\0\0",
    "fits": b"SIMPLE  =                    T",
    "elf": b"\x7fELF\2\1\1",
    "zip": b"PK\3\4",
    "pdf": b"%PDF-1.4\n",
    "svg": b"<svg xmlns='http://www.w3.org/2000/svg'>",
    "script": b"#!/bin/sh\ntouch x\n",
}


def written(folder):
    """{format: bytes} of one picture in all formats that OpenImageIO writes here."""
    image, found = oiio.ImageBuf(oiio.ImageSpec(16, 16, 3, "float")), {}
    oiio.ImageBufAlgo.fill(image, (0.1, 0.5, 0.9))
    for extension in WRITTEN:
        path = folder / f"made.{extension}"
        if image.write(str(path)) and path.exists():
            found[extension] = path.read_bytes()
    found["pfm"] = b"PF\n16 16\n-1.0\n" + np.full(16 * 16 * 3, 0.5, "<f4").tobytes()
    found["exr"] = exr_bytes.build([(None, {c: np.full((16, 16), 0.5, np.float32) for c in "RGB"}, None)]).packed()
    return found


def damaged(content, rng):
    content = bytearray(content)
    for _ in range(rng.choice((1, 2, 8))):
        at = rng.randrange(min(len(content), rng.choice((16, 200, 10**9))))
        how = rng.randrange(4)
        if how == 0:
            content[at] = rng.randrange(256)
        elif how == 1:
            content[at : at + 4] = rng.choice((b"\xff\xff\xff\xff", b"\0\0\0\0", b"\xff\xff\xff\x7f", b"\0\0\1\0"))
        elif how == 2 and len(content) > 8:
            del content[max(8, at) :]
        else:
            content[at:at] = rng.randbytes(rng.choice((1, 4, 2000)))
    return bytes(content)


def commands(path):
    return (
        ["inspect", path],
        ["denoise", "-i", path, "-o", "out.exr", "--quality", "draft", "--overwrite"],
        ["preview", path, "-o", "p.png", "--overwrite"],
        ["compare", path, path],
        ["merge", path, path, "-o", "out.exr", "--overwrite"],
        ["denoise", "-i", "plain.exr", "-o", "out.exr", "--quality", "draft", "--overwrite", "--prior", path],
    )


def attack(program, tally, count, more):
    rng = random.Random(tally.seed)
    contents = written(program.folder)
    contents.update({f"magic of {name}": magic + rng.randbytes(600) for name, magic in MAGICS.items()})
    contents.update({f"{name} after a TIFF's magic": MAGICS["tif"] + content for name, content in contents.items()})
    plain = exr_bytes.build([(None, seeds.planes(seeds.scene()), None)]).packed()
    right = {
        "tif": {"tif", "tiff"},
        "pfm": {"pfm"},
        "hdr": {"hdr"},
        "exr": {*READ, *OTHERS},
    }  # EXR is known by its contents.

    def one(name, content, refused, label):
        program.clear()
        (program.folder / "plain.exr").write_bytes(plain)
        (program.folder / name).write_bytes(content)
        tally.inputs += 1
        for arguments in rng.sample(commands(name), min(len(commands(name)), tally.commands // 2)):
            outcome = program.run(arguments)
            wrong = outcome.faults(tally.memory) + [f"left {path}" for path in program.left_over()]
            if refused and outcome.code == 0:
                wrong.append("was decoded")
            tally.count(outcome, wrong, f"{label} as {name} {arguments[0]}", [program.folder / name])

    pairs = [(kind, extension) for kind in contents for extension in (*READ, *OTHERS)]
    for kind, extension in rng.sample(pairs, min(len(pairs), 3 * count)):
        if tally.is_over():
            return
        name, content = f"x.{extension}" if extension else "x", contents[kind]
        one(name, content, extension.lower() not in right.get(kind, ()), kind)
    for number in range(count):
        if tally.is_over():
            break
        kind = rng.choice(("tif", "pfm", "hdr"))
        one(f"x.{kind}", damaged(contents[kind], rng), False, f"{number} damaged {kind}")
