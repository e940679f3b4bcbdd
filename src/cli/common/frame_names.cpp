#include "cli/common/frame_names.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <stdexcept>
#include <string_view>
#include <system_error>

#include "polyrecon/error.h"

namespace polyrecon {
namespace {

namespace fs = std::filesystem;

constexpr int most_likely_digits = 8;
constexpr int max_frames = 1000000;
constexpr std::size_t max_width = 255;  // NAME_MAX of Linux

[[noreturn]] void bad_frames(const std::string& text, const std::string& why) {
  throw Error(ExitCode::Usage, fmt::format("--frames {}: {}; write it as 1-10,20-40x2,50", text, why));
}

std::string without_spaces_around(const std::string& text) {
  const std::size_t first = text.find_first_not_of(' ');
  return first == std::string::npos ? std::string() : text.substr(first, text.find_last_not_of(' ') - first + 1);
}

struct FrameRange {
  long long first, last, step;
};

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Reads the parts of a piece of --frames from left to right.
class RangeReader {
 public:
  RangeReader(const std::string& all, const std::string& piece) : all_(all), piece_(piece), rest_(piece) {}

  int number() {
    int value = 0;
    const auto [end, problem] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), value);
    if (problem == std::errc::invalid_argument) fail();
    const auto length = static_cast<std::size_t>(end - rest_.data());
    if (problem == std::errc::result_out_of_range)
      bad_frames(all_, fmt::format("{} is too large", rest_.substr(0, length)));
    rest_.remove_prefix(length);
    return value;
  }
  int count() { return !rest_.empty() && is_digit(rest_.front()) ? number() : fail(); }
  bool take(std::string_view any_of) {
    if (rest_.empty() || any_of.find(rest_.front()) == std::string_view::npos) return false;
    rest_.remove_prefix(1);
    return true;
  }
  void end() const {
    if (!rest_.empty()) fail();
  }

 private:
  [[noreturn]] int fail() const { bad_frames(all_, fmt::format("'{}' is neither a frame nor a range", piece_)); }

  const std::string &all_, &piece_;
  std::string_view rest_;
};

FrameRange parse_range(const std::string& all, const std::string& piece) {
  RangeReader reader(all, piece);
  const int first = reader.number();
  const bool is_range = reader.take("-");
  const int last = is_range ? reader.number() : first;
  const int step = is_range && reader.take("x:") ? reader.count() : 1;
  reader.end();
  if (step < 1) bad_frames(all, fmt::format("the step of '{}' is 0", piece));
  if (last < first) bad_frames(all, fmt::format("'{}' runs backwards", piece));
  return {first, last, step};
}

/// A place for a frame's number: #, ## ..., or C's format %d, which may have one digit that sets the length.
struct Place {
  std::size_t begin = 0, length = 0;
  int width = 1;  ///< Digits of the number.
};

/// The first place from `begin` on; its length is 0 where there is none.
Place find_place(const std::string& text, std::size_t begin) {
  for (begin = text.find_first_of("#%", begin); begin != std::string::npos;
       begin = text.find_first_of("#%", begin + 1)) {
    if (text[begin] == '#') {
      const std::size_t length = std::min(text.find_first_not_of('#', begin), text.size()) - begin;
      if (length > max_width)
        throw Error(
            ExitCode::Usage,
            fmt::format("a name has {} # in a row; {} are the most that a file's name can have", length, max_width));
      return {begin, length, static_cast<int>(length)};
    }
    if (text.compare(begin, 2, "%d") == 0) return {begin, 2, 1};
    if (text.compare(begin, 2, "%0") == 0 && text.size() > begin + 3 && is_digit(text[begin + 2]) &&
        text[begin + 2] != '0' && text[begin + 3] == 'd')
      return {begin, 4, text[begin + 2] - '0'};
  }
  return {};
}

std::vector<Place> places_in(const std::string& text, std::size_t begin) {
  std::vector<Place> places;
  for (Place place = find_place(text, begin); place.length > 0; place = find_place(text, place.begin + place.length))
    places.push_back(place);
  return places;
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

std::string file_name(const std::string& path) { return fs::path(path).filename().string(); }

std::optional<std::size_t> number_begin(const std::string& name) {
  const std::vector<Place> places = places_in(name, 0);
  if (places.empty()) return std::nullopt;
  return places.back().begin;
}

std::optional<FramePattern> FramePattern::parse(const std::string& text) {
  std::error_code ignored;
  if (fs::exists(text, ignored)) return std::nullopt;
  const std::size_t name_begins = text.rfind('/') + 1;  // 0 where there is no folder
  const std::vector<Place> in_name = places_in(text, name_begins);
  if (in_name.empty()) return std::nullopt;
  const Place& last = in_name.back();
  const std::string number = text.substr(last.begin, last.length);
  FramePattern pattern;
  pattern.sign_counts_ = number.front() == '%';
  pattern.width_ = last.width;
  const bool is_folder = name_begins > 0 && fs::is_directory(text.substr(0, name_begins), ignored);
  std::size_t done = 0;
  for (const Place& place : places_in(text, is_folder ? name_begins : 0)) {
    if (text.compare(place.begin, place.length, number) != 0) continue;
    pattern.pieces_.push_back(text.substr(done, place.begin - done));
    done = place.begin + place.length;
    pattern.in_folder_ = pattern.in_folder_ || place.begin < name_begins;
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

std::string FramePattern::other_width(const fs::path& folder) const {
  std::error_code problem;
  for (const auto& entry : fs::directory_iterator(folder.empty() ? fs::path(".") : folder, problem))
    for (int width = 1; width <= most_likely_digits; ++width) {
      FramePattern other = *this;
      other.width_ = width;
      const std::string file = (folder / entry.path().filename()).string();
      if (other.frame_of(file))
        return fmt::format(
            "there is {}, so write {}, or ", file,
            sign_counts_ ? fmt::format("%0{}d", width) : std::string(static_cast<std::size_t>(width), '#'));
    }
  return "";
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
    throw Error(ExitCode::Missing,
                fmt::format("no file like {}: {}check the folder, or give --frames", shown, other_width(folder)));
  std::sort(frames.begin(), frames.end());
  return frames;
}

std::optional<int> frame_in_name(const std::string& path) {
  constexpr std::size_t most_digits = 9;  // that an int holds
  const std::string stem = fs::path(path).stem().string();
  const std::size_t last = stem.find_last_of("0123456789");
  if (last == std::string::npos) return std::nullopt;
  std::size_t first = last;
  while (first > 0 && is_digit(stem[first - 1]) && last - first + 1 < most_digits) --first;
  return std::stoi(stem.substr(first, last - first + 1));
}

}  // namespace polyrecon
