#pragma once

namespace polyrecon {

/// From here on SIGINT and SIGTERM end the process with 130 or 143 and leave no temporary file: at once, or, where the
/// running work asks for signals itself (poll_signals), by asking it to stop; should it not within four seconds, or at
/// a second signal, the process ends all the same. A reader of our output that goes away (SIGPIPE) stops no work.
void catch_signals();

/// The work from here on asks caught_signal() now and then, and stops when one arrived.
void poll_signals();

/// The signal that arrived, 0 before.
int caught_signal();

/// To be called once everything is printed. Throws Error{CannotWrite} where standard output could not be written, on a
/// full disk for example; that its reader has gone is no error.
void require_output_written();

}  // namespace polyrecon
