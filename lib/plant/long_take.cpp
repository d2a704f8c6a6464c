#include "plant/long_take.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <tuple>
#include <utility>

#include "contacts/legs.h"
#include "core/index.h"
#include "math/hermite.h"
#include "math/quaternion.h"
#include "plant/foot_paths_internal.h"
#include "scene/frame_source.h"

namespace krok {

namespace {

constexpr double kMargin = 10, kFade = 0.5;  // seconds

class Parts {
 public:
  Parts(const FrameSource& source, std::optional<std::vector<Contact>> contacts,
        std::optional<RootMotion> removed, PlantPart plant)
      : skeleton_(source.skeleton),
        frames_(source.frame_count),
        contacts_(std::move(contacts)),
        removed_(std::move(removed)),
        plant_(std::move(plant)) {}

  Status change(FrameRun& run) {
    const double from = run.first / run.clip.rate;
    std::optional<std::vector<Contact>> given;
    if (contacts_) given = part_of({*contacts_, {}}, from, from + run.clip.duration()).contacts;
    run.clip.provenance.removed_root_motion = removed_;
    auto planted = plant_(run.clip, given);
    const int begin = run.first + run.kept_begin, end = run.first + run.kept_end;
    if (!planted && (planted.error().code != "plant-contacts" || end - begin == frames_)) {
      return planted.error();
    }
    if (planted) {
      run.clip = std::exchange(planted->clip, {});
      for (auto* stays : {&planted->stays, &planted->rolls}) {
        for (FixedStay& stay : *stays) stay.first += run.first, stay.last += run.first;
        std::erase_if(
            *stays, [&](const FixedStay& stay) { return stay.first < begin || stay.first >= end; });
      }
      done_[begin] = {end - begin, *std::move(planted), {}};
    }
    const int changed = go_over(tails_[begin], run);
    const auto part = done_.find(begin);
    if (part != done_.end()) measure(run, changed, part->second);
    if (part != done_.begin()) measure(run, changed, std::prev(part)->second);
    const int count = run.clip.frame_count() - run.kept_end;
    auto tail = load(part_of(frames_of(run.clip), run.kept_end, count / 2), 1);
    if (!tail) return tail.error();
    tails_[end] = *std::move(tail);
    return {};
  }

  PlantedFeet done() const {
    PlantedFeet all;
    all.clip.skeleton = skeleton_;
    double squares = 0, stands = 0;
    int frames = 0;  // of parts with a stance
    for (const auto& [begin, part] : done_) {
      const PlantedFeet& one = part.planted;
      all.stays.insert(all.stays.end(), one.stays.begin(), one.stays.end());
      all.rolls.insert(all.rolls.end(), one.rolls.begin(), one.rolls.end());
      for (const auto value :
           {&PlantedFeet::drift_before, &PlantedFeet::roll_before, &PlantedFeet::pelvis_lowered}) {
        all.*value = std::max(all.*value, one.*value);
      }
      for (const FixedStay& stay : one.stays) {
        if (stay.point.part == FootPart::tip) continue;
        all.drift_after = std::max(all.drift_after, stay.drift_after);
      }
      for (const FixedStay& roll : one.rolls) {
        all.roll_after = std::max(all.roll_after, roll.drift_after);
      }
      squares += one.body_steadied * one.body_steadied * part.frames;
      all.out_of_reach += one.out_of_reach;
      if (one.stance_share) stands += *one.stance_share * part.frames, frames += part.frames;
      for (const Diagnostic& warning : one.warnings) {
        if (std::ranges::find(all.warnings, warning.code, &Diagnostic::code) !=
            all.warnings.end()) {
          continue;
        }
        all.warnings.push_back(warning);
        if (part.frames == frames_) continue;
        all.warnings.back().message += fmt::format(" (in the part from frame {} on)", begin);
      }
    }
    const auto order = [](const FixedStay& stay) {
      return std::tuple(stay.point.side, stay.point.part, stay.first);
    };
    std::ranges::stable_sort(all.stays, {}, order);
    std::ranges::stable_sort(all.rolls, {}, [](const FixedStay& roll) { return roll.point.side; });
    all.body_steadied = std::sqrt(squares / frames_);
    if (frames > 0) all.stance_share = stands / frames;
    return all;
  }

 private:
  struct Part {
    int frames = 0;
    PlantedFeet planted;
    std::map<const FixedStay*, std::vector<Vec3>> tracks;  // of stays that go on in the part after
  };

  // Drifts of stays that are in the first frames of a run, which were `changed`.
  static void measure(const FrameRun& run, int changed, Part& part) {
    const int begin = run.first + run.kept_begin, end = run.first + run.kept_end;
    for (auto* stays : {&part.planted.stays, &part.planted.rolls}) {
      for (FixedStay& stay : *stays) {
        const bool is_changed = changed > 0 && stay.first < begin + changed;
        if (stay.last < begin || (!is_changed && stay.last < end)) continue;
        std::vector<Vec3>& track = part.tracks[&stay];
        for (int f = std::max(stay.first, begin); f <= std::min(stay.last, end - 1); ++f) {
          track.push_back(joint_at(run.clip, f - run.first, stay.point.joint) * stay.point.offset);
          if (stays == &part.planted.rolls) track.back().y() = 0;
        }
        if (is_changed) {
          stay.drift_after = plant::drift_of(track, 0, static_cast<int>(track.size()) - 1);
        }
        if (stay.last < end) part.tracks.erase(&stay);
      }
    }
  }

  // From the frames in which the part before goes on to those of a part, where they are nearest to
  // each other. Returns how many are no longer those of the part.
  static int go_over(Clip& before, FrameRun& run) {
    const int count = std::min(before.frame_count(), run.kept_end - run.kept_begin);
    const int fade = static_cast<int>(std::lround(kFade * run.clip.rate));
    if (count < fade) return 0;
    std::vector<float> apart;  // squares, [frames]
    for (int i = 0; i < count; ++i) {
      const auto to = run.clip.frame_positions(run.kept_begin + i);
      const auto from = before.frame_positions(i);
      float farthest = 0;
      for (std::size_t j = 0; j < to.size(); ++j) {
        farthest = std::max(farthest, (to[j] - from[j]).squaredNorm());
      }
      apart.push_back(farthest);
    }
    int first = 0;
    float gap = INFINITY;
    for (int i = 0; i + fade <= count; ++i) {
      const float here = *std::max_element(apart.begin() + i, apart.begin() + i + fade);
      if (here < gap) gap = here, first = i;
    }
    for (int i = 0; i < first + fade; ++i) {
      const double share = smoother_step((i - first + 1.0) / (fade + 1));
      const auto to = run.clip.frame_positions(run.kept_begin + i);
      const auto from = before.frame_positions(i);
      const auto turn_to = run.clip.frame_orientations(run.kept_begin + i);
      const auto turn_from = before.frame_orientations(i);
      for (std::size_t j = 0; j < to.size(); ++j) {
        to[j] = from[j] + static_cast<float>(share) * (to[j] - from[j]);
        turn_to[j] =
            slerp(turn_from[j].cast<double>(), turn_to[j].cast<double>(), share).cast<float>();
      }
    }
    before.resize(first + fade);  // enough to do it again
    return gap > 0 ? first + fade : first;
  }

  Skeleton skeleton_;
  int frames_;
  std::optional<std::vector<Contact>> contacts_;
  std::optional<RootMotion> removed_;
  PlantPart plant_;
  std::map<int, Part> done_;   // by the first frame
  std::map<int, Clip> tails_;  // of the part before, by the first frame after it
};

}  // namespace

PlantedFrames plant_long_take(const FrameSource& source,
                              const std::optional<std::vector<Contact>>& contacts,
                              const std::optional<RootMotion>& removed, int jobs, PlantPart plant,
                              std::size_t part_bytes) {
  const std::size_t frame = (sizeof(Vec3f) + sizeof(Quatf)) * source.skeleton.names.size();
  BlockSize size;
  size.frames = static_cast<int>(std::clamp<std::size_t>(
      part_bytes / std::max<std::size_t>(frame, 1), 16, std::size_t{1} << 24));
  size.overlap = static_cast<int>(std::min<double>(std::ceil(kMargin * source.rate), size.frames));
  const auto parts = std::make_shared<Parts>(source, contacts, removed, std::move(plant));
  return {
      changed_in_blocks(source, size, jobs, [parts](FrameRun& run) { return parts->change(run); }),
      [parts] { return parts->done(); }};
}

}  // namespace krok
