#pragma once

#include <string>
#include <vector>

#include "polyrecon/file_info.h"

namespace polyrecon {

/// Name without folder, length and checksum of a file: "shot.0001.exr, 81234 bytes, xxh64 01ab...". The identity does
/// not depend on the folder or the time of the file. Throws Error{Missing} if there is no such file, Error{BadInput} if
/// it cannot be read.
std::string file_identity(const std::string& path);

/// The identities of several files that one frame was read from, joined by "; ". Throws as file_identity.
std::string files_identity(const std::vector<FileInfo>& files);

/// The stamp of a file as it is now; an empty one where there is none.
FileStamp stamp_of(const std::string& path);

/// Throws Error{BadInput} unless the file is still the one that was described.
void require_unchanged(const FileInfo& file);

}  // namespace polyrecon
