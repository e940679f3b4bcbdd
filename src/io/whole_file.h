#pragma once

#include <functional>
#include <string>

namespace polyrecon {

/// Calls write with the name of a temporary file beside target, flushes what it wrote to the disk and renames it to
/// target, so that target is always the old or the new file, whole. The temporary is removed where write throws.
/// Throws Error{CannotWrite}.
void write_whole(const std::string& target, const std::function<void(const std::string& temporary)>& write);

/// Writes a text file that way.
void write_text(const std::string& target, const std::string& text);

}  // namespace polyrecon
