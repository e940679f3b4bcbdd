"""EXR files as lists of bytes, so that any header can be made: no library would write most of them."""

import struct
import zlib

import numpy as np

MAGIC = 20000630
TILED, LONG_NAMES, DEEP, MULTI_PART = 0x200, 0x400, 0x800, 0x1000
PIXEL_TYPES = {np.dtype("uint32"): 0, np.dtype("float16"): 1, np.dtype("float32"): 2}


def _name(text):
    return text if isinstance(text, bytes) else text.encode("utf-8", "surrogateescape")


class Attribute:
    """One attribute. `size` is what the file claims, if it is not the length of the data."""

    def __init__(self, name, kind, data, size=None):
        self.name, self.kind, self.data, self.size = _name(name), _name(kind), data, size

    def packed(self):
        size = len(self.data) if self.size is None else self.size
        return self.name + b"\0" + self.kind + b"\0" + struct.pack("<I", size & 0xFFFFFFFF) + self.data


class File:
    """Version, headers (a list of attributes each), the chunk offsets of all parts in one list, and all chunks."""

    def __init__(self, version, headers, offsets, chunks):
        self.version, self.headers, self.offsets, self.chunks = version, headers, offsets, chunks

    def packed(self):
        """The bytes of the file. The offsets follow the length of the headers."""
        head = struct.pack("<II", MAGIC, self.version)
        for header in self.headers:
            head += b"".join(attribute.packed() for attribute in header) + b"\0"
        if self.version & MULTI_PART:
            head += b"\0"
        start = len(head) + 8 * len(self.offsets)
        table = struct.pack(f"<{len(self.offsets)}Q", *((start + offset) & (2**64 - 1) for offset in self.offsets))
        return head + table + self.chunks


def parse(content):
    """The File of an intact file."""
    magic, version = struct.unpack_from("<II", content)
    assert magic == MAGIC
    at, headers = 8, []
    while content[at]:
        header = []
        while content[at]:
            end = content.index(b"\0", at)
            kind_end = content.index(b"\0", end + 1)
            (size,) = struct.unpack_from("<I", content, kind_end + 1)
            data = content[kind_end + 5 : kind_end + 5 + size]
            header.append(Attribute(content[at:end], content[end + 1 : kind_end], data))
            at = kind_end + 5 + size
        headers.append(header)
        at += 1
        if not version & MULTI_PART:
            break
    else:
        at += 1
    offsets, first = [], len(content)
    while at + 8 * len(offsets) < first:
        (offset,) = struct.unpack_from("<Q", content, at + 8 * len(offsets))
        offsets.append(offset)
        if offset:
            first = min(first, offset)
    return File(version, headers, [offset - first if offset else 0 for offset in offsets], content[first:])


def channel_list(channels):
    """The data of a channel list from (name, pixel type, x sampling, y sampling)."""
    return (
        b"".join(_name(name) + b"\0" + struct.pack("<iB3xii", kind, 0, xs, ys) for name, kind, xs, ys in channels)
        + b"\0"
    )


def channels_of(data):
    """The channels of a channel list, as far as it is whole."""
    found, at = [], 0
    while at < len(data) and data[at]:
        end = data.find(b"\0", at)
        if end < 0 or end + 17 > len(data):
            break
        kind, _, xs, ys = struct.unpack_from("<iB3xii", data, end + 1)
        found.append((data[at:end], kind, xs, ys))
        at = end + 17
    return found


def _part_header(planes, window, display, extra, name, chunk_count):
    kinds = [(channel, PIXEL_TYPES[planes[channel].dtype], 1, 1) for channel in planes]
    header = [
        Attribute("channels", "chlist", channel_list(kinds)),
        Attribute("compression", "compression", b"\x03"),
        Attribute("dataWindow", "box2i", struct.pack("<4i", *window)),
        Attribute("displayWindow", "box2i", struct.pack("<4i", *display)),
        Attribute("lineOrder", "lineOrder", b"\0"),
        Attribute("pixelAspectRatio", "float", struct.pack("<f", 1)),
        Attribute("screenWindowCenter", "v2f", struct.pack("<ff", 0, 0)),
        Attribute("screenWindowWidth", "float", struct.pack("<f", 1)),
    ]
    if name is not None:
        header += [
            Attribute("name", "string", _name(name)),
            Attribute("type", "string", b"scanlineimage"),
            Attribute("chunkCount", "int", struct.pack("<i", chunk_count)),
        ]
    return header + [Attribute(*item) for item in extra]


def zipped(raw):
    """A block of lines as OpenEXR's ZIP compression stores it."""
    pixels = np.frombuffer(raw, np.uint8)
    split = np.concatenate([pixels[0::2], pixels[1::2]]).astype(np.int32)
    split[1:] = (split[1:] - split[:-1] + 128) & 255
    packed = zlib.compress(split.astype(np.uint8).tobytes())
    return packed if len(packed) < len(raw) else raw


def build(parts, display=None, extra=()):
    """A File of scanline parts, compressed by ZIP. A part is (name or None, {channel: array}, (x, y) of its window, or
    None for 0, 0). Channels are float32, float16 or uint32; other dtypes become float32."""
    version, headers, offsets, chunks = 2, [], [], b""
    several = parts[0][0] is not None
    if several:
        version |= MULTI_PART
    for index, (name, given, origin) in enumerate(parts):
        planes = {_name(channel): np.asarray(given[channel]) for channel in given}
        planes = {channel: planes[channel] for channel in sorted(planes)}
        with np.errstate(all="ignore"):
            for channel, plane in planes.items():
                if plane.dtype not in PIXEL_TYPES:
                    planes[channel] = plane.astype(np.float32)
        if any(len(channel) > 31 for channel in planes):
            version |= LONG_NAMES
        height, width = next(iter(planes.values())).shape
        x, y = origin or (0, 0)
        window = (x, y, x + width - 1, y + height - 1)
        count = (height + 15) // 16
        headers.append(_part_header(planes, window, display or window, extra, name, count))
        for top in range(0, height, 16):
            rows = range(top, min(height, top + 16))
            block = zipped(b"".join(plane[row].tobytes() for row in rows for plane in planes.values()))
            offsets.append(len(chunks))
            chunks += (struct.pack("<i", index) if several else b"") + struct.pack("<iI", y + top, len(block)) + block
    return File(version, headers, offsets, chunks)


def write(path, planes, extra=(), **options):
    """Writes one part of the given channels."""
    path.write_bytes(build([(None, planes, None)], extra=extra, **options).packed())
