#include "html/page.h"

#include <fmt/format.h>

#include <cstddef>
#include <string_view>

#include "core/utf8.h"

namespace polyrecon {
namespace {

constexpr const char* style = R"(
:root{color-scheme:light dark;--ground:#fff;--text:#1d2129;--soft:#69707d;--line:#d9dde3;--shade:#f4f6f8}
@media (prefers-color-scheme:dark){:root{--ground:#16181c;--text:#e4e6ea;--soft:#9aa1ad;--line:#363b44;--shade:#1f2228}}
*{box-sizing:border-box}
body{margin:2rem auto;padding:0 1rem;background:var(--ground);color:var(--text);
 font:15px/1.5 system-ui,"Segoe UI","DejaVu Sans",sans-serif}
h1{font-size:1.5rem;margin:0 0 .2rem}h2{font-size:1.15rem;margin:2.4rem 0 .4rem}
p{margin:.3rem 0}.soft{color:var(--soft)}
.table{overflow-x:auto}table{border-collapse:collapse;font-variant-numeric:tabular-nums}
th,td{padding:.25rem .7rem;text-align:right;border-bottom:1px solid var(--line);white-space:nowrap}
th{color:var(--soft);font-weight:600}th:first-child,td:first-child,th.text,td.text{text-align:left}
)";

/// The entity for a character with a meaning in HTML; empty for others.
std::string_view entity_of(char32_t code) {
  switch (code) {
    case '&':
      return "&amp;";
    case '<':
      return "&lt;";
    case '>':
      return "&gt;";
    case '"':
      return "&quot;";
    case '\'':
      return "&#39;";
    default:
      return {};
  }
}

}  // namespace

std::string escaped(const std::string& text) {
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const CodePoint point = code_point_at(text, at);
    const bool shown = point.valid && (!is_control(point.code) || point.code == '\n');
    const std::string_view entity = shown ? entity_of(point.code) : "&#xfffd;";
    entity.empty() ? out.append(text, at, point.bytes) : out.append(entity);
    at += point.bytes;
  }
  return out;
}

std::string page_head(const std::string& title, int width, const std::string& rules) {
  return fmt::format(
      "<!DOCTYPE html>\n<html lang='en'><head><meta charset='utf-8'>"
      "<meta name='viewport' content='width=device-width,initial-scale=1'><title>{}</title>"
      "<style>{}body{{max-width:{}px}}\n{}</style></head><body>\n",
      escaped(title), style, width, rules);
}

std::string page_end() { return "</body></html>\n"; }

}  // namespace polyrecon
