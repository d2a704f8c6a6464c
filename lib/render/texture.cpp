#include "render/texture.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "render/image.h"

namespace krok::render {

namespace {

using Wrap = krok::Texture::Wrap;

// One pixel's linear colour and alpha.
Vec4f pixel(const Mipmap::Level& level, int x, int y) {
  const std::size_t place =
      4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(level.width) +
           static_cast<std::size_t>(x));
  const std::uint8_t* const rgba = &level.rgba[place];
  const Vec3f light = to_light({rgba[0], rgba[1], rgba[2]});
  return {light.x(), light.y(), light.z(), static_cast<float>(rgba[3]) / 255.0F};
}

// The source pixels of one pixel of the next level, and their weights; odd sizes use fractional
// weights.
struct Share {
  int first = 0, count = 0;
  std::array<float, 3> parts{};  // sum to 1
};

std::vector<Share> shares(int from, int to) {
  std::vector<Share> result;
  // In units of 1/`to` of a source pixel.
  for (std::int64_t i = 0; i < to; ++i) {
    const std::int64_t begin = i * from, end = begin + from;
    Share share;
    share.first = static_cast<int>(begin / to);
    for (std::int64_t at = begin; at < end; ++share.count) {
      const std::int64_t next = std::min((at / to + 1) * to, end);
      share.parts[static_cast<std::size_t>(share.count)] =
          static_cast<float>(next - at) / static_cast<float>(from);
      at = next;
    }
    result.push_back(share);
  }
  return result;
}

Mipmap::Level halved(const Mipmap::Level& from) {
  Mipmap::Level to;
  to.width = std::max(1, from.width / 2);
  to.height = std::max(1, from.height / 2);
  to.rgba.reserve(4 * static_cast<std::size_t>(to.width) * static_cast<std::size_t>(to.height));
  const auto columns = shares(from.width, to.width);
  for (const Share& row : shares(from.height, to.height)) {
    for (const Share& column : columns) {
      Vec4f sum = Vec4f::Zero();
      for (int y = 0; y < row.count; ++y) {
        for (int x = 0; x < column.count; ++x) {
          sum += row.parts[static_cast<std::size_t>(y)] *
                 column.parts[static_cast<std::size_t>(x)] *
                 pixel(from, column.first + x, row.first + y);
        }
      }
      const Colour colour = to_colour(sum.head<3>());
      to.rgba.insert(to.rgba.end(),
                     {colour.red, colour.green, colour.blue,
                      static_cast<std::uint8_t>(std::lround(std::min(sum.w(), 1.0F) * 255.0F))});
    }
  }
  return to;
}

// Wraps a coordinate into 0 .. 1.
double wrapped(float coordinate, Wrap wrap) {
  const double value = static_cast<double>(coordinate);
  double inside = value;
  if (wrap == Wrap::repeat) inside = value - std::floor(value);
  if (wrap == Wrap::mirror) {
    inside = value - 2 * std::floor(value / 2);
    if (inside > 1) inside = 2 - inside;
  }
  return inside >= 0 ? std::min(inside, 1.0) : 0.0;  // NaN maps to 0
}

// The two pixels whose centres enclose a coordinate (0 .. 1), and the interpolation weight.
struct Between {
  int first, second;
  float share;  // of the second
};

Between between(double coordinate, int size, Wrap wrap) {
  const double place = coordinate * size - 0.5;
  const double below = std::floor(place);
  const int first = static_cast<int>(below);
  // For mirror and clamp, the pixel beyond the edge is the edge pixel.
  const auto kept = [&](int index) {
    if (wrap == Wrap::repeat) return index < 0 ? size - 1 : (index >= size ? 0 : index);
    return std::clamp(index, 0, size - 1);
  };
  return {kept(first), kept(first + 1), static_cast<float>(place - below)};
}

class Sampler {
 public:
  explicit Sampler(const Paint& paint) : paint_(paint) {}

  Vec4f at(const Vec2f& place, double level) const {
    const auto& levels = paint_.image->levels();
    const double u = wrapped(place.x(), paint_.wrap_u), v = wrapped(place.y(), paint_.wrap_v);
    if (!(level > 0)) return paint_.smooth ? smooth(levels[0], u, v) : nearest(levels[0], u, v);
    const double last = static_cast<double>(levels.size() - 1);
    const double kept = std::min(level, last);
    const auto below = static_cast<std::size_t>(kept);
    const auto above = std::min(below + 1, levels.size() - 1);
    const auto share = static_cast<float>(kept - static_cast<double>(below));
    const Vec4f fine = smooth(levels[below], u, v);
    return fine + share * (smooth(levels[above], u, v) - fine);
  }

 private:
  Vec4f smooth(const Mipmap::Level& level, double u, double v) const {
    const Between x = between(u, level.width, paint_.wrap_u);
    const Between y = between(v, level.height, paint_.wrap_v);
    const auto row = [&](int line) -> Vec4f {
      return (1 - x.share) * pixel(level, x.first, line) + x.share * pixel(level, x.second, line);
    };
    return (1 - y.share) * row(y.first) + y.share * row(y.second);
  }

  static Vec4f nearest(const Mipmap::Level& level, double u, double v) {
    return pixel(level, std::min(static_cast<int>(u * level.width), level.width - 1),
                 std::min(static_cast<int>(v * level.height), level.height - 1));
  }

  const Paint& paint_;
};

}  // namespace

Result<Mipmap> Mipmap::create(int width, int height, std::vector<std::uint8_t> rgba) {
  if (width < 1 || height < 1 ||
      rgba.size() / 4 / static_cast<std::size_t>(width) != static_cast<std::size_t>(height) ||
      rgba.size() % (4 * static_cast<std::size_t>(width)) != 0) {
    return Error("render-texture", "the texture's pixel count does not match its size");
  }
  Mipmap mipmap;
  mipmap.levels_.push_back({width, height, std::move(rgba)});
  while (mipmap.levels_.back().width > 1 || mipmap.levels_.back().height > 1) {
    mipmap.levels_.push_back(halved(mipmap.levels_.back()));
  }
  return mipmap;
}

Vec4f Paint::at(const Vec2f& place, const Vec2f& across, const Vec2f& down) const {
  const Mipmap::Level& whole = image->levels()[0];
  const Vec2f size(static_cast<float>(whole.width), static_cast<float>(whole.height));
  const double first = static_cast<double>(across.cwiseProduct(size).norm());
  const double second = static_cast<double>(down.cwiseProduct(size).norm());
  const bool wider = first > second;
  double longer = wider ? first : second, shorter = wider ? second : first;
  // A surface seen edge-on has no finite offset: use the whole image.
  if (!std::isfinite(longer + shorter)) longer = shorter = 1e9;
  shorter = std::max(shorter, longer / kMaxProbes);
  const double level = shorter > 1 ? std::log2(shorter) : 0.0;
  const int probes =
      std::clamp(static_cast<int>(std::ceil(longer / std::max(shorter, 1.0))), 1, kMaxProbes);
  const Sampler sampler(*this);
  if (probes == 1) return factor.cwiseProduct(sampler.at(place, level));
  const Vec2f& way = wider ? across : down;
  Vec4f sum = Vec4f::Zero();
  for (int i = 0; i < probes; ++i) {
    const float share = (static_cast<float>(i) + 0.5F) / static_cast<float>(probes) - 0.5F;
    sum += sampler.at(place + share * way, level);
  }
  return factor.cwiseProduct(sum / static_cast<float>(probes));
}

float Paint::alpha_at(const Vec2f& place) const {
  return factor.w() * Sampler(*this).at(place, 0).w();
}

}  // namespace krok::render
