#include "io/pictures/preview.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imagebufalgo.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "io/pictures/false_color.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

constexpr int gap = 8, text_size = 14, strip_height = 22, legend_height = 12;
constexpr float ground = 0.09f;
constexpr std::array<float, 3> text_color{0.9f, 0.9f, 0.9f};

std::array<float, 3> pixel_of(const Image& rgb, int x, int y) {
  return {static_cast<float>(rgb.at(x, y, 0)), static_cast<float>(rgb.at(x, y, 1)),
          static_cast<float>(rgb.at(x, y, 2))};
}

OIIO::ImageBuf buffer_of(const Image& rgb) {
  OIIO::ImageBuf buffer(OIIO::ImageSpec(rgb.width(), rgb.height(), 3, OIIO::TypeDesc::FLOAT));
  for (int y = 0; y < rgb.height(); ++y)
    for (int x = 0; x < rgb.width(); ++x) {
      const std::array<float, 3> pixel = pixel_of(rgb, x, y);
      buffer.setpixel(x, y, pixel.data(), 3);
    }
  return buffer;
}

/// The first font that this machine can render with; empty where there is none. Distributions do not agree on a path.
const std::string& font() {
  static const std::string found = [] {
    for (const char* name : {"DejaVuSans", "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
                             "/usr/share/fonts/dejavu-sans-fonts/DejaVuSans.ttf", "/usr/share/fonts/TTF/DejaVuSans.ttf",
                             "OpenSans", "DroidSans", "Arial", "Helvetica"})
      if (OIIO::ImageBufAlgo::text_size("x", text_size, name).defined()) return std::string(name);
    return std::string();
  }();
  return found;
}

/// Pixels that text takes from left to right; 0 where there is no font.
int text_width(const std::string& text) {
  return font().empty() ? 0 : OIIO::ImageBufAlgo::text_size(text, text_size, font()).width();
}

enum class Align { Left, Right };

/// text at x (its left or right end), cut to width pixels, on the strip whose top is y.
void draw_text(OIIO::ImageBuf& image, std::string text, int x, int y, int width, Align align) {
  if (font().empty()) return;
  while (!text.empty() && text_width(text) > width) text.pop_back();
  if (text.empty()) return;
  const int left = align == Align::Left ? x : x - text_width(text);
  OIIO::ImageBufAlgo::render_text(image, left, y + text_size + (strip_height - text_size) / 2 - 2, text, text_size,
                                  font(), text_color);
}

/// The scale of a false-colour picture: the colours from low to high, below them these two numbers and the powers of
/// ten between, where there is room. A scale that is too narrow for the two numbers has none.
void draw_legend(OIIO::ImageBuf& image, const LogRange& range, int x, int y, int width) {
  Image scale(width, 1, 1);
  for (int i = 0; i < width; ++i)
    scale.at(i, 0, 0) = static_cast<Real>(
        range.low * std::pow(range.high / range.low, i / std::max(1.0, static_cast<double>(width - 1))));
  const Image colors = false_color(scale, range);
  for (int i = 0; i < width; ++i) {
    const std::array<float, 3> pixel = pixel_of(colors, i, 0);
    for (int row = 0; row < legend_height; ++row) image.setpixel(x + i, y + row, pixel.data(), 3);
  }
  const int below = y + legend_height;
  const std::string low = fmt::format("{:.3g}", range.low), high = fmt::format("{:.3g}", range.high);
  if (text_width(low) + gap + text_width(high) > width) return;
  draw_text(image, low, x, below, width, Align::Left);
  draw_text(image, high, x + width, below, width, Align::Right);
  if (range.high <= range.low) return;
  int taken = x + text_width(low) + gap;
  const int end = x + width - text_width(high) - gap;
  for (double power = std::ceil(std::log10(range.low)); std::pow(10, power) < range.high; ++power) {
    const double value = std::pow(10, power), at = std::log(value / range.low) / std::log(range.high / range.low);
    const int tick = x + static_cast<int>(at * (width - 1));
    const std::string text = fmt::format("{:g}", value);
    const int length = text_width(text), left = tick - length / 2;
    if (left < taken || left + length > end) continue;
    const std::array<float, 3> dark{ground, ground, ground};
    for (int row = legend_height / 2; row < legend_height; ++row) image.setpixel(tick, y + row, dark.data(), 3);
    draw_text(image, text, left, below, length, Align::Left);
    taken = left + length + gap;
  }
}

void check_size(std::size_t width, std::size_t height) {
  if (width * height > most_pixels_of_preview)
    throw Error(ExitCode::OutOfMemory,
                fmt::format("the preview would be {} x {} pixels: give fewer files", width, height));
}

struct Layout {
  int width = 0, height = 0, pictures = 0, captions = 0, margin = 0;
};

Layout lay_out(const std::vector<Panel>& panels) {
  Layout l;
  bool legends = false;
  for (const Panel& p : panels) {
    l.pictures = std::max(l.pictures, p.rgb.height());
    if (!p.caption.empty()) l.captions = std::max(l.captions, strip_height);
    if (!p.figures.empty()) l.captions = 2 * strip_height;
    legends = legends || p.range.high > 0;
  }
  const bool bare = panels.size() == 1 && l.captions == 0 && !legends;
  l.margin = bare ? 0 : gap;
  std::size_t width = static_cast<std::size_t>(l.margin) * (panels.size() + 1);
  for (const Panel& p : panels) width += static_cast<std::size_t>(p.rgb.width());
  const int below = l.captions + (legends ? legend_height + strip_height + gap : 0);
  const auto height = static_cast<std::size_t>(l.pictures) + static_cast<std::size_t>(below + 2 * l.margin);
  check_size(width, height);
  l.width = static_cast<int>(width);
  l.height = static_cast<int>(height);
  return l;
}

}  // namespace

Image compose(const std::vector<Panel>& panels) {
  const Layout l = lay_out(panels);
  OIIO::ImageBuf sheet(OIIO::ImageSpec(l.width, l.height, 3, OIIO::TypeDesc::FLOAT));
  OIIO::ImageBufAlgo::fill(sheet, std::array<float, 3>{ground, ground, ground});
  int x = l.margin;
  for (const Panel& p : panels) {
    OIIO::ImageBufAlgo::paste(sheet, x, l.margin, 0, 0, buffer_of(p.rgb));
    const int below = l.margin + l.pictures;
    draw_text(sheet, p.caption, x, below, p.rgb.width(), Align::Left);
    draw_text(sheet, p.figures, x, below + strip_height, p.rgb.width(), Align::Left);
    if (p.range.high > 0) draw_legend(sheet, p.range, x, below + l.captions + gap, p.rgb.width());
    x += p.rgb.width() + l.margin;
  }
  Image out(l.width, l.height, 3);
  for (int y = 0; y < l.height; ++y)
    for (int column = 0; column < l.width; ++column)
      for (int c = 0; c < 3; ++c) out.at(column, y, c) = sheet.getchannel(column, y, 0, c);
  return out;
}

Image stack(const std::vector<Image>& rows) {
  std::size_t width = 0, height = 0;
  for (const Image& row : rows) {
    width = std::max(width, static_cast<std::size_t>(row.width()));
    height += static_cast<std::size_t>(row.height());
  }
  check_size(width, height);
  Image out(static_cast<int>(width), static_cast<int>(height), 3, ground);
  int y = 0;
  for (const Image& row : rows) {
    paste(row, row.bounds(), out, 0, y);
    y += row.height();
  }
  return out;
}

bool has_font() { return !font().empty(); }

std::string encode_picture(const Image& rgb, const std::string& format) {
  OIIO::Filesystem::IOVecOutput memory;
  OIIO::ImageBuf buffer = buffer_of(rgb);
  buffer.set_write_ioproxy(&memory);
  buffer.set_write_format(OIIO::TypeDesc::UINT8);
  if (format != "png") buffer.specmod().attribute("compression", format == "jpeg" ? "jpeg:95" : "zip");
  if (!buffer.write("memory." + format, OIIO::TypeDesc::UNKNOWN, format))
    throw Error(ExitCode::Internal, "a picture cannot be made into " + format + ": " + buffer.geterror());
  return {memory.buffer().begin(), memory.buffer().end()};
}

}  // namespace polyrecon
