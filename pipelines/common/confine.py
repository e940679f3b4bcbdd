"""Starts a program that can write into given folders alone, whatever the file says that it opens: a .blend or a scene
chooses where caches and outputs go.

    confine.py FOLDER... -- COMMAND...

It uses Landlock, which Linux has since 5.13. The program also keeps the caches of its graphics driver, and may write to
devices."""

import ctypes
import os
import sys

# System calls, the same numbers on all processors, and constants of the kernel (landlock, prctl).
CREATE_RULESET, ADD_RULE, RESTRICT_SELF = 444, 445, 446
GET_VERSION, PATH_BENEATH, SET_NO_NEW_PRIVS = 1, 1, 38
WRITE_FILE = 1 << 1
# Removing and making entries of every kind, renaming (version 2) and truncating (version 3) them.
ALL_WRITES = {1: WRITE_FILE | 0x1FF0, 2: WRITE_FILE | 0x3FF0, 3: WRITE_FILE | 0x7FF0}
GRAPHICS_CACHES = ("~/.cache/cycles", "~/.cache/nvidia", "~/.cache/comgr", "~/.cache/neo_compiler_cache", "~/.nv")


def why_not(program):
    """The reason why a program cannot be confined; '' where it can."""
    if sys.platform != "linux" or _version() < 1:
        return "this kernel has no Landlock"
    if os.path.basename(os.path.realpath(program)) == "snap":
        return "snap needs privileges to start it"
    with open(program, "rb") as file:
        if file.read(2) == b"#!":
            return "it is a script, which may write files of its own"
    return ""


def confined(words, folders):
    """The command that runs the command `words` with these folders as the only ones that it can write into."""
    return [sys.executable, "-I", "-S", "-B", __file__, *folders, "--", *words]


def _version():
    return _call(CREATE_RULESET, None, 0, GET_VERSION)


def _call(number, *arguments):
    words = [ctypes.c_long(word) if isinstance(word, int) else word for word in arguments]
    return ctypes.CDLL(None, use_errno=True).syscall(number, *words)


class _PathBeneath(ctypes.Structure):
    _pack_ = 1
    _fields_ = (("allowed", ctypes.c_uint64), ("folder", ctypes.c_int32))


def _restrict(folders):
    writes = ALL_WRITES[min(_version(), 3)]
    handled = ctypes.c_uint64(writes)
    rules = _call(CREATE_RULESET, ctypes.byref(handled), ctypes.sizeof(handled), 0)
    for folder, allowed in [("/dev", WRITE_FILE), *((folder, writes) for folder in folders)]:
        rule = _PathBeneath(allowed, os.open(folder, os.O_PATH | os.O_CLOEXEC))
        if _call(ADD_RULE, rules, PATH_BENEATH, ctypes.byref(rule), 0):
            raise OSError(ctypes.get_errno(), "landlock_add_rule", folder)
    ctypes.CDLL(None).prctl(SET_NO_NEW_PRIVS, *map(ctypes.c_ulong, (1, 0, 0, 0)))
    if _call(RESTRICT_SELF, rules, 0):
        raise OSError(ctypes.get_errno(), "landlock_restrict_self")


def main():
    at = sys.argv.index("--")
    caches = map(os.path.expanduser, GRAPHICS_CACHES)
    _restrict([*sys.argv[1:at], *filter(os.path.isdir, caches)])
    os.execv(sys.argv[at + 1], sys.argv[at + 1 :])


if __name__ == "__main__":
    main()
