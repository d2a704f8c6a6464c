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
class ViewPainter {
 public:
  explicit ViewPainter(const View& view) : view_(view), projection_(view), lights_(projection_) {
    for (const View::Layer& layer : view.layers) reaches_.push_back(reach_of(*layer.actor));
  }

  void paint(int left, int top, int right, int bottom, Image& image) const {
    std::vector<std::size_t> near;
    const Box tile{Vec2(left, top), Vec2(right, bottom)};
    for (std::size_t i = 0; i < reaches_.size(); ++i) {
      if ((reaches_[i].low.array() <= tile.high.array()).all() &&
          (reaches_[i].high.array() >= tile.low.array()).all()) {
        near.push_back(i);
      }
    }
    if (near.empty()) return;
    for (int y = top; y < bottom; ++y) {
      for (int x = left; x < right; ++x) paint_pixel(x, y, near, image);
    }
  }

 private:
  struct Seen {
    double depth;
    float opacity;
    Light light;
  };

  // The pixels that an actor and its shadow may cover.
  Box reach_of(const TracedActor& actor) const {
    Bounds box = actor.box();
    if (view_.shadows) {
      const double reach = static_cast<double>(kShadowReach) * actor.unit();
      box.low -= Vec3(reach, 0, reach);
      box.high += Vec3(reach, 0, reach);
      box.low.y() = std::min(box.low.y(), 0.0);
    }
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
    return pixels;
  }

  void paint_pixel(int x, int y, const std::vector<std::size_t>& near, Image& image) const {
    const Colour before = image.at(x, y);
    const Light ground = to_light(before);
    Light sum = Light::Zero();
    bool changed = false;
    for (int sample = 0; sample < kSamples; ++sample) {
      const int column = sample % kAcross, row = sample / kAcross;
      const double across = x + (column + 0.5) / kAcross;
      const double down = y + (row + 0.5) / kAcross;
      Light light = ground;
      changed = look(Vec2(across, down), sample, near, light) || changed;
      sum += light;
    }
    if (changed) image.set(x, y, to_colour(sum / static_cast<float>(kSamples)));
  }

  // Blends what is visible at an image position over `light`; false if nothing is.
  bool look(const Vec2& place, int sample, const std::vector<std::size_t>& near,
            Light& light) const {
    thread_local std::vector<Seen> seen;
    seen.clear();
    for (const std::size_t i : near) {
      const View::Layer& layer = view_.layers[i];
      const double away = (projection_.origin() - layer.actor->middle()).dot(projection_.towards());
      const Sight sight = projection_.sight(place, kAcross, away);
      const auto hit = layer.actor->look(sight);
      if (!hit) continue;
      const float occlusion =
          layer.actor->occlusion(hit->point, hit->normal, rays_of(sample, 18), kReach);
      const double depth =
          hit->depth + (layer.actor->middle() - projection_.origin()).dot(sight.towards);
      seen.push_back({layer.behind ? -std::numeric_limits<double>::infinity() : depth,
                      layer.opacity, lights_.shaded(*hit, occlusion)});
    }
    bool changed = !seen.empty();
    if (view_.shadows) {
      changed = add_shadows(projection_.sight(place, kAcross, 1), sample, near, light) || changed;
    }
    // Back to front; at equal depth, in layer order.
    std::stable_sort(seen.begin(), seen.end(),
                     [](const Seen& a, const Seen& b) { return a.depth < b.depth; });
    for (const Seen& one : seen) light += one.opacity * (one.light - light);
    return changed;
  }

  bool add_shadows(const Sight& sight, int sample, const std::vector<std::size_t>& near,
                   Light& light) const {
    // The ground is seen from above, and by an eye only where it looks down.
    if (!(sight.towards.y() > 0) || (sight.from_eye && !(sight.point.y() > 0))) return false;
    const Vec3 on_ground = sight.point - sight.point.y() / sight.towards.y() * sight.towards;
    float open = 1;
    for (const std::size_t i : near) {
      const TracedActor& actor = *view_.layers[i].actor;
      const float occlusion = actor.occlusion(actor.local(on_ground), Vec3f::UnitY(),
                                              rays_of(sample, 54), kShadowReach);
      open *= 1 - kShadow * view_.layers[i].opacity * occlusion;
    }
    light *= open;
    return open < 1;
  }

  const View& view_;
  Projection projection_;
  Lights lights_;
  std::vector<Box> reaches_;
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
