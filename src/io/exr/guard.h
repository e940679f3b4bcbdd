#pragma once

#include <OpenEXR/ImfHeader.h>

#include <cstdint>
#include <string>
#include <vector>

#include "polyrecon/file_info.h"

namespace polyrecon {

/// Walks the attribute lists of an EXR file without keeping anything, and returns where they end (the chunk tables
/// begin there). OpenEXR allocates what an attribute's size field says before it reads, so a hostile size has to be
/// refused first. Throws Error{BadInput}.
std::uint64_t check_attribute_sizes(const std::string& path, std::uint64_t file_bytes);

/// Compares windows, tiles, channels and chunk counts of headers that were parsed with limits and with the length of
/// the file: pixels cannot be packed more tightly than their compression allows, and every chunk has 8 bytes in the
/// table and 8 of its own. Throws Error{BadInput}: too large, or "incomplete".
void check_claims(const std::string& path, std::uint64_t file_bytes, const std::vector<Imf::Header>& headers,
                  const ReadLimits& limits);

}  // namespace polyrecon
