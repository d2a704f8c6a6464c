#include <algorithm>

#include "formats/assimp/clips_internal.h"
#include "nodes/evaluate.h"

namespace krok::assimp {

using namespace nodes;

namespace {

void cut(Channel& channel, float start, float end) {
  const std::vector<float>& times = *channel.times;
  std::vector<float> kept = {start};
  for (const float time : times) {
    if (time > start && time < end) kept.push_back(time);
  }
  kept.push_back(end);
  std::vector<float> new_times, new_values;
  std::vector<double> value(static_cast<std::size_t>(channel.width));
  for (const float time : kept) {
    const float shifted = time - start;
    if (!new_times.empty() && shifted <= new_times.back()) continue;
    sample(channel, static_cast<double>(time), value);
    new_times.push_back(shifted);
    for (const double number : value) new_values.push_back(static_cast<float>(number));
  }
  channel.times = std::make_shared<const std::vector<float>>(std::move(new_times));
  channel.values = std::make_shared<const std::vector<float>>(std::move(new_values));
}

}  // namespace

void shape_clip(const ColladaClip& clip, Animation& animation) {
  animation.name = clip.name;
  if (!(clip.end > clip.start)) return;
  for (Channel& channel : animation.channels) {
    cut(channel, static_cast<float>(clip.start), static_cast<float>(clip.end));
  }
}

}  // namespace krok::assimp
