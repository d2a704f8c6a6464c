#include "tools/krok-render/shot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "camera/look_at.h"
#include "core/numbers.h"
#include "core/parallel.h"
#include "math/quaternion.h"
#include "render/actor.h"
#include "render/sheet.h"

namespace krok::cli::film {

namespace {

constexpr render::Colour kGrey = render::colour(0x8E99A5);

double distance(const Vec3f& a, const Vec3f& b) {
  return (a.cast<double>() - b.cast<double>()).norm();
}

// Whether both have as many surfaces, vertices and bones, in the same order.
bool points_correspond(const render::Actor& first, const render::Actor& second) {
  return first.bones.size() == second.bones.size() &&
         std::ranges::equal(first.surfaces, second.surfaces,
                            [](const render::Surface& a, const render::Surface& b) {
                              return a.positions.size() == b.positions.size();
                            });
}

// The largest distance of corresponding points, metres.
double largest_distance(const render::Actor& first, const render::Actor& second) {
  double largest = 0;
  for (std::size_t i = 0; i < second.surfaces.size(); ++i) {
    const auto &a = first.surfaces[i].positions, &b = second.surfaces[i].positions;
    for (std::size_t v = 0; v < b.size(); ++v) largest = std::max(largest, distance(a[v], b[v]));
  }
  for (std::size_t i = 0; i < second.bones.size(); ++i) {
    largest = std::max({largest, distance(first.bones[i].from, second.bones[i].from),
                        distance(first.bones[i].to, second.bones[i].to)});
  }
  return largest;
}

// The second, coloured by the distance of its points from those of the first.
render::Actor coloured_by_distance(const render::Actor& first, const render::Actor& second,
                                   const render::ColourKey& key, double units_in_a_metre) {
  render::Actor result = second;
  const auto colour = [&](const Vec3f& a, const Vec3f& b) {
    return key.at(distance(a, b) * units_in_a_metre);
  };
  for (std::size_t i = 0; i < result.surfaces.size(); ++i) {
    render::Surface& surface = result.surfaces[i];
    surface.paint = nullptr;
    surface.colours.clear();
    for (std::size_t v = 0; v < surface.positions.size(); ++v) {
      surface.colours.push_back(colour(first.surfaces[i].positions[v], surface.positions[v]));
    }
    if (surface.colours.empty()) surface.colours = {kGrey};
  }
  for (std::size_t i = 0; i < result.bones.size(); ++i) {
    render::Bone& bone = result.bones[i];
    bone.from_colour = colour(first.bones[i].from, bone.from);
    bone.to_colour = colour(first.bones[i].to, bone.to);
  }
  return result;
}

render::Actor in_grey(render::Actor actor) {
  for (render::Surface& surface : actor.surfaces) {
    surface.paint = nullptr;
    surface.colours = {kGrey};
  }
  for (render::Bone& bone : actor.bones) bone.from_colour = bone.to_colour = kGrey;
  return actor;
}

constexpr int kMaxFrames = 36'000;
constexpr int kMeasured = 60;        // frames that the scale is measured at
constexpr double kSmoothing = 0.35;  // seconds, of the camera's way
constexpr double kLevel = 0.35;      // metres that a camera on level ground may rise and sink
constexpr double kAir = 0.06;        // of width and height, free at each edge
constexpr double kKeyRoom = 0.14;    // of the height, for the colour scale
constexpr double kPale = 0.35;       // opacity of the first actor of a difference

// What a pane shows over time, relative to its target: metres to the right and up.
struct Window {
  Vec2 low = Vec2::Constant(1e300), high = Vec2::Constant(-1e300);

  void add(const Vec2& at) {
    low = low.cwiseMin(at);
    high = high.cwiseMax(at);
  }
};

void add_actor(const render::Actor& actor, const render::Camera& camera, Window& window) {
  const Vec3 right = camera.right(), up = camera.up();
  const auto add = [&](const Vec3f& point, float radius) {
    const Vec3 offset = point.cast<double>() - camera.target;
    const Vec2 at(right.dot(offset), up.dot(offset));
    const Vec2 reach = Vec2::Constant(static_cast<double>(radius));
    window.add(at - reach);
    window.add(at + reach);
  };
  for (const render::Surface& surface : actor.surfaces) {
    for (const Vec3f& point : surface.positions) add(point, 0);
  }
  for (const render::Bone& bone : actor.bones) {
    add(bone.from, bone.from_radius);
    add(bone.to, bone.to_radius);
  }
}

}  // namespace

Result<Shot> Shot::create(std::vector<MovingActor> actors, const Options& options,
                          const ShotSetting& setting, SheetGround ground,
                          std::optional<CameraTrack> camera, int jobs) {
  Shot shot(options);
  shot.setting_ = setting;
  shot.actors_ = std::move(actors);
  shot.track_ = std::move(camera);
  constexpr double kSameFrame = 1e-3;  // times of files are floats
  const double frames = std::floor((setting.end - setting.start) * setting.rate + kSameFrame) + 1;
  if (frames > kMaxFrames) {
    return Error("film-long",
                 fmt::format("{} s at {} frames per second exceed the limit of {} frames",
                             readable(setting.end - setting.start, 4), readable(setting.rate),
                             grouped(kMaxFrames)),
                 "choose a part with --from and --to, or a lower --rate");
  }
  shot.frame_count_ = static_cast<int>(frames);
  if (options.difference) {
    if (Status status = shot.measure_difference(jobs); !status) return status.error();
  }
  if (Status status = shot.add_ground(std::move(ground)); !status) return status.error();
  shot.lay_out_panes();
  shot.follow();
  shot.choose_scale(jobs);
  return shot;
}

Status Shot::add_ground(SheetGround ground) {
  if (ground.terrain == nullptr) return {};
  for (const MovingActor& actor : actors_) {
    ImageSpan span;
    span.start = std::min(setting_.start, actor.duration);
    span.end = std::min(setting_.end, actor.duration);
    grounds_.push_back(
        ground_surfaces(*ground.terrain, ground.prints, part_below_way(actor, span)));
  }
  return {};
}

Status Shot::measure_difference(int jobs) {
  const auto frames = static_cast<std::size_t>(frame_count_);
  std::vector<double> distances(frames, 0.0);
  if (!points_correspond(actors_[0].at(setting_.start), actors_[1].at(setting_.start))) {
    return Error("film-difference",
                 fmt::format("{} and {} have different points; distances need the same mesh or the "
                             "same joints in both",
                             actors_[0].name, actors_[1].name),
                 "--body none compares the joints of motions");
  }
  parallel_for(frames, 1, jobs, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      const double time = time_of(static_cast<int>(f));
      distances[f] = largest_distance(actors_[0].at(time), actors_[1].at(time));
    }
  });
  largest_ = *std::ranges::max_element(distances);
  key_.emplace();
  key_->label = "distance";
  key_->unit = largest_ < 0.1 ? "mm" : largest_ < 10 ? "cm" : "m";
  in_a_metre_ = largest_ < 0.1 ? 1000 : largest_ < 10 ? 100 : 1;
  key_->high = largest_ > 0 ? largest_ * in_a_metre_ : 1;
  return {};
}

// Motions in order, each from all sides; or all of them in one view.
void Shot::lay_out_panes() {
  const double front = actors_[0].heading(setting_.start);
  const auto add = [&](const std::string& name, std::vector<std::size_t> shown, bool compares) {
    const std::vector<ImageSide> sides = sides_seen(options_->image);
    for (const ImageSide& side : sides) {
      Pane pane;
      pane.title = sides.size() > 1 ? fmt::format("{}   {}", name, side.name) : name;
      // Compared actors are seen from the same side, others from their own.
      const bool own = !options_->difference && shown.size() == 1;
      pane.yaw = (own ? actors_[shown[0]].heading(setting_.start) : front) + side.yaw;
      pane.side = side;
      pane.actors = shown;
      pane.compares = compares;
      panes_.push_back(std::move(pane));
    }
  };
  if (options_->together) {
    std::vector<std::size_t> all(actors_.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    std::string names;
    for (const MovingActor& actor : actors_) names += (names.empty() ? "" : ", ") + actor.name;
    add(names, std::move(all), false);
  } else {
    for (std::size_t i = 0; i < actors_.size(); ++i) add(actors_[i].name, {i}, false);
  }
  if (options_->difference) add("difference", {0, 1}, true);
  const auto boxes = render::film_boxes(panes_.size(), setting_.width, setting_.height);
  for (std::size_t i = 0; i < panes_.size(); ++i) {
    panes_[i].box = boxes[i];
    panes_[i].camera.yaw = panes_[i].yaw;
    panes_[i].camera.elevation = panes_[i].side.elevation;
  }
}

// The ground points that the cameras look at.
void Shot::follow() {
  const auto frames = static_cast<std::size_t>(frame_count_);
  std::vector<std::vector<Vec3>> ways;  // [actors][frames]
  for (const MovingActor& actor : actors_) {
    std::vector<Vec3> way(frames);
    for (std::size_t f = 0; f < frames; ++f) {
      way[f] = actor.carrier(std::min(time_of(static_cast<int>(f)), actor.duration));
    }
    smooth_both_ways(way, setting_.rate, kSmoothing);
    const double start = way[0].y();
    const bool level =
        std::ranges::all_of(way, [&](const Vec3& at) { return std::abs(at.y() - start) < kLevel; });
    for (Vec3& at : way) at.y() = level ? 0 : at.y() - start;
    if (options_->still) {
      Eigen::AlignedBox3d box;
      for (const Vec3& at : way) box.extend(at);
      std::ranges::fill(way, Vec3(box.center().x(), 0, box.center().z()));
    }
    ways.push_back(std::move(way));
  }
  for (Pane& pane : panes_) {
    pane.targets.assign(frames, Vec3::Zero());
    // Compared actors are seen in one frame of reference, so that a shift shows.
    const std::vector<std::size_t> led =
        options_->difference ? std::vector<std::size_t>{0} : pane.actors;
    for (std::size_t f = 0; f < frames; ++f) {
      for (const std::size_t i : led) pane.targets[f] += ways[i][f];
      pane.targets[f] /= static_cast<double>(led.size());
    }
  }
}

void Shot::choose_scale(int jobs) {
  const int measured = std::min(frame_count_, kMeasured);
  std::vector<std::vector<Window>> windows(static_cast<std::size_t>(measured),
                                           std::vector<Window>(panes_.size()));
  parallel_for(windows.size(), 1, jobs, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const int frame = measured > 1
                            ? static_cast<int>(std::lround(static_cast<double>(i) *
                                                           (frame_count_ - 1) / (measured - 1)))
                            : 0;
      std::vector<render::Actor> actors;
      for (const MovingActor& actor : actors_) {
        actors.push_back(actor.at(std::min(time_of(frame), actor.duration)));
      }
      for (std::size_t p = 0; p < panes_.size(); ++p) {
        render::Camera camera = panes_[p].camera;
        camera.target = panes_[p].targets[static_cast<std::size_t>(frame)];
        windows[i][p].add(Vec2::Zero());
        for (const std::size_t a : panes_[p].actors) add_actor(actors[a], camera, windows[i][p]);
      }
    }
  });
  double scale = 1e300;
  std::vector<Window> of_panes(panes_.size());
  for (std::size_t p = 0; p < panes_.size(); ++p) {
    for (const auto& all : windows) {
      of_panes[p].add(all[p].low);
      of_panes[p].add(all[p].high);
    }
    const Vec2 metres = (of_panes[p].high - of_panes[p].low).cwiseMax(1e-6);
    const Vec2 pixels = panes_[p].box.high - panes_[p].box.low;
    const double below = options_->difference ? kKeyRoom : 0;
    scale = std::min({scale, pixels.x() * (1 - 2 * kAir) / metres.x(),
                      pixels.y() * (1 - 2 * kAir - below) / metres.y()});
  }
  for (std::size_t p = 0; p < panes_.size(); ++p) {
    render::Camera& camera = panes_[p].camera;
    const Vec2 pixels = panes_[p].box.high - panes_[p].box.low;
    const Vec2 middle = 0.5 * (of_panes[p].low + of_panes[p].high);
    const double height = pixels.y() * (options_->difference ? 1 - kKeyRoom : 1);
    camera.pixels_per_metre = scale;
    camera.place_of_target = {0.5 * pixels.x() - middle.x() * scale,
                              0.5 * height + middle.y() * scale};
  }
}

// Between frames along the shorter arc; held at both ends and before cuts.
render::Lens Shot::lens_at(double time) const {
  const CameraTrack& track = *track_;
  const double last = track.frame_count() - 1;
  const double place = std::clamp(time * track.rate, 0.0, last);
  const auto before = static_cast<std::size_t>(std::floor(place));
  const std::size_t after = std::min(before + 1, static_cast<std::size_t>(last));
  const bool cut = track.is_cut(static_cast<int>(after));
  const double share = cut ? 0 : place - std::floor(place);
  const auto mix = [&](double a, double b) { return a + share * (b - a); };
  render::Lens lens;
  for (int i = 0; i < 3; ++i) {
    lens.eye[i] = mix(static_cast<double>(track.positions[before][i]),
                      static_cast<double>(track.positions[after][i]));
  }
  lens.camera_to_world =
      normalized_or_identity(track.orientations[before].cast<double>())
          .slerp(share, normalized_or_identity(track.orientations[after].cast<double>()));
  lens.field_of_view = mix(static_cast<double>(track.fields_of_view[before]),
                           static_cast<double>(track.fields_of_view[after]));
  return lens;
}

std::string Shot::label_at(int frame) const {
  const double time = time_of(frame);
  const MovingActor& actor = actors_[0];
  std::string label = fmt::format("{:.2f} s", time);
  if (actor.frame_count > 0) {
    const auto nearest = std::min<long>(std::lround(time * actor.rate), actor.frame_count - 1);
    label += fmt::format("   frame {}", nearest);
  }
  return label;
}

std::unique_ptr<ShotFrame> Shot::make(int frame) const {
  auto made = std::make_unique<ShotFrame>();
  const double time = time_of(frame);
  for (std::size_t i = 0; i < actors_.size(); ++i) {
    made->actors.push_back(actors_[i].at(std::min(time, actors_[i].duration)));
  }
  if (options_->difference) {
    made->compared.push_back(in_grey(made->actors[0]));
    made->compared.push_back(
        coloured_by_distance(made->actors[0], made->actors[1], *key_, in_a_metre_));
  }
  for (std::size_t i = 0; i < grounds_.size(); ++i) {
    for (const render::Surface& surface : grounds_[i]) {
      made->actors[i].surfaces.push_back(surface);
    }
  }
  for (const Pane& pane : panes_) {
    render::FilmView view;
    if (options_->labels) view.title = pane.title;
    view.left = static_cast<int>(pane.box.low.x());
    view.top = static_cast<int>(pane.box.low.y());
    view.right = static_cast<int>(pane.box.high.x());
    view.bottom = static_cast<int>(pane.box.high.y());
    view.camera = pane.camera;
    view.camera.target = pane.targets[static_cast<std::size_t>(frame)];
    if (track_) view.lens = lens_at(time);
    view.grid_centre = view.camera.target;
    view.grid_centre.y() = 0;
    view.own_ground = !grounds_.empty();
    if (pane.compares) {
      view.layers.push_back({&made->compared[0], kPale, true});
      view.layers.push_back({&made->compared[1]});
    } else {
      for (const std::size_t i : pane.actors) view.layers.push_back({&made->actors[i]});
    }
    made->frame.views.push_back(std::move(view));
  }
  if (options_->labels) made->frame.label = label_at(frame);
  made->frame.key = key_;
  return made;
}

Json Shot::views_json() const {
  Json views = Json::array();
  for (const Pane& pane : panes_) {
    Json view;
    view["title"] = pane.title;
    view["side"] = track_ ? "camera" : pane.side.name;
    view["box"] = {pane.box.low.x(), pane.box.low.y(), pane.box.high.x(), pane.box.high.y()};
    if (!track_) view["pixels_per_metre"] = pane.camera.pixels_per_metre;
    views.push_back(std::move(view));
  }
  return views;
}

}  // namespace krok::cli::film
