#pragma once

#include <CLI/CLI.hpp>
#include <cstddef>

#include "io/pictures/color.h"

namespace polyrecon {

/// Adds --view and --exposure.
void add_display_options(CLI::App& app, DisplayParams& display);

/// The limit of a page unless --max-size sets another: browsers open files of this size within seconds.
constexpr std::size_t default_page_size = std::size_t{512} << 20;

/// Adds --max-size for commands that write a page with pictures.
void add_page_size(CLI::App& app, std::size_t& bytes);

}  // namespace polyrecon
