#include "formats/assimp/collada_text_internal.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/numbers.h"
#include "math/transform.h"

namespace krok::assimp {

namespace {

std::string unescaped(std::string_view text) {
  constexpr std::pair<std::string_view, char> kEntities[] = {
      {"&amp;", '&'}, {"&lt;", '<'}, {"&gt;", '>'}, {"&quot;", '"'}, {"&apos;", '\''}};
  std::string plain;
  while (!text.empty()) {
    bool found = false;
    for (const auto& [entity, character] : kEntities) {
      if (!text.starts_with(entity)) continue;
      plain += character;
      text.remove_prefix(entity.size());
      found = true;
      break;
    }
    if (found) continue;
    plain += text.front();
    text.remove_prefix(1);
  }
  return to_utf8(plain);
}

}  // namespace

std::string attribute(std::string_view tag, std::string_view name) {
  for (std::size_t at = tag.find(name); at != std::string_view::npos; at = tag.find(name, at + 1)) {
    std::string_view rest = tag.substr(at + name.size());
    while (!rest.empty() && is_space(rest.front())) rest.remove_prefix(1);
    if (at == 0 || !is_space(tag[at - 1]) || !rest.starts_with('=')) continue;
    rest.remove_prefix(1);
    while (!rest.empty() && is_space(rest.front())) rest.remove_prefix(1);
    if (rest.empty() || (rest[0] != '"' && rest[0] != '\'')) continue;
    const std::size_t end = rest.find(rest[0], 1);
    if (end != std::string_view::npos) return unescaped(rest.substr(1, end - 1));
  }
  return {};
}

std::map<std::string, std::string> collada_node_names(std::string_view text) {
  std::map<std::string, std::string> names;
  for_each_tag(text, "<node", [&](std::string_view tag, std::string_view) {
    std::string id = attribute(tag, "id");
    std::string name = attribute(tag, "name");
    if (!id.empty() && !name.empty()) names.emplace(std::move(id), std::move(name));
  });
  return names;
}

std::set<std::string> collada_joint_ids(std::string_view text) {
  std::set<std::string> ids;
  for_each_tag(text, "<node", [&](std::string_view tag, std::string_view) {
    if (attribute(tag, "type") != "JOINT") return;
    for (const char* key : {"id", "sid", "name"}) {
      if (std::string id = attribute(tag, key); !id.empty()) {
        ids.insert(std::move(id));
        return;
      }
    }
  });
  return ids;
}

namespace {

// The vertical field of view of a <camera>, degrees: <yfov>, or that of <xfov> and <aspect_ratio>
// (4:3 without one).
std::optional<double> field_of_view(std::string_view camera) {
  constexpr double kUsualAspect = 4.0 / 3.0;
  const auto number = [&](std::string_view tag) {
    std::optional<double> value;
    for_each_tag(camera, tag, [&](std::string_view, std::string_view rest) {
      value = parse_finite(trimmed(rest.substr(0, rest.find('<'))));
    });
    return value;
  };
  if (const auto upright = number("<yfov")) return upright;
  const auto across = number("<xfov");
  const double aspect = number("<aspect_ratio").value_or(kUsualAspect);
  if (!across || !(*across > 0 && *across < 180) || !(aspect > 0)) return std::nullopt;
  return 2 * std::atan(std::tan(0.5 * *across * kRadiansPerDegree) / aspect) / kRadiansPerDegree;
}

}  // namespace

std::map<std::string, double> collada_fields_of_view(std::string_view text) {
  std::map<std::string, double> of_camera;
  for_each_tag(text, "<camera", [&](std::string_view tag, std::string_view after) {
    const auto angle = field_of_view(after.substr(0, after.find("</camera")));
    if (angle) of_camera.emplace("#" + attribute(tag, "id"), *angle);
  });
  std::map<std::string, double> of_node;
  std::vector<std::string_view> open;  // tags of the nodes around
  while (!of_camera.empty()) {
    const std::size_t begin = text.find('<');
    const std::size_t end = text.find('>', std::min(begin, text.size()));
    if (end == std::string_view::npos) break;
    const std::string_view tag = text.substr(begin, end - begin);
    text.remove_prefix(end + 1);
    if (tag.starts_with("</node")) {
      if (!open.empty()) open.pop_back();
    } else if (tag.starts_with("<node") && !tag.ends_with('/')) {
      open.push_back(tag);
    } else if (tag.starts_with("<instance_camera") && !open.empty()) {
      const auto found = of_camera.find(attribute(tag, "url"));
      if (found == of_camera.end()) continue;
      for (const char* name : {"id", "sid", "name"}) {
        std::string value = attribute(open.back(), name);
        if (!value.empty()) of_node.emplace(std::move(value), found->second);
      }
    }
  }
  return of_node;
}

std::vector<ColladaClip> collada_clips(std::string_view text) {
  constexpr std::string_view kClose = "</animation_clip>";
  std::vector<ColladaClip> clips;
  for_each_tag(text, "<animation_clip", [&](std::string_view tag, std::string_view after) {
    ColladaClip clip;
    clip.name = attribute(tag, "name");
    if (clip.name.empty()) clip.name = attribute(tag, "id");
    clip.start = parse_finite(attribute(tag, "start")).value_or(0.0);
    clip.end = parse_finite(attribute(tag, "end")).value_or(0.0);
    for_each_tag(after.substr(0, after.find(kClose)), "<instance_animation",
                 [&](std::string_view instance, std::string_view) {
                   const std::string url = attribute(instance, "url");
                   if (url.size() > 1) clip.animations.push_back(url.substr(1));
                 });
    if (!clip.animations.empty()) clips.push_back(std::move(clip));
  });
  return clips;
}

namespace {

bool sampler_ids_are_unique(std::string_view text) {
  std::set<std::string> ids;
  bool unique = true;
  for_each_tag(text, "<sampler", [&](std::string_view tag, std::string_view) {
    std::string id = attribute(tag, "id");
    if (!id.empty()) unique = ids.insert(std::move(id)).second && unique;
  });
  return unique;
}

bool is_tag(std::string_view text, std::string_view tag) {
  return text.size() > tag.size() && text.starts_with(tag) &&
         (is_space(text[tag.size()]) || text[tag.size()] == '>' || text[tag.size()] == '/');
}

// The content of the wanted <animation> elements, without their tags.
std::string contents_of(std::string_view library, const ColladaClip* clip) {
  std::string contents;
  std::vector<bool> wanted = {clip == nullptr};  // by open element
  while (!library.empty()) {
    const std::size_t tag = std::min(library.find('<'), library.size());
    if (wanted.back()) contents += library.substr(0, tag);
    library.remove_prefix(tag);
    if (library.empty()) break;
    const std::size_t end = std::min(library.find('>'), library.size() - 1) + 1;
    const std::string_view whole = library.substr(0, end);
    if (is_tag(whole, "<animation")) {
      const std::string id = attribute(whole, "id");
      const bool named =
          clip != nullptr &&
          std::find(clip->animations.begin(), clip->animations.end(), id) != clip->animations.end();
      if (!whole.ends_with("/>")) wanted.push_back(wanted.back() || named);
    } else if (is_tag(whole, "</animation")) {
      if (wanted.size() > 1) wanted.pop_back();
    } else if (wanted.back()) {
      contents += whole;
    }
    library.remove_prefix(end);
  }
  return contents;
}

}  // namespace

std::string collada_with_one_animation(std::string_view text, const ColladaClip* clip) {
  constexpr std::string_view kOpen = "<library_animations";
  constexpr std::string_view kClose = "</library_animations>";
  constexpr std::string_view kClips = "<library_animation_clips";
  constexpr std::string_view kEndOfClips = "</library_animation_clips>";
  if (!sampler_ids_are_unique(text)) return {};
  std::string mended;
  bool any = false;
  while (!text.empty()) {
    const std::size_t at = std::min({text.find(kOpen), text.find(kClips), text.size()});
    mended += text.substr(0, at);
    text.remove_prefix(at);
    const bool clips = text.starts_with(kClips);
    const std::size_t close = text.find(clips ? kEndOfClips : kClose);
    const std::size_t begin = text.find('>');
    if (close == std::string_view::npos || begin > close) break;
    if (!clips) {
      const std::string_view inside = text.substr(begin + 1, close - begin - 1);
      mended += "<library_animations><animation name=\"\">" + contents_of(inside, clip) +
                "</animation></library_animations>";
      any = true;
    }
    text.remove_prefix(close + (clips ? kEndOfClips : kClose).size());
  }
  mended += text;
  return any ? mended : std::string();
}

bool collada_has_unit(std::string_view text) {
  bool found = false;
  for_each_tag(text, "<unit", [&](std::string_view tag, std::string_view) {
    found = found || !attribute(tag, "meter").empty();
  });
  return found;
}

}  // namespace krok::assimp
