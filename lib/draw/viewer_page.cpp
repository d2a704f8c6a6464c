#include "draw/viewer_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "core/text.h"
#include "draw/motion_charts.h"
#include "draw/pack_motion_internal.h"
#include "draw/page_text_internal.h"

namespace krok::draw {

namespace {

// Parts of the page: the JSON description and the script elements with the arrays.
struct Parts {
  Json items = Json::array();
  std::string scripts;

  Json start(const char* kind, const std::string& name, const std::string& facts) const {
    Json item;
    item["kind"] = kind;
    item["name"] = name;
    if (!facts.empty()) item["facts"] = facts;
    return item;
  }

  // Bodies and their materials that several motions share are on the page once.
  std::map<std::pair<const Model*, const Material*>, Json> bodies;

  void finish(Json item, const std::string& base64) {
    const std::string id = fmt::format("krok-blob-{}", items.size());
    item["blob"] = id;
    items.push_back(std::move(item));
    add_blob(id, base64);
  }

  void add_blob(const std::string& id, const std::string& base64) {
    scripts += fmt::format("<script type=\"application/octet-stream\" id=\"{}\">", id);
    scripts += base64;
    scripts += "</script>\n";
  }
};

// Nine numbers a frame: from, to, strength, distance, angle.
Status add_goals(const ViewedMotion& viewed, Json& item, Blob& blob) {
  Json goals = Json::array();
  for (const ViewedGoal& goal : viewed.goals) {
    const bool joints = std::ranges::all_of(
        goal.chain, [&](int joint) { return joint >= 0 && joint < viewed.clip->joint_count(); });
    if (!joints || goal.frames.size() != static_cast<std::size_t>(viewed.clip->frame_count())) {
      return Error("viewer-goal",
                   fmt::format("the goal '{}' is not one of the motion's", goal.name));
    }
    std::vector<float> numbers;
    for (const ViewedGoal::Frame& frame : goal.frames) {
      for (const double number :
           {frame.from.x(), frame.from.y(), frame.from.z(), frame.to.x(), frame.to.y(),
            frame.to.z(), frame.strength, frame.distance, frame.angle}) {
        numbers.push_back(static_cast<float>(number));
      }
    }
    Json entry;
    entry["name"] = goal.name;
    entry["kind"] = goal.kind;
    entry["chain"] = goal.chain;
    entry["frames"] = blob.add(std::span<const float>(numbers));
    goals.push_back(std::move(entry));
  }
  if (!goals.empty()) item["goals"] = std::move(goals);
  return {};
}

Error not_there(const char* what) {
  return {"viewer-ground", fmt::format("{} that is not there", what)};
}

Status add_print_contacts(const ViewedMotion& viewed, std::size_t prints, Json& item) {
  Json contacts = Json::array();
  for (const ViewedPrintContact& contact : viewed.print_contacts) {
    if (contact.print < 0 || static_cast<std::size_t>(contact.print) >= prints) {
      return not_there("a motion stands on a footprint");
    }
    contacts.push_back({contact.print, contact.start, contact.end});
  }
  if (!contacts.empty()) item["printContacts"] = std::move(contacts);
  return {};
}

std::span<const float> numbers_of(const std::vector<Vec3f>& vectors) {
  return {vectors.empty() ? nullptr : vectors.front().data(), 3 * vectors.size()};
}

Status add_ground(const ViewedGround& ground, Parts& parts, Json& data) {
  if (ground.triangles.empty()) return {};
  for (const auto& corners : ground.triangles) {
    if (std::ranges::max(corners) >= ground.positions.size() ||
        ground.normals.size() != ground.positions.size()) {
      return not_there("a triangle of the ground has a corner");
    }
  }
  Blob blob;
  Json item;
  item["blob"] = "krok-ground";
  item["positions"] = blob.add(numbers_of(ground.positions));
  item["normals"] = blob.add(numbers_of(ground.normals));
  item["triangles"] = blob.add(
      std::span<const std::uint32_t>(ground.triangles.front().data(), 3 * ground.triangles.size()));
  parts.add_blob("krok-ground", blob.base64());
  data["ground"] = std::move(item);
  return {};
}

// To a hundredth of a millimetre.
Json rounded(const Vec3& vector) {
  Json numbers = Json::array();
  for (const double x : vector) numbers.push_back(std::round(x * 1e5) / 1e5);
  return numbers;
}

void add_prints(const std::vector<ViewedPrint>& prints, Json& data) {
  if (prints.empty()) return;
  Json outline = Json::array();
  for (const Vec2& point : sole_outline()) outline.push_back({point.x(), point.y()});
  Json list = Json::array();
  for (const ViewedPrint& print : prints) {
    list.push_back({{"side", print.left ? "left" : "right"},
                    {"number", print.number},
                    {"heel", rounded(print.heel)},
                    {"forward", rounded(print.forward)},
                    {"up", rounded(print.up)},
                    {"length", print.length}});
  }
  data["prints"] = {{"outline", std::move(outline)}, {"list", std::move(list)}};
}

Result<Json> add_body(const Model& model, std::span<const Material> materials, Parts& parts) {
  const std::pair key(&model, materials.data());
  if (const auto found = parts.bodies.find(key); found != parts.bodies.end()) return found->second;
  if (Status status = check(model); !status) return status.error();
  Blob blob;
  Json body = pack_body(model, blob);
  if (!materials.empty() || !model.colours.empty()) {
    if (Status status = check(materials); !status) return status.error();
    auto look = pack_look(model, materials, blob);
    if (!look) return look.error();
    body["look"] = std::move(*look);
  }
  const std::string id = fmt::format("krok-body-{}", parts.bodies.size());
  body["blob"] = id;
  parts.add_blob(id, blob.base64());
  parts.bodies.emplace(key, body);
  return body;
}

Status add_motion(const ViewedMotion& viewed, std::size_t prints, Parts& parts) {
  const Clip& clip = *viewed.clip;
  if (Status status = check(clip); !status) return status;
  Json item = parts.start("motion", viewed.name, viewed.facts);
  item["visible"] = viewed.visible;
  Blob blob;
  pack_motion(clip, item, blob);
  if (viewed.body != nullptr) {
    const std::string difference = difference_in_structure(clip.skeleton, viewed.body->skeleton);
    if (!difference.empty()) {
      return Error(
          "viewer-body",
          fmt::format("the body does not have the skeleton of the motion: {}", difference));
    }
    auto body = add_body(*viewed.body, viewed.materials, parts);
    if (!body) return body.error();
    item["body"] = *std::move(body);
  }
  if (Status status = check(viewed.keys, clip.skeleton, clip.duration()); !status) return status;
  Json contacts = Json::array();
  for (const Contact& contact : viewed.keys.contacts) {
    contacts.push_back({{"joint", contact.joint}, {"start", contact.start}, {"end", contact.end}});
  }
  if (!contacts.empty()) item["contacts"] = std::move(contacts);
  Json keytimes = Json::array();
  for (const Keytime& key : viewed.keys.keytimes) {
    keytimes.push_back({{"time", key.time}, {"name", key.name}});
  }
  if (!keytimes.empty()) item["keytimes"] = std::move(keytimes);
  if (Status status = add_goals(viewed, item, blob); !status) return status;
  if (Status status = add_print_contacts(viewed, prints, item); !status) return status;
  parts.finish(std::move(item), blob.base64());
  return {};
}

// JSON inside a script element must not contain "</script" or "<!--", whatever the names contain.
std::string script_safe(std::string_view text) {
  std::string safe;
  safe.reserve(text.size());
  for (const char c : text) {
    if (c == '<') {
      safe += "\\u003c";
    } else {
      safe += c;
    }
  }
  return safe;
}

}  // namespace

Result<std::string> write_viewer_page(const ViewerPage& page) {
  Parts parts;
  for (const ViewedMotion& motion : page.motions) {
    if (Status status = add_motion(motion, page.prints.size(), parts); !status) {
      return status.error();
    }
  }
  for (std::size_t i = 0; i < page.files.size(); ++i) {
    const ViewedGlb& file = page.files[i];
    Json item = parts.start("gltf", file.name, file.facts);
    item["visible"] = file.visible;
    item["animation"] = file.animation;
    item["rates"] = file.rates;
    if (i > 0 && file.difference) {
      const ViewedDifference& difference = *file.difference;
      item["difference"] = {{"from", page.files[i - 1].name},
                            {"animation", difference.animation},
                            {"other_animation", difference.other_animation},
                            {"times", difference.times},
                            {"distances", difference.distances},
                            {"time", difference.time},
                            {"distance", difference.distance}};
    }
    parts.finish(std::move(item), to_base64(file.bytes));
  }
  for (const ViewedCamera& viewed : page.cameras) {
    if (Status status = check(*viewed.camera); !status) return status.error();
    Json item = parts.start("camera", viewed.name, viewed.facts);
    Blob blob;
    pack_camera(*viewed.camera, item, blob);
    parts.finish(std::move(item), blob.base64());
  }
  Json data;
  data["schema"] = "krok.view/1";
  data["title"] = page.title;
  data["apart"] = page.apart;
  data["difference"] = page.difference;
  if (Status status = add_ground(page.ground, parts, data); !status) return status.error();
  add_prints(page.prints, data);
  data["items"] = std::move(parts.items);

  constexpr std::string_view kPlace = "<!--krok-data-->";
  const std::string_view text = page_text();
  const std::size_t place = text.find(kPlace);
  std::string html(text.substr(0, place));
  html += "<script type=\"application/json\" id=\"krok-data\">";
  // Invalid UTF-8 in names is shown as replacement characters.
  html += script_safe(json_text(data));
  html += "</script>\n";
  html += parts.scripts;
  html += text.substr(place + kPlace.size());
  return html;
}

}  // namespace krok::draw
