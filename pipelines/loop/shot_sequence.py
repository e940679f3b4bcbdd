"""The result of a shot: all frames denoised as one sequence, so that frames before and after join."""

import os

from ..common.frame_names import frame_path, ranges_text
from ..common.work_folder import WorkFolder

NUMBER = "####"  # In the names of the files that are denoised as a sequence


def finish(polyrecon, frames, open_for_merging, why_ended):
    """Merges, denoises and delivers all frames. Returns (Settings, Result) of each.

    open_for_merging: gives the context in which a frame is merged."""
    # Next to the passes, since it holds as much as they do.
    with WorkFolder("shot", frames[0].folder.path) as folder:
        for frame in frames:
            with open_for_merging(frame):
                frame.reconstruction.merge_all(_file(folder, "merged", frame))
        _denoise(polyrecon, frames, folder)
        return [_deliver(frame, folder, why_ended) for frame in frames]


def _denoise(polyrecon, frames, folder):
    pattern = {name: folder / f"{name}.{NUMBER}.exr" for name in ("merged", "clean", "error")}
    words = ["--frames", ranges_text([frame.settings.files.number for frame in frames])]
    words += frames[0].reconstruction.result_options(frames[0].settings)
    files = ["-i", pattern["merged"], "-o", pattern["clean"], "--error-map", pattern["error"]]
    polyrecon.run("denoise", *files, *words)


def _deliver(frame, folder, why_ended):
    """Writes the outputs of a frame."""
    for name in ("merged", "clean"):
        os.replace(_file(folder, name, frame), getattr(frame.folder, name))
    os.replace(_file(folder, "error", frame), frame.folder.error_map)
    frame.why_ended = why_ended
    error, noise = frame.reconstruction.deliver(frame.settings)
    frame.journal.save()
    return frame.settings, frame.result(error, noise)


def _file(folder, name, frame):
    return folder / frame_path(f"{name}.{NUMBER}.exr", frame.settings.files.number)
