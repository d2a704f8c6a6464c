#include "timeline/mix.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/numbers.h"
#include "core/parallel.h"
#include "core/text.h"
#include "motion/hips_root.h"
#include "scene/clip.h"
#include "timeline/result_keys_internal.h"

namespace krok::timeline {

namespace {

constexpr std::size_t kFramesAtOnce = 32;
constexpr double kMaxEvents = 2e6;
constexpr std::size_t kMaxLayerItems = 20'000;
constexpr double kMaxWork = 2e9;  // frames or events, times layer items

Status check_sources(std::span<const Source> sources) {
  for (const Source& source : sources) {
    if (Status status = check(*source.clip); !status) {
      return std::move(status).error().in_file(source.name);
    }
    if (source.clip->frame_count() == 0) {
      return Error("timeline-empty", fmt::format("{} has no frames", shown(source.name)));
    }
    const std::string differs =
        difference_in_structure(sources.front().clip->skeleton, source.clip->skeleton);
    if (!differs.empty()) {
      return Error("timeline-skeleton",
                   fmt::format("{} and {} have different skeletons: {}",
                               shown(sources.front().name), shown(source.name), differs),
                   "use krok-retarget to transfer one to the other's skeleton");
    }
    if (source.keys == nullptr) continue;
    if (Status status = check(*source.keys, source.clip->skeleton, source.clip->duration());
        !status) {
      return std::move(status).error().in_file(source.name);
    }
  }
  return {};
}

// Limits the amount of work: each round may have many keytimes and marks, and there may be many
// layers.
Status check_work(const Timeline& timeline, std::span<const Source> sources,
                  std::span<const ScheduledItem> items, std::span<const LayerPlayer> layers,
                  const Clip& clip) {
  double events = 0, on_top = 0, transforms = 0;
  const auto count = [&](const PlayedRange& range, double play, std::size_t marks) {
    const MotionKeys* keys = sources[static_cast<std::size_t>(range.source)].keys;
    const std::size_t each =
        1 + marks + (keys == nullptr ? 0 : keys->contacts.size() + keys->keytimes.size());
    events += (range.at(play).round + 1.0) * static_cast<double>(each);
  };
  for (std::size_t i = 0; i < items.size(); ++i) {
    count(items[i].range, items[i].play_time(items[i].end), timeline.base[i].marks.size());
  }
  for (std::size_t l = 0; l < layers.size(); ++l) {
    for (std::size_t i = 0; i < layers[l].items().size(); ++i) {
      const LayerTimes& times = layers[l].items()[i];
      count(times.range, times.end - times.start, timeline.layers[l].items[i].marks.size());
      on_top += 1;
      transforms += ((times.end - times.start) * clip.rate + 1) * clip.joint_count();
    }
  }
  if (events > kMaxEvents) {
    return Error("timeline-limit",
                 "the result would have more than two million keytimes, contacts and events",
                 "use fewer repetitions of short motions");
  }
  const double frames = clip.frame_count();
  if (std::max({frames * on_top, events * on_top, transforms}) > kMaxWork) {
    return Error("timeline-limit", "too many layer items for the number of frames",
                 "split the timeline");
  }
  return {};
}

// Evaluates the base and applies the layers.
void make_frames(const BaseMotion& base, std::span<const LayerPlayer> layers, int jobs,
                 Clip& clip) {
  const std::size_t joints = clip.skeleton.names.size();
  parallel_for(
      static_cast<std::size_t>(clip.frame_count()), kFramesAtOnce, jobs,
      [&](std::size_t begin, std::size_t end) {
        std::vector<Transform> world(joints);
        std::vector<std::uint8_t> touched(joints);
        for (std::size_t i = begin; i < end; ++i) {
          const int frame = static_cast<int>(i);
          const double time = frame / clip.rate;
          const auto untouched = base.untouched(time);
          if (untouched.clip != nullptr) {
            std::ranges::copy(untouched.clip->frame_positions(untouched.frame),
                              clip.frame_positions(frame).begin());
            std::ranges::copy(untouched.clip->frame_orientations(untouched.frame),
                              clip.frame_orientations(frame).begin());
          } else {
            base.pose(time, world);
            clip.set_pose(frame, world);
          }
          if (std::ranges::none_of(layers, [&](const auto& l) { return l.is_seen(time); })) {
            continue;
          }
          clip.get_pose(frame, world);
          ActorPose pose = actor_pose(clip.skeleton, base.carrier(), world);
          std::ranges::fill(touched, std::uint8_t{0});
          for (const LayerPlayer& layer : layers) {
            if (!layer.is_seen(time)) continue;
            layer.apply(time, pose);
            for (std::size_t j = 0; j < joints; ++j) touched[j] |= layer.touched()[j];
          }
          to_world(clip.skeleton, pose, world);
          for (std::size_t j = 0; j < joints; ++j) {
            if (!touched[j]) continue;
            clip.frame_positions(frame)[j] = world[j].position.cast<float>();
            clip.frame_orientations(frame)[j] = world[j].orientation.normalized().cast<float>();
          }
        }
      });
}

// Mixes motions rooted at the hips.
Result<Mixed> mix_rooted(const Timeline& timeline, std::span<const Source> sources,
                         const HipsRoot& hips_root, const RoleMap& roles,
                         const MixOptions& options) {
  double rate = timeline.rate;
  if (rate == 0) {
    // schedule() reports an invalid source index.
    const auto first = static_cast<std::size_t>(timeline.base.front().play.source);
    rate = sources[first < sources.size() ? first : 0].clip->rate;
  }
  if (Status status = check_frame_rate(rate, "clip-rate"); !status) return status.error();
  auto items = schedule(timeline, sources, rate);
  if (!items) return items.error();
  const double end = items->back().end;
  const Skeleton& skeleton = sources.front().clip->skeleton;
  const auto frames = frames_within(end, rate, skeleton.joint_count());
  if (!frames) return frames.error();
  const int carrier = carrying_joint(roles);
  std::vector<LayerPlayer> layers;
  std::size_t layer_items = 0;
  for (const Layer& layer : timeline.layers) {
    layer_items += layer.items.size();
    if (layer_items > kMaxLayerItems) {
      return Error("timeline-limit",
                   fmt::format("layers have more than {} items in total", grouped(kMaxLayerItems)));
    }
    auto player = LayerPlayer::create(layer, sources, hips_root, carrier, rate, end);
    if (!player) return player.error();
    layers.push_back(std::move(*player));
  }
  Mixed mixed;
  mixed.clip.skeleton = skeleton;
  mixed.clip.rate = rate;
  mixed.clip.resize(*frames);
  if (Status status = check_work(timeline, sources, *items, layers, mixed.clip); !status) {
    return status.error();
  }
  const BaseMotion base(timeline, sources, roles, std::move(*items), rate);
  make_frames(base, layers, options.jobs, mixed.clip);

  const Parts parts{timeline, sources, base, layers, mixed.clip, options.jobs, hips_root, roles};
  auto events = result_events(parts, mixed.warnings);
  if (!events) return events.error();
  mixed.events = std::move(*events);
  mixed.keys = result_keys(parts);
  mixed.items = result_items(parts);
  mixed.changes = result_changes(parts, mixed.warnings);
  return mixed;
}

}  // namespace

Result<Mixed> mix(const Timeline& timeline, std::span<const Source> sources, const RoleMap& roles,
                  const MixOptions& options) {
  if (timeline.base.empty() || sources.empty()) {
    return Error("timeline-empty", "the timeline is empty");
  }
  if (Status status = check_sources(sources); !status) return status.error();
  std::vector<const Clip*> clips;
  for (const Source& source : sources) clips.push_back(source.clip);
  const HipsRoot hips_root(clips, carrying_joint(roles));
  if (!hips_root.changes()) return mix_rooted(timeline, sources, hips_root, roles, options);
  std::vector<Clip> rooted;
  rooted.reserve(sources.size());
  std::vector<Source> rooted_sources(sources.begin(), sources.end());
  for (Source& source : rooted_sources) {
    source.clip = &rooted.emplace_back(hips_root.rooted(*source.clip));
  }
  auto mixed = mix_rooted(timeline, rooted_sources, hips_root, roles, options);
  if (!mixed) return mixed;
  mixed->clip = hips_root.restored(mixed->clip, clips.front()->skeleton);
  for (ChangeFacts& change : mixed->changes) {
    change.angle_joint = hips_root.original(change.angle_joint);
    change.fastest_joint = hips_root.original(change.fastest_joint);
    for (Pace& pace : change.paces) pace.joint = hips_root.original(pace.joint);
  }
  return mixed;
}

}  // namespace krok::timeline
