#include "cli/common/frame_names.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <regex>
#include <set>
#include <stdexcept>
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

std::string without_spaces_around(const std::string& text) {
  const std::size_t first = text.find_first_not_of(' ');
  return first == std::string::npos ? std::string() : text.substr(first, text.find_last_not_of(' ') - first + 1);
}

struct FrameRange {
  long long first, last, step;
};

FrameRange parse_range(const std::string& all, const std::string& piece) {
  static const std::regex range(R"((-?[0-9]+)(?:-(-?[0-9]+)(?:[x:]([0-9]+))?)?)");
  std::smatch match;
  if (!std::regex_match(piece, match, range))
    bad_frames(all, fmt::format("'{}' is neither a frame nor a range", piece));
  const int first = number_of(all, match[1]);
  const int last = match[2].matched ? number_of(all, match[2]) : first;
  const int step = match[3].matched ? number_of(all, match[3]) : 1;
  if (step < 1) bad_frames(all, fmt::format("the step of '{}' is 0", piece));
  if (last < first) bad_frames(all, fmt::format("'{}' runs backwards", piece));
  return {first, last, step};
}

/// A place for a frame's number; C's format may have one digit that sets the length.
const std::regex& place_of_number() {
  static const std::regex place(R"(#+|%(?:0([1-9]))?d)");
  return place;
}

}  // namespace

std::vector<int> parse_frames(const std::string& text) {
  std::vector<int> frames;
  std::set<int> seen;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t comma = std::min(text.find(',', begin), text.size());
    const FrameRange range = parse_range(text, without_spaces_around(text.substr(begin, comma - begin)));
    begin = comma + 1;
    for (long long n = range.first; n <= range.last; n += range.step)
      if (seen.insert(static_cast<int>(n)).second) {
        frames.push_back(static_cast<int>(n));
        if (frames.size() > max_frames) bad_frames(text, fmt::format("there are more than {} frames", max_frames));
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
  const auto name_begins = static_cast<std::ptrdiff_t>(text.rfind('/') + 1);  // 0 where there is no folder
  const std::sregex_iterator first(text.begin(), text.end(), place_of_number()), end;
  std::optional<std::smatch> last;
  for (auto place = first; place != end; ++place)
    if (place->position() >= name_begins) last = *place;
  if (!last) return std::nullopt;
  FramePattern pattern;
  pattern.sign_counts_ = last->str().front() == '%';
  pattern.width_ = !pattern.sign_counts_ ? static_cast<int>(last->length())
                   : (*last)[1].matched  ? std::stoi((*last)[1])
                                         : 1;
  std::size_t done = 0;
  for (auto place = first; place != end; ++place) {
    if (place->str() != last->str()) continue;
    const auto at = static_cast<std::size_t>(place->position());
    pattern.pieces_.push_back(text.substr(done, at - done));
    done = at + static_cast<std::size_t>(place->length());
    pattern.in_folder_ = pattern.in_folder_ || place->position() < name_begins;
  }
  pattern.pieces_.push_back(text.substr(done));
  return pattern;
}

std::string FramePattern::number(int frame) const {
  if (sign_counts_) return fmt::format("{:0{}}", frame, width_);
  return fmt::format("{}{:0{}}", frame < 0 ? "-" : "", std::abs(static_cast<long long>(frame)), width_);
}

std::string FramePattern::path(int frame) const {
  std::string out = pieces_.front();
  for (std::size_t k = 1; k < pieces_.size(); ++k) out += number(frame) + pieces_[k];
  return out;
}

std::optional<int> FramePattern::frame_of(const std::string& candidate) const {
  const std::size_t begin = pieces_.front().size();
  if (candidate.compare(0, begin, pieces_.front()) != 0) return std::nullopt;
  std::size_t end = candidate.find_first_not_of("0123456789", begin + (candidate.substr(begin, 1) == "-" ? 1 : 0));
  // Digits that follow the place in the pattern are no part of the number.
  for (end = std::min(end, candidate.size()); end > begin; --end) try {
      const int frame = std::stoi(candidate.substr(begin, end - begin));
      if (path(frame) == candidate) return frame;
    } catch (const std::logic_error&) {  // no number, or one that is too large
    }
  return std::nullopt;
}

std::vector<int> FramePattern::existing_frames() const {
  const std::string shown = path(0);
  if (in_folder_)
    throw Error(ExitCode::Usage, fmt::format("{}: the folder's name has the frame's number too: give --frames", shown));
  const fs::path folder = fs::path(shown).parent_path();
  std::vector<int> frames;
  std::error_code problem;
  const fs::directory_iterator none;
  for (fs::directory_iterator entry(folder.empty() ? fs::path(".") : folder, problem); !problem && entry != none;
       entry.increment(problem))
    if (const auto frame = frame_of((folder / entry->path().filename()).string())) frames.push_back(*frame);
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
