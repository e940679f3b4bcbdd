#include "cli/common/frame_names.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <regex>
#include <set>
#include <system_error>

#include "polyrecon/error.h"

namespace polyrecon {
namespace {

namespace fs = std::filesystem;

constexpr int max_frames = 1000000;

[[noreturn]] void bad_frames(const std::string& text, const std::string& why) {
  throw Error(ExitCode::Usage, fmt::format("--frames {}: {}; write it as 1-10,20-40x2,50", text, why));
}

int number_of(const std::string& all, const std::string& digits) {
  try {
    return std::stoi(digits);
  } catch (const std::out_of_range&) {
    bad_frames(all, digits + " is too large");
  }
}

/// Text with every sign that means something to a regular expression escaped.
std::string literal(const std::string& text) {
  static const std::regex special(R"([.^$|()\[\]{}*+?\\])");
  return std::regex_replace(text, special, R"(\$&)");
}

}  // namespace

std::vector<int> parse_frames(const std::string& text) {
  static const std::regex range(R"((-?\d+)(?:-(-?\d+)(?:x(\d+))?)?)");
  std::vector<int> frames;
  std::set<int> seen;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t comma = std::min(text.find(',', begin), text.size());
    const std::string piece = text.substr(begin, comma - begin);
    begin = comma + 1;
    std::smatch match;
    if (!std::regex_match(piece, match, range)) bad_frames(text, fmt::format("'{}' is no frame or range", piece));
    const int first = number_of(text, match[1]);
    const int last = match[2].matched ? number_of(text, match[2]) : first;
    const int step = match[3].matched ? number_of(text, match[3]) : 1;
    if (step < 1) bad_frames(text, "a step of 0");
    if (last < first) bad_frames(text, fmt::format("'{}' runs backwards", piece));
    for (long long n = first; n <= last; n += step)
      if (seen.insert(static_cast<int>(n)).second) {
        frames.push_back(static_cast<int>(n));
        if (frames.size() > max_frames) bad_frames(text, fmt::format("more than {} frames", max_frames));
      }
  }
  return frames;
}

std::string frames_text(std::vector<int> frames) {
  std::sort(frames.begin(), frames.end());
  std::string text;
  for (std::size_t begin = 0, end = 0; begin < frames.size(); begin = end) {
    for (end = begin + 1; end < frames.size() && frames[end] == frames[end - 1] + 1;) ++end;
    text += fmt::format("{}{}", text.empty() ? "" : ",", frames[begin]);
    if (end > begin + 1) text += fmt::format("{}{}", end > begin + 2 ? "-" : ",", frames[end - 1]);
  }
  return text;
}

std::optional<FramePattern> FramePattern::parse(const std::string& text) {
  std::error_code ignored;
  if (fs::exists(text, ignored)) return std::nullopt;
  static const std::regex place(R"(#+|%(?:0(\d))?d)");
  FramePattern pattern;
  auto rest = text.cbegin();
  for (std::sregex_iterator match(text.begin(), text.end(), place), end; match != end; ++match) {
    pattern.pieces_.emplace_back(rest, (*match)[0].first);
    const bool hash = *(*match)[0].first == '#';
    pattern.digits_.push_back(hash                  ? static_cast<int>((*match)[0].length())
                              : (*match)[1].matched ? std::stoi((*match)[1])
                                                    : 1);
    rest = (*match)[0].second;
  }
  if (pattern.digits_.empty()) return std::nullopt;
  pattern.pieces_.emplace_back(rest, text.cend());
  return pattern;
}

std::string FramePattern::path(int frame) const {
  std::string out = pieces_.front();
  for (std::size_t k = 0; k < digits_.size(); ++k)
    // Negative frames as Blender and Nuke write them: the sign stands before the padded number.
    out += fmt::format("{}{:0{}}{}", frame < 0 ? "-" : "", std::abs(static_cast<long long>(frame)), digits_[k],
                       pieces_[k + 1]);
  return out;
}

std::vector<int> FramePattern::existing_frames() const {
  const std::string shown = path(0);
  std::string expression;
  for (std::size_t k = 0; k < pieces_.size(); ++k) expression += (k ? R"((-?\d+))" : "") + literal(pieces_[k]);
  const fs::path folder = fs::path(shown).parent_path();
  const fs::path here = folder.empty() ? fs::path(".") : folder;
  const std::regex name(expression);
  std::vector<int> frames;
  std::error_code problem;
  for (fs::directory_iterator entry(here, problem), end; !problem && entry != end; entry.increment(problem)) {
    const std::string candidate = (folder / entry->path().filename()).string();
    std::smatch match;
    if (!std::regex_match(candidate, match, name) || match[1].length() > 9) continue;
    const int frame = std::stoi(match[1]);
    if (path(frame) == candidate) frames.push_back(frame);
  }
  if (frames.empty())
    throw Error(ExitCode::Missing, fmt::format("no file like {}: check the folder, or give --frames", shown));
  std::sort(frames.begin(), frames.end());
  return frames;
}

std::optional<int> frame_in_name(const std::string& path) {
  static const std::regex number(R"(^.*?(\d{1,9})\D*$)");
  const std::string stem = fs::path(path).stem().string();
  std::smatch match;
  if (!std::regex_match(stem, match, number)) return std::nullopt;
  return std::stoi(match[1]);
}

}  // namespace polyrecon
