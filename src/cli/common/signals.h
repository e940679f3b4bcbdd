#pragma once

namespace polyrecon {

/// After this call, SIGINT and SIGTERM end the process with exit code 130 or 143 and leave no temporary file. After
/// poll_signals they only request that the work stops; a second signal, or four seconds without effect, ends the
/// process. A reader of standard output that goes away (SIGPIPE) stops nothing, and a file that reaches the limit of
/// its size (SIGXFSZ) fails as one on a full disk does.
void catch_signals();

/// States that the work checks caught_signal() regularly and stops once a signal has arrived.
void poll_signals();

/// The signal that has arrived; 0: none.
int caught_signal();

/// Call it when everything is printed. Throws Error{CannotWrite} where standard output could not be written, for
/// example on a full disk. A reader that has gone away is no error.
void require_output_written();

}  // namespace polyrecon
