#pragma once

#include <functional>
#include <string>

namespace polyrecon {

/// The only way this program writes a file. Missing folders of target are made. `write` fills a new, empty file next to
/// target, which is then flushed to disk. `verify` reads it back and throws if something differs. Then the file takes
/// target's name, and the folder is flushed. On any failure the new file is removed, target is what it was, and an
/// Error is thrown: the one that write or verify threw, else Error{CannotWrite}. A symbolic or hard link named target
/// is replaced; the file that it leads to is not touched. Files left by a run that was killed are removed when the same
/// target is written again.
void write_atomically(const std::string& target, const std::function<void(const std::string& path)>& write,
                      const std::function<void(const std::string& path)>& verify);

/// Removes the new files of all writes in progress. A signal handler calls it before it ends the process
/// (async-signal-safe).
void remove_temporaries();

/// Writes these bytes, text or other, by write_atomically.
void write_bytes(const std::string& target, const std::string& bytes);

/// Throws Error{CannotWrite} unless a file can be made next to target and take its name, or, where the folder of target
/// is missing, in the nearest folder above it that exists. Leaves nothing behind.
void check_writable(const std::string& target);

}  // namespace polyrecon
