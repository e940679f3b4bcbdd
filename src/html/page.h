#pragma once

#include <string>

namespace polyrecon {

/// Escapes text for HTML and SVG, also for the inside of attributes.
std::string escaped(const std::string& text);

/// The beginning of an HTML page, up to the start of its body. The style sheet sets text, headings and tables for light
/// and dark screens; `rules` (CSS) follow it. width: of the text, in pixels. title: plain text.
std::string page_head(const std::string& title, int width, const std::string& rules);

/// The end of the page.
std::string page_end();

}  // namespace polyrecon
