#pragma once

#include <string>

namespace polyrecon::fuzz {

/// Does with a file that nobody vouches for what the program does with one: describes, inspects and reads it, writes it
/// again with its beauty replaced, merges it with its copy. An Error is an answer; any other exception goes through,
/// and so does an Error that blames the program (Internal) or memory beyond 512 MB (OutOfMemory). folder takes what is
/// written.
void read_stranger(const std::string& path, const std::string& folder);

}  // namespace polyrecon::fuzz
