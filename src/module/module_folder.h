#pragma once

#include <filesystem>

namespace polyrecon {

/// The folder of modules that are loaded while the process runs. It has a fixed place relative to the program or the
/// library that contains this function, so that both can be moved together.
std::filesystem::path module_folder();

}  // namespace polyrecon
