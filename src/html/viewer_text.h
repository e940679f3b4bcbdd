#pragma once

namespace polyrecon {

/// The files of html/viewer/, which the build puts into the program.
struct ViewerText {
  const char* page;        ///< page.html, with places such as %TITLE%.
  const char* viewer;      ///< viewer.html
  const char* style;       ///< viewer.css
  const char* script;      ///< All scripts as one.
  const char* style_hash;  ///< SHA-256 in hexadecimal digits.
  const char* script_hash;
};

extern const ViewerText viewer_text;

}  // namespace polyrecon
