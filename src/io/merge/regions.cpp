#include "io/merge/regions.h"

#include <algorithm>
#include <array>
#include <functional>
#include <set>

#include "core/parallel.h"
#include "core/rect.h"
#include "io/files/channel_reader.h"

namespace polyrecon {
namespace {

/// A render is looked at closely if it is black in this share of the pixels of a line that others show.
constexpr double suspicious_share = 1.0 / 32;

/// Pixels that others show beyond a side of a box, by which a render that is black there by chance is distinguished
/// from one that ends there: the chance of none where 16 are expected is below 2 % even if pixels are lit four at a
/// time.
constexpr double beyond_chance = 16;

using Row = std::vector<char>;  ///< For each pixel of a line of the beauty's part whether it is not black.

Rect part_window(const ShownPart& render) {
  return render.file->parts[static_cast<std::size_t>(render.part)].data_window;
}

/// Whether any channel of each pixel is not 0. samples: planes of `stride` pixels.
Row lit(const float* samples, std::size_t stride, std::size_t channels, int width) {
  Row row(static_cast<std::size_t>(width), 0);
  for (std::size_t c = 0; c < channels; ++c)
    for (std::size_t x = 0; x < row.size(); ++x)
      if (samples[c * stride + x] != 0) row[x] = 1;
  return row;
}

/// Calls each(y, row) for all lines of a render's beauty.
void for_each_row(const ShownPart& render, const std::function<void(int, const Row&)>& each) {
  const Rect window = part_window(render);
  const auto width = static_cast<std::size_t>(window.width());
  read_bands(*render.file, render.part, render.channels, [&](const Band& band) {
    for (std::size_t i = 0; i < band.pixels; i += width)
      each(window.y0 + static_cast<int>((band.first_pixel + i) / width),
           lit(band.samples.data() + i, band.pixels, render.channels.size(), window.width()));
  });
}

/// One line of a render's beauty; empty where its window has none.
Row row_of(const ShownPart& render, int y) {
  const Rect window = part_window(render);
  if (y < window.y0 || y >= window.y1) return {};
  ChannelReader reader(*render.file, render.part, render.channels);
  const auto width = static_cast<std::size_t>(window.width());
  return lit(reader.read(y, y + 1).data(), width, render.channels.size(), window.width());
}

/// The smallest box of the pixels that are not black; the window where all are.
Rect lit_box(const ShownPart& render) {
  const Rect window = part_window(render);
  Rect box;
  for_each_row(render, [&](int y, const Row& row) {
    const auto first = std::find(row.begin(), row.end(), 1);
    if (first == row.end()) return;
    const auto last = std::find(row.rbegin(), row.rend(), 1);
    box = bounding(box, {window.x0 + static_cast<int>(first - row.begin()), y,
                         window.x1 - static_cast<int>(last - row.rbegin()), y + 1});
  });
  return box.empty() ? render.window : box;
}

/// Whether some render is black in a part of the frame that others show, by three lines of the picture.
bool some_may_be_black(const std::vector<ShownPart>& renders, const Rect& all) {
  for (const int y : {all.y0, all.y0 + all.height() / 2, all.y1 - 1}) {
    std::vector<Row> rows(renders.size());
    in_parallel(renders.size(), [&](std::size_t k) { rows[k] = row_of(renders[k], y); });
    std::vector<std::size_t> shown(static_cast<std::size_t>(all.width()), 0);
    const auto offset = [&](std::size_t k) { return static_cast<std::size_t>(part_window(renders[k]).x0 - all.x0); };
    for (std::size_t k = 0; k < rows.size(); ++k)
      for (std::size_t x = 0; x < rows[k].size(); ++x) shown[offset(k) + x] += rows[k][x] != 0;
    for (std::size_t k = 0; k < rows.size(); ++k) {
      std::size_t by_others = 0, missing = 0;
      for (std::size_t x = 0; x < rows[k].size(); ++x) {
        const bool other = shown[offset(k) + x] > (rows[k][x] != 0 ? 1U : 0U);
        by_others += other;
        missing += other && rows[k][x] == 0;
      }
      if (missing > 0 && static_cast<double>(missing) >= suspicious_share * static_cast<double>(by_others)) return true;
    }
  }
  return false;
}

/// Whether two boxes show the same region of the frame. Boxes of noisy renders differ by a few pixels; regions of a
/// frame have at most margins in common.
bool same_region(const Rect& a, const Rect& b) { return 2 * intersect(a, b).area() >= std::min(a.area(), b.area()); }

/// For each box the index of the first one of its group.
std::vector<std::size_t> groups_of(const std::vector<Rect>& boxes) {
  std::vector<std::size_t> group(boxes.size());
  for (std::size_t k = 0; k < boxes.size(); ++k) {
    group[k] = k;
    for (std::size_t i = 0; i < k; ++i)
      if (group[i] != group[k] && same_region(boxes[i], boxes[k])) {
        const std::size_t joined = std::min(group[i], group[k]), other = std::max(group[i], group[k]);
        std::replace(group.begin(), group.begin() + static_cast<std::ptrdiff_t>(k) + 1, other, joined);
      }
  }
  return group;
}

/// The samples of the other renders of a group in the area between one side of a box and that of the group.
struct Beyond {
  Rect area;
  std::size_t shown = 0, lit = 0;  ///< Pixels of all other renders together, and those that are not black.

  /// Whether the picture goes on there: half of the pixels are not black, or more than chance explains; or no render
  /// shows any.
  bool goes_on() const {
    const double renders = std::max(1.0, static_cast<double>(shown) / static_cast<double>(area.area()));
    return 2 * lit >= shown || static_cast<double>(lit) >= beyond_chance * renders;
  }
};

using Sides = std::array<Beyond, 4>;  ///< Left, right, top, bottom.

Sides sides_of(const Rect& box, const Rect& group) {
  return {{{{group.x0, box.y0, box.x0, box.y1}},
           {{box.x1, box.y0, group.x1, box.y1}},
           {{box.x0, group.y0, box.x1, box.y0}},
           {{box.x0, box.y1, box.x1, group.y1}}}};
}

/// Adds what a render shows to the sides of the others.
void add_shown(const ShownPart& render, const std::vector<Beyond*>& sides) {
  const Rect part = part_window(render);
  for (Beyond* side : sides) side->shown += intersect(side->area, render.window).area();
  std::vector<std::size_t> before(static_cast<std::size_t>(part.width()) + 1, 0);  // pixels that are not black
  for_each_row(render, [&](int y, const Row& row) {
    for (std::size_t x = 0; x < row.size(); ++x) before[x + 1] = before[x] + (row[x] != 0 ? 1 : 0);
    for (Beyond* side : sides) {
      const Rect common = intersect(side->area, part);
      if (y < common.y0 || y >= common.y1 || common.x0 >= common.x1) continue;
      side->lit +=
          before[static_cast<std::size_t>(common.x1 - part.x0)] - before[static_cast<std::size_t>(common.x0 - part.x0)];
    }
  });
}

/// The pixels that each render has samples for: those of the group, but for the sides of its box at which the picture
/// goes on.
std::vector<Rect> without_cut_sides(const std::vector<ShownPart>& renders, const std::vector<Rect>& boxes,
                                    const std::vector<std::size_t>& members, const Rect& group) {
  std::vector<Sides> sides;
  sides.reserve(members.size());
  for (const std::size_t k : members) sides.push_back(sides_of(boxes[k], group));
  for (std::size_t i = 0; i < members.size(); ++i) {
    std::vector<Beyond*> others;
    for (std::size_t k = 0; k < members.size(); ++k)
      for (Beyond& side : sides[k])
        if (k != i && !side.area.empty()) others.push_back(&side);
    add_shown(renders[members[i]], others);
  }
  std::vector<Rect> rects;
  rects.reserve(members.size());
  for (std::size_t i = 0; i < members.size(); ++i) {
    const Rect& box = boxes[members[i]];
    const auto edge = [&](std::size_t side, int of_box, int of_group) {
      return !sides[i][side].area.empty() && sides[i][side].goes_on() ? of_box : of_group;
    };
    rects.push_back(
        {edge(0, box.x0, group.x0), edge(2, box.y0, group.y0), edge(1, box.x1, group.x1), edge(3, box.y1, group.y1)});
  }
  return rects;
}

}  // namespace

std::vector<Region> find_regions(const std::vector<ShownPart>& renders) {
  std::vector<Rect> boxes;
  Rect all;
  for (const ShownPart& render : renders) {
    boxes.push_back(render.window);
    all = bounding(all, render.window);
  }
  const bool by_light = some_may_be_black(renders, all);
  if (by_light) in_parallel(renders.size(), [&](std::size_t k) { boxes[k] = lit_box(renders[k]); });
  const std::vector<std::size_t> groups = groups_of(boxes);
  std::vector<Region> regions(renders.size());
  for (std::size_t g = 0; g < renders.size(); ++g) {
    std::vector<std::size_t> members;
    Rect of_boxes, of_windows;
    for (std::size_t k = g; k < renders.size(); ++k) {
      if (groups[k] != g) continue;
      members.push_back(k);
      of_boxes = bounding(of_boxes, boxes[k]);
      of_windows = bounding(of_windows, renders[k].window);
    }
    const Rect group = members.size() == renders.size() ? of_windows : of_boxes;
    std::vector<Rect> rects(members.size(), group);
    if (std::any_of(members.begin(), members.end(), [&](std::size_t k) { return !(boxes[k] == group); }))
      rects = without_cut_sides(renders, boxes, members, group);
    for (std::size_t i = 0; i < members.size(); ++i) regions[members[i]] = {rects[i], g, i};
  }
  return regions;
}

double share_of_single_cover(const std::vector<Rect>& rects) {
  std::set<int> columns, rows;
  for (const Rect& r : rects) {
    columns.insert({r.x0, r.x1});
    rows.insert({r.y0, r.y1});
  }
  const std::vector<int> x(columns.begin(), columns.end()), y(rows.begin(), rows.end());
  const auto place = [](const std::vector<int>& edges, int edge) {
    return static_cast<std::size_t>(std::lower_bound(edges.begin(), edges.end(), edge) - edges.begin());
  };
  std::vector<std::vector<int>> steps(y.size(), std::vector<int>(x.size(), 0));  // of the numbers of rectangles
  for (const Rect& r : rects) {
    ++steps[place(y, r.y0)][place(x, r.x0)];
    --steps[place(y, r.y0)][place(x, r.x1)];
    --steps[place(y, r.y1)][place(x, r.x0)];
    ++steps[place(y, r.y1)][place(x, r.x1)];
  }
  double covered = 0, single = 0;
  std::vector<int> above(x.size(), 0);
  for (std::size_t j = 0; j + 1 < y.size(); ++j) {
    int count = 0;
    for (std::size_t i = 0; i + 1 < x.size(); ++i) {
      above[i] += steps[j][i];
      count += above[i];
      const double area = (static_cast<double>(x[i + 1]) - x[i]) * (static_cast<double>(y[j + 1]) - y[j]);
      if (count > 0) covered += area;
      if (count == 1) single += area;
    }
  }
  return covered > 0 ? single / covered : 0;
}

}  // namespace polyrecon
