"""The state of one frame's loop, and journal.json, which keeps it on disk: a loop that was killed continues from
there."""

import dataclasses
import json
import re
import time
from typing import Any, Optional

from ..common import digests
from ..common.decode import InvalidFileError, decode, read_json
from ..common.errors import DriverError, ExitCode
from ..common.files import write_text

VERSION = 6
HALVES = ("a", "b")


@dataclasses.dataclass(frozen=True)
class Part:
    """One render pass over the whole frame, in a file of its own."""

    file: str  # Name in the folder of passes
    half: str  # "a" or "b"
    round: int  # 0: the first pass and its uniform continuation
    first_sample: int  # Number in the sequence of each pixel
    samples: float  # Per pixel, mean of the frame
    cost_weighted_samples: float  # The same, counted in samples of average cost
    seconds: float
    masked: bool  # The requested counts differ between pixels.
    sha256: str  # Digest of the file


@dataclasses.dataclass(frozen=True)
class Round:
    """The knowledge by which the samples of round + 1 were decided."""

    round: int
    samples: float  # Per pixel, taken so far
    seconds: float  # Spent so far
    decision_seconds: float  # Seconds of this decision
    error: Optional[float]  # Estimated mean relative MSE; None: no pixel has a finite error.
    next_samples: float  # Cost-weighted samples per pixel that the decision grants; 0: the loop ends.


@dataclasses.dataclass(frozen=True)
class RoundPlan:
    """A round that is being rendered. The counts of its pixels are in the files counts_a and counts_b of the round."""

    round: int
    first_samples: dict[str, int]  # For each half: where its counts begin in the sequence
    parts: int  # Number of parts that each half's counts are divided into
    parts_before: int  # Parts of each half that the round has already
    cost_weighted_samples: float  # Per pixel, both halves together
    counts_sha256: dict[str, str]  # Digest of the file with each half's counts


@dataclasses.dataclass
class State:
    """Everything that a resumed run needs to know in addition to the files."""

    identity: dict[str, Any]  # Scene, frame and settings that the passes show. Other passes cannot be added to them.
    seconds: float = 0.0  # Spent so far, over all runs
    first_pass_parts: int = len(HALVES)
    next_sample: int = 0  # First number of the sequence that no part uses
    parts: list[Part] = dataclasses.field(default_factory=list)  # Finished parts in the order of rendering
    rounds: list[Round] = dataclasses.field(default_factory=list)
    next_round: Optional[RoundPlan] = None
    inputs: dict[str, str] = dataclasses.field(default_factory=dict)  # SHA-256 of each file that the passes show

    @property
    def samples(self):
        """Samples per pixel, mean of the frame."""
        return sum(part.samples for part in self.parts)

    @property
    def error(self):
        """Estimated mean relative MSE at the last decision; None: unknown."""
        return self.rounds[-1].error if self.rounds else None

    def files(self, half):
        return [part.file for part in self.parts if part.half == half]

    def part_count(self, round_number, half):
        return sum(part.round == round_number and part.half == half for part in self.parts)


class Journal:
    """A state, its file, and the clock of the loop.

    A part is entered after its file has its final name. A part that is not in the journal was never counted: a resumed
    run renders it again, with the same numbers of the sequence."""

    def __init__(self, path, state):
        self.path, self.state = path, state
        self.start_clock()

    @classmethod
    def open(cls, folder, new_state, resume):
        """Starts a journal with `new_state`, or with `resume` continues the one that is there. Passes of an earlier run
        are not overwritten without `resume`. Raises DriverError."""
        path = folder.journal
        if not path.exists():
            return cls(path, new_state)
        if not resume:
            raise DriverError(
                ExitCode.USAGE,
                f"{path}: passes of an earlier run: continue them with --resume, or choose another --passes-dir",
            )
        try:
            state = _decode_state(path)
        except InvalidFileError as error:
            raise DriverError(
                ExitCode.BAD_INPUT, f"{path}: not a valid journal: {error}: start again with another --passes-dir"
            ) from error
        _compare_identities(path, state.identity, new_state.identity)
        _check_files(folder, state)
        return cls(path, state)

    def compare_inputs(self, inputs):
        """Refuses inputs ({path: SHA-256}) other than those of the finished parts."""
        if not self.state.parts:
            self.state.inputs = inputs
        for path in sorted(inputs.keys() | self.state.inputs.keys()):
            if inputs.get(path) != self.state.inputs.get(path):
                raise DriverError(
                    ExitCode.USAGE,
                    f"{self.path}: cannot continue: {path} is not what it was when the passes were rendered: "
                    "choose another --passes-dir",
                )

    def start_clock(self):
        self._started = time.monotonic() - self.state.seconds

    def stop_clock(self):
        """Until it is started again, the clock stands: the loop works on another frame."""
        self.state.seconds, self._started = self.seconds(), None

    def seconds(self):
        """Seconds that the loop has worked on the frame, without the time between a kill and the next run."""
        return self.state.seconds if self._started is None else time.monotonic() - self._started

    def save(self):
        self.state.seconds = self.seconds()
        content = {"version": VERSION, **dataclasses.asdict(self.state)}
        write_text(self.path, json.dumps(content, indent=1, allow_nan=False))


def _decode_state(path):
    content = read_json(path)
    if not isinstance(content, dict) or "version" not in content:
        raise InvalidFileError("it has no version")
    version = content.pop("version")
    if version != VERSION:
        raise DriverError(
            ExitCode.BAD_INPUT,
            f"{path}: written by another version of polyrecon (journal {version!r}, this one reads {VERSION}): "
            "finish the frame with that version, or start again with another --passes-dir",
        )
    state = decode(State, content)
    _check_state(state)
    return state


def _check_state(state):
    """Checks what types alone do not: the loop divides by some of these numbers."""
    if state.first_pass_parts < len(HALVES) or state.first_pass_parts % len(HALVES):
        raise InvalidFileError("first_pass_parts is not a positive multiple of 2")
    for index, part in enumerate(state.parts):
        _check_part(part, f"parts[{index}]")
        if part.first_sample > state.next_sample:
            raise InvalidFileError(f"parts[{index}].first_sample is above next_sample")
    drawn = [part for part in state.parts if part.samples > 0]  # A half may get no sample in a round.
    for name, parts in (("file", state.parts), ("first_sample", drawn)):
        if len({getattr(part, name) for part in parts}) < len(parts):
            raise InvalidFileError(f"two parts have the same {name}")
    if [entry.round for entry in state.rounds] != list(range(len(state.rounds))):
        raise InvalidFileError("rounds are not numbered 0, 1, 2, ...")
    if state.next_round:
        _check_plan(state.next_round, len(state.rounds))


def _check_part(part, place):
    if part.half not in HALVES:
        raise InvalidFileError(f"{place}.half is neither 'a' nor 'b'")
    if not re.fullmatch(rf"part_{part.round}{part.half}[0-9]+\.exr", part.file):
        raise InvalidFileError(f"{place}.file does not match its round and half")
    if part.seconds <= 0:
        raise InvalidFileError(f"{place}.seconds is not above 0")
    if part.masked and part.cost_weighted_samples <= 0:
        raise InvalidFileError(f"{place}.cost_weighted_samples is not above 0")
    if part.round == 0 and (part.masked or min(part.samples, part.cost_weighted_samples) <= 0):
        raise InvalidFileError(f"{place} is of the first pass and not uniform")


def _check_plan(plan, rounds):
    if plan.round > rounds + 1:  # One more than the decisions: a uniform last round is rendered without one.
        raise InvalidFileError("next_round.round does not follow the last round")
    for name in ("first_samples", "counts_sha256"):
        if set(getattr(plan, name)) != set(HALVES):
            raise InvalidFileError(f"next_round.{name} does not name the halves 'a' and 'b'")
    if plan.parts < 1 or plan.cost_weighted_samples <= 0:
        raise InvalidFileError("next_round has no parts or no samples")


def _compare_identities(path, found, wanted):
    for key in sorted(wanted.keys() | found.keys()):
        if found.get(key) != wanted.get(key):
            raise DriverError(
                ExitCode.USAGE,
                f"{path}: cannot continue: {key!r} was {found.get(key)!r}, is {wanted.get(key)!r}: "
                "choose another --passes-dir",
            )


def _check_files(folder, state):
    """The passes are those that the journal was written for."""
    for part in state.parts:
        digests.check(folder.path / part.file, part.sha256)
    if state.next_round:
        for half, expected in state.next_round.counts_sha256.items():
            digests.check(folder.in_round(state.next_round.round, f"counts_{half}"), expected)
