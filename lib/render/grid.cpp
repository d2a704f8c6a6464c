#include <algorithm>
#include <cmath>

#include "render/overlays_internal.h"

namespace krok::render {

namespace {

constexpr Colour kGridLine = colour(0xC3CAD2);

}  // namespace

void paint_grid(const Projection& projection, const Grid& grid, const Box& clip, Image& image) {
  const auto piece = [&](const Vec3& from, const Vec3& to) {
    const auto first = projection.project(from), last = projection.project(to);
    if (!first || !last) return;
    const double far = (0.5 * (from + to) - grid.centre).norm() / grid.reach;
    draw_line(image, *first, *last, 1, kGridLine, clip, std::clamp(1.2 - 1.2 * far, 0.0, 1.0));
  };
  const auto lines = [&](int across, int along) {
    const double middle = grid.centre[across];
    for (double i = std::ceil((middle - grid.reach) / grid.step);
         i * grid.step <= middle + grid.reach; ++i) {
      for (int k = 0; k < grid.pieces; ++k) {
        Vec3 from = Vec3::Zero();
        Vec3 to = Vec3::Zero();
        from[across] = to[across] = i * grid.step;
        from[along] = grid.centre[along] + grid.reach * (2.0 * k / grid.pieces - 1);
        to[along] = grid.centre[along] + grid.reach * (2.0 * (k + 1) / grid.pieces - 1);
        piece(from, to);
      }
    }
  };
  lines(0, 2);
  lines(2, 0);
}

}  // namespace krok::render
