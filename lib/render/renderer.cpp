#include "render/renderer_internal.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/parallel.h"

namespace krok::render {

namespace {

constexpr int kTile = 16;   // pixels, in both directions
constexpr int kAcross = 3;  // samples per pixel, in both directions
constexpr int kSamples = kAcross * kAcross;
constexpr float kReach = 0.16F;        // units; max distance of surfaces that occlude
constexpr float kShadowReach = 0.35F;  // the same for ground shadows
constexpr float kShadow = 0.55F;
constexpr float kBright = 0.75F;  // light above is compressed, to keep the shape of white surfaces

// The rays of one of a pixel's samples; together, the samples cover all directions.
TracedActor::Rays rays_of(int sample, int directions) {
  const int count = directions / kSamples;
  return {directions, sample * count, count};
}

// Keeps light below 1, with its hue, and unchanged up to kBright.
Light compressed(const Light& light) {
  const float most = light.maxCoeff();
  if (!(most > kBright)) return light;
  const float room = 1 - kBright;
  return light * ((kBright + room * (1 - std::exp((kBright - most) / room))) / most);
}

// Lights fixed to the camera (right, up, towards it), so that a character is lit the same way from
// all sides: a key light from the upper left, a fill light from the right, a rim light from behind,
// and ambient light, stronger from above.
struct Lamp {
  Vec3f direction;
  float strength;
};

class Lights {
 public:
  explicit Lights(const Projection& camera) {
    const auto world = [&camera](double right, double up, double towards) -> Vec3f {
      const Vec3 way = right * camera.right() + up * camera.up() + towards * camera.towards();
      return way.normalized().cast<float>();
    };
    lamps_ = {{{world(-0.5, 0.7, 0.65), 0.66F},
               {world(0.85, 0.1, 0.5), 0.2F},
               {world(0.25, 0.55, -0.8), 0.25F}}};
    up_ = camera.up().cast<float>();
  }

  Light shaded(const Hit& hit, float occlusion) const {
    const float open = 1 - 0.75F * occlusion;
    float light = (0.46F + 0.12F * hit.normal.dot(up_)) * open;
    for (const Lamp& lamp : lamps_) {
      light +=
          lamp.strength * std::max(0.0F, hit.normal.dot(lamp.direction)) * (0.5F + 0.5F * open);
    }
    return compressed(light * hit.colour);
  }

 private:
  std::array<Lamp, 3> lamps_;
  Vec3f up_;
};

// Per-view state shared by its pixels.
//
// Most pixels show one smooth surface. There, one line of sight suffices, and the pixels of a
// neighbourhood of three by three share their occlusion rays; only pixels at outlines, creases and
// changes of colour take all samples. Shadows are soft: they are computed at the corners of small
// blocks and interpolated where these agree. All of it depends on the tile alone, not on threads.
class ViewPainter {
 public:
  explicit ViewPainter(const View& view) : view_(view), projection_(view), lights_(projection_) {
    for (const View::Layer& layer : view.layers) {
      const Bounds& box = layer.actor->box();
      bodies_.push_back(seen_box(box));
      shadows_.push_back(view.shadows ? seen_box(shadow_box(*layer.actor)) : bodies_.back());
    }
  }

  void paint(int left, int top, int right, int bottom, Image& image) const {
    const Box pixels{Vec2(left, top), Vec2(right, bottom)};
    thread_local Tile tile;
    tile.left = left;
    tile.top = top;
    tile.bodies.clear();
    tile.shadows.clear();
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      if (overlap(bodies_[i], pixels)) tile.bodies.push_back(i);
      if (view_.shadows && overlap(shadows_[i], pixels)) tile.shadows.push_back(i);
    }
    if (tile.bodies.empty() && tile.shadows.empty()) return;
    look_at_middles(tile);
    tile.open.fill(kUnknown);
    for (int y = top; y < bottom; ++y) {
      for (int x = left; x < right; ++x) paint_pixel(x, y, tile, image);
    }
  }

 private:
  static constexpr int kPadded = kTile + 2;  // with the neighbours of the pixels at its edge
  static constexpr int kBlock = 4;           // pixels between points with shadows
  static constexpr float kUnknown = -1;
  static constexpr double kFewPixels = 64;  // of actors that take all samples everywhere
  // Limits of what neighbours on a smooth surface differ by.
  static constexpr float kSameNormal = 0.9F;   // cosine
  static constexpr float kSamePlane = 1.5F;    // pixels
  static constexpr float kSameColour = 0.04F;  // linear light
  static constexpr float kSameShadow = 0.06F;

  struct Seen {
    double depth;
    float opacity;
    Light light;
  };

  // What the middle of a pixel shows of an actor.
  struct Middle {
    std::optional<Hit> hit;
    float pixel = 0;             // its size in the actor's units
    float occlusion = kUnknown;  // of the pixel's own rays
  };

  // What is known of the pixels being painted.
  struct Tile {
    int left = 0, top = 0;
    std::vector<std::size_t> bodies, shadows;  // layers whose actor, or its shadow, may be here
    std::vector<Middle> middles;               // [bodies x kPadded x kPadded]
    std::array<float, std::size_t{kTile + 1} * (kTile + 1)> open{};  // the light let through

    Middle& middle(std::size_t body, int x, int y) {
      return middles[(body * kPadded + static_cast<std::size_t>(y - top + 1)) * kPadded +
                     static_cast<std::size_t>(x - left + 1)];
    }
  };

  static bool overlap(const Box& a, const Box& b) {
    return (a.low.array() <= b.high.array()).all() && (a.high.array() >= b.low.array()).all();
  }

  static Bounds shadow_box(const TracedActor& actor) {
    Bounds box = actor.box();
    const double reach = static_cast<double>(kShadowReach) * actor.unit();
    box.low -= Vec3(reach, 0, reach);
    box.high += Vec3(reach, 0, reach);
    box.low.y() = box.high.y() = 0;
    return box;
  }

  // The pixels that a box may cover, and one more on each side.
  Box seen_box(const Bounds& box) const {
    Box pixels{Vec2::Constant(1e300), Vec2::Constant(-1e300)};
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3 point((corner & 1) != 0 ? box.low.x() : box.high.x(),
                       (corner & 2) != 0 ? box.low.y() : box.high.y(),
                       (corner & 4) != 0 ? box.low.z() : box.high.z());
      const auto place = projection_.project(point);
      if (!place) return {Vec2::Constant(-1e300), Vec2::Constant(1e300)};
      pixels.low = pixels.low.cwiseMin(*place);
      pixels.high = pixels.high.cwiseMax(*place);
    }
    return {pixels.low - Vec2::Ones(), pixels.high + Vec2::Ones()};
  }

  double depth_of(const TracedActor& actor) const {
    return (projection_.origin() - actor.middle()).dot(projection_.towards());
  }

  void look_at_middles(Tile& tile) const {
    tile.middles.resize(tile.bodies.size() * kPadded * kPadded);
    for (std::size_t body = 0; body < tile.bodies.size(); ++body) {
      const TracedActor& actor = *view_.layers[tile.bodies[body]].actor;
      for (int y = tile.top - 1; y <= tile.top + kTile; ++y) {
        for (int x = tile.left - 1; x <= tile.left + kTile; ++x) {
          const Sight sight = projection_.sight(Vec2(x + 0.5, y + 0.5), 1, depth_of(actor));
          tile.middle(body, x, y) = {
              actor.look(sight), static_cast<float>(sight.right.norm() / actor.unit()), kUnknown};
        }
      }
    }
  }

  // Whether a pixel and its neighbours show one smooth surface of an actor, or nothing of it.
  bool is_smooth(int x, int y, std::size_t body, Tile& tile) const {
    const std::size_t layer = tile.bodies[body];
    if (view_.layers[layer].actor->has_holes()) return false;
    if ((bodies_[layer].high - bodies_[layer].low).maxCoeff() < kFewPixels) return false;
    const Middle& here = tile.middle(body, x, y);
    for (int i = 0; i < 9; ++i) {
      const Middle& other = tile.middle(body, x - 1 + i % 3, y - 1 + i / 3);
      if (other.hit.has_value() != here.hit.has_value()) return false;
      if (!here.hit) continue;
      const Hit& a = *here.hit;
      const Hit& b = *other.hit;
      if (!(a.normal.dot(b.normal) > kSameNormal) ||
          !(std::abs(a.normal.dot(b.point - a.point)) < kSamePlane * here.pixel) ||
          !((a.colour - b.colour).cwiseAbs().maxCoeff() < kSameColour)) {
        return false;
      }
    }
    return true;
  }

  // The occlusion of a smooth pixel: each of its neighbours has rays in other directions.
  float shared_occlusion(int x, int y, std::size_t body, Tile& tile) const {
    const TracedActor& actor = *view_.layers[tile.bodies[body]].actor;
    float sum = 0;
    for (int i = 0; i < 9; ++i) {
      const int column = x - 1 + i % 3, row = y - 1 + i / 3;
      Middle& middle = tile.middle(body, column, row);
      if (middle.occlusion == kUnknown) {
        const int sample = (column + 3) % 3 + 3 * ((row + 3) % 3);
        middle.occlusion =
            actor.occlusion(middle.hit->point, middle.hit->normal, rays_of(sample, 18), kReach);
      }
      sum += middle.occlusion;
    }
    return sum / 9;
  }

  Seen seen(std::size_t layer, const Hit& hit, const Sight& sight, float occlusion) const {
    const View::Layer& from = view_.layers[layer];
    const double depth =
        hit.depth + (from.actor->middle() - projection_.origin()).dot(sight.towards);
    return {from.behind ? -std::numeric_limits<double>::infinity() : depth, from.opacity,
            lights_.shaded(hit, occlusion)};
  }

  // Blends what is seen over `light`: back to front; at equal depth, in layer order.
  static void blend(std::vector<Seen>& all, Light& light) {
    std::stable_sort(all.begin(), all.end(),
                     [](const Seen& a, const Seen& b) { return a.depth < b.depth; });
    for (const Seen& one : all) light += one.opacity * (one.light - light);
  }

  void paint_pixel(int x, int y, Tile& tile, Image& image) const {
    const float open = tile.shadows.empty() ? 1 : open_at(x, y, tile);
    const Light ground = to_light(image.at(x, y)) * open;
    thread_local std::vector<Seen> all;
    bool smooth = true;
    for (std::size_t body = 0; body < tile.bodies.size() && smooth; ++body) {
      smooth = is_smooth(x, y, body, tile);
    }
    if (smooth) {
      all.clear();
      for (std::size_t body = 0; body < tile.bodies.size(); ++body) {
        const Middle& middle = tile.middle(body, x, y);
        if (!middle.hit) continue;
        const Sight sight = projection_.sight(Vec2(x + 0.5, y + 0.5), 1, 1);
        all.push_back(
            seen(tile.bodies[body], *middle.hit, sight, shared_occlusion(x, y, body, tile)));
      }
      if (all.empty() && !(open < 1)) return;
      Light light = ground;
      blend(all, light);
      image.set(x, y, to_colour(light));
      return;
    }
    Light sum = Light::Zero();
    bool changed = open < 1;
    for (int sample = 0; sample < kSamples; ++sample) {
      const int row = sample / kAcross, column = sample % kAcross;
      const Vec2 place(x + (column + 0.5) / kAcross, y + (row + 0.5) / kAcross);
      all.clear();
      look(place, sample, tile, all);
      changed = changed || !all.empty();
      Light light = ground;
      blend(all, light);
      sum += light;
    }
    if (changed) image.set(x, y, to_colour(sum / static_cast<float>(kSamples)));
  }

  // What is seen at an image position.
  void look(const Vec2& place, int sample, const Tile& tile, std::vector<Seen>& all) const {
    for (const std::size_t i : tile.bodies) {
      const TracedActor& actor = *view_.layers[i].actor;
      const Sight sight = projection_.sight(place, kAcross, depth_of(actor));
      const auto hit = actor.look(sight);
      if (!hit) continue;
      all.push_back(seen(i, *hit, sight,
                         actor.occlusion(hit->point, hit->normal, rays_of(sample, 18), kReach)));
    }
  }

  // The share of light (0 .. 1) that reaches the ground at a pixel of a tile.
  float open_at(int x, int y, Tile& tile) const {
    const int column = x - tile.left, row = y - tile.top;
    const int left = column / kBlock * kBlock, top = row / kBlock * kBlock;
    const float a = open_of(left, top, tile), b = open_of(left + kBlock, top, tile);
    const float c = open_of(left, top + kBlock, tile);
    const float d = open_of(left + kBlock, top + kBlock, tile);
    const auto [least, most] = std::minmax({a, b, c, d});
    if (most - least > kSameShadow) return open_of(column, row, tile);
    const float across = static_cast<float>(column - left) / kBlock;
    const float down = static_cast<float>(row - top) / kBlock;
    return (1 - down) * ((1 - across) * a + across * b) + down * ((1 - across) * c + across * d);
  }

  float open_of(int column, int row, Tile& tile) const {
    float& open = tile.open[static_cast<std::size_t>(row * (kTile + 1) + column)];
    if (open == kUnknown) {
      open = light_on_ground(Vec2(tile.left + column + 0.5, tile.top + row + 0.5), tile.shadows);
    }
    return open;
  }

  float light_on_ground(const Vec2& place, const std::vector<std::size_t>& layers) const {
    const Sight sight = projection_.sight(place, 1, 1);
    // The ground is seen from above, and by an eye only where it looks down.
    if (!(sight.towards.y() > 0) || (sight.from_eye && !(sight.point.y() > 0))) return 1;
    const Vec3 on_ground = sight.point - sight.point.y() / sight.towards.y() * sight.towards;
    float open = 1;
    for (const std::size_t i : layers) {
      const TracedActor& actor = *view_.layers[i].actor;
      const Bounds& box = actor.box();
      const Vec3 nearest = on_ground.cwiseMax(box.low).cwiseMin(box.high);
      if (!((nearest - on_ground).norm() < static_cast<double>(kShadowReach) * actor.unit())) {
        continue;
      }
      const float occlusion =
          actor.occlusion(actor.local(on_ground), Vec3f::UnitY(), {54, 0, 54}, kShadowReach);
      open *= 1 - kShadow * view_.layers[i].opacity * occlusion;
    }
    return open;
  }

  const View& view_;
  Projection projection_;
  Lights lights_;
  std::vector<Box> bodies_, shadows_;  // pixels that an actor and its shadow may cover
};

}  // namespace

Projection::Projection(const View& view) : camera_(view.camera), lens_(view.lens) {
  if (!lens_) {
    right_ = camera_.right();
    up_ = camera_.up();
    towards_ = camera_.towards();
    origin_ = camera_.target;
    return;
  }
  const Mat3 axes = lens_->camera_to_world.toRotationMatrix();
  right_ = axes.col(0);
  up_ = axes.col(1);
  towards_ = axes.col(2);
  origin_ = lens_->eye;
  middle_ = 0.5 * Vec2(view.left + view.right, view.top + view.bottom);
  focal_ = 0.5 * (view.bottom - view.top) / std::tan(0.5 * lens_->field_of_view);
}

Sight Projection::sight(const Vec2& place, int parts, double depth) const {
  if (!lens_) {
    const Vec2 offset = (place - camera_.place_of_target) / camera_.pixels_per_metre;
    const double metres = 1 / (parts * camera_.pixels_per_metre);
    return {camera_.target + offset.x() * right_ - offset.y() * up_, towards_, metres * right_,
            -metres * up_};
  }
  const Vec2 offset = place - middle_;
  const Vec3 ahead = offset.x() * right_ - offset.y() * up_ - focal_ * towards_;
  const double metres = std::max(depth, 0.0) / (parts * focal_);
  return {lens_->eye, -ahead.normalized(), metres * right_, -metres * up_, true};
}

std::optional<Vec2> Projection::project(const Vec3& point) const {
  if (!lens_) return camera_.project(point);
  constexpr double kNear = 0.01;  // metres
  const Vec3 offset = point - lens_->eye;
  const double depth = -towards_.dot(offset);
  if (!(depth > kNear)) return std::nullopt;
  return Vec2(middle_ + focal_ / depth * Vec2(right_.dot(offset), -up_.dot(offset)));
}

void render(std::span<const View> views, Image& image, int jobs) {
  struct Tile {
    std::size_t view;
    int left, top;
  };
  std::vector<ViewPainter> painters;
  std::vector<Tile> tiles;
  painters.reserve(views.size());
  for (std::size_t i = 0; i < views.size(); ++i) {
    painters.emplace_back(views[i]);
    for (int top = views[i].top; top < views[i].bottom; top += kTile) {
      for (int left = views[i].left; left < views[i].right; left += kTile) {
        tiles.push_back({i, left, top});
      }
    }
  }
  parallel_for(tiles.size(), 8, jobs, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Tile& tile = tiles[i];
      const View& view = views[tile.view];
      painters[tile.view].paint(tile.left, tile.top, std::min(tile.left + kTile, view.right),
                                std::min(tile.top + kTile, view.bottom), image);
    }
  });
}

}  // namespace krok::render
