#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/result.h"
#include "render/film.h"
#include "scene/camera_track.h"
#include "tools/krok-render/options.h"
#include "tools/shared/moving_actor.h"
#include "tools/shared/shown_ground.h"

// What a film shows: actors, views with their cameras, and each frame.

namespace krok::cli::film {

// The actors of one frame, to which its views point.
struct ShotFrame {
  std::vector<render::Actor> actors;  // [actors]
  std::vector<render::Actor>
      compared;  // the first in grey and the second coloured, for --difference
  render::FilmFrame frame;
};

struct ShotSetting {
  int width = 0, height = 0;
  double start = 0, end = 0;  // seconds
  double rate = 30;           // frames per second of the film
};

class Shot {
 public:
  // Places the cameras: one scale for all views, at which everything fits in all frames. Codes:
  // film-difference for actors whose points do not correspond, film-long.
  static Result<Shot> create(std::vector<MovingActor> actors, const Options& options,
                             const ShotSetting& setting, SheetGround ground,
                             std::optional<CameraTrack> camera, int jobs);

  int frame_count() const { return frame_count_; }
  double time_of(int frame) const { return setting_.start + frame / setting_.rate; }

  // Thread-safe.
  std::unique_ptr<ShotFrame> make(int frame) const;

  // Views for the report: title, side and box.
  Json views_json() const;
  // The largest distance of --difference in metres.
  double largest() const { return largest_; }

 private:
  // A view and what it shows: actors by index, or the two compared ones.
  struct Pane {
    std::string title;
    std::vector<std::size_t> actors;
    bool compares = false;
    ImageSide side;
    double yaw = 0;
    std::vector<Vec3> targets;  // [frames]
    render::Camera camera;      // without the target
    render::Box box;
  };

  explicit Shot(const Options& options) : options_(&options) {}
  Status measure_difference(int jobs);
  void lay_out_panes();
  void follow();
  void choose_scale(int jobs);
  Status add_ground(SheetGround ground);
  render::Lens lens_at(double time) const;
  std::string label_at(int frame) const;

  const Options* options_;
  ShotSetting setting_;
  int frame_count_ = 0;
  std::vector<MovingActor> actors_;
  std::vector<std::vector<render::Surface>> grounds_;  // [actors], or none
  std::vector<Pane> panes_;
  std::optional<CameraTrack> track_;
  std::optional<render::ColourKey> key_;
  double in_a_metre_ = 1;  // units of the key
  double largest_ = 0;
};

}  // namespace krok::cli::film
