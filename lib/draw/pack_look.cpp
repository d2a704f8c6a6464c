#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "draw/pack_motion_internal.h"
#include "retarget/stance.h"
#include "roles/roles.h"

namespace krok::draw {

namespace {

bool is_unknown_to_browsers(const EncodedImage& image) {
  const auto facts = image_info(image.bytes);
  return facts && facts->kind == ImageKind::ktx2;
}

// Packs materials for three.js (page/src/look.js), and each image once.
class LookPacker {
 public:
  LookPacker(const Model& body, Blob& blob) : body_(body), blob_(blob) {}

  Result<Json> pack(std::span<const Material> materials) {
    Json parts = Json::array();
    for (const Model::Part& part : body_.parts) {
      const auto place = place_of(part.material, materials);
      if (!place) return place.error();
      parts.push_back({{"first", part.first_triangle * 3},
                       {"count", part.triangle_count * 3},
                       {"material", *place}});
    }
    Json look;
    look["parts"] = std::move(parts);
    look["materials"] = std::move(materials_);
    look["pictures"] = std::move(images_);
    if (!body_.texture_coordinates.empty()) {
      Json sets = Json::array({add(body_.texture_coordinates)});
      for (const auto& set : body_.more_texture_coordinates) {
        if (sets.size() < kSets) sets.push_back(add(set));
      }
      look["coordinates"] = std::move(sets);
    }
    if (!body_.colours.empty()) look["colours"] = add(body_.colours);
    return look;
  }

 private:
  static constexpr std::size_t kSets = 4;  // that three.js has names for

  template <typename Vector>
  Json add(const std::vector<Vector>& rows) {
    return blob_.add(std::span(rows.front().data(), rows.size() * Vector::RowsAtCompileTime));
  }

  // Index of the material in the page's list. Unset properties keep their defaults.
  Result<std::size_t> place_of(const std::string& name, std::span<const Material> materials) {
    const auto [at, added] = places_.try_emplace(name, materials_.size());
    if (!added) return at->second;
    static const Material kUsual;
    const Material* const found = find_material(materials, name);
    auto json = to_json(found != nullptr ? *found : kUsual);
    if (!json) return json.error();
    materials_.push_back(std::move(*json));
    return at->second;
  }

  Result<Json> to_json(const Material& material) {
    static constexpr std::array<const char*, 3> kAlphas = {"opaque", "mask", "blend"};
    static constexpr std::array<const char*, 5> kTextures = {"baseColor", "metallicRoughness",
                                                             "normal", "occlusion", "emissive"};
    Json json;
    json["color"] = list(material.base_color);
    json["metallic"] = material.metallic;
    json["roughness"] = material.roughness;
    json["normalScale"] = material.normal_scale;
    json["occlusion"] = material.occlusion_strength;
    json["emissive"] = list(material.emissive);
    json["alpha"] = kAlphas[static_cast<std::size_t>(material.alpha)];
    json["cutoff"] = material.alpha_cutoff;
    json["doubleSided"] = material.double_sided;
    json["unlit"] = material.unlit;
    Json textures = Json::object();
    const auto all = textures_of(material);
    for (std::size_t t = 0; t < all.size() && !body_.texture_coordinates.empty(); ++t) {
      const auto set = static_cast<std::size_t>(all[t]->set);
      if (!*all[t] || is_unknown_to_browsers(*all[t]->image) ||
          set > body_.more_texture_coordinates.size() || set >= kSets)
        continue;
      auto texture = to_json(*all[t]);
      if (!texture) return texture.error();
      textures[kTextures[t]] = std::move(*texture);
    }
    json["textures"] = std::move(textures);
    return json;
  }

  Result<Json> to_json(const Texture& texture) {
    static constexpr std::array<const char*, 3> kWraps = {"repeat", "clamp", "mirror"};
    const auto [at, added] = image_places_.try_emplace(texture.image.get(), images_.size());
    if (added) {
      const auto facts = image_info(texture.image->bytes);
      if (!facts) return facts.error();
      Json image = blob_.add(std::span(texture.image->bytes));
      image["type"] = media_type(facts->kind);
      images_.push_back(std::move(image));
    }
    Json json{{"picture", at->second},
              {"wrapU", kWraps[static_cast<std::size_t>(texture.wrap_u)]},
              {"wrapV", kWraps[static_cast<std::size_t>(texture.wrap_v)]},
              {"smooth", texture.smooth}};
    if (texture.set != 0) json["set"] = texture.set;
    if (texture.transforms()) {
      // Where (0, 0), (1, 0) and (0, 1) come to.
      json["transform"] = {list(texture.at(Vec2f(0, 0))), list(texture.at(Vec2f(1, 0))),
                           list(texture.at(Vec2f(0, 1)))};
    }
    return json;
  }

  template <typename Vector>
  static Json list(const Vector& values) {
    Json numbers = Json::array();
    for (const float value : values) numbers.push_back(value);
    return numbers;
  }

  const Model& body_;
  Blob& blob_;
  Json materials_ = Json::array(), images_ = Json::array();
  std::map<std::string, std::size_t> places_;
  std::map<const EncodedImage*, std::size_t> image_places_;
};

}  // namespace

Result<Json> pack_look(const Model& body, std::span<const Material> materials, Blob& blob) {
  return LookPacker(body, blob).pack(materials);
}

namespace {

using Children = std::vector<std::vector<int>>;

// Lengths of stubs as shares of the body's extent, about those of a person.
constexpr double kHeadShare = 0.12;
constexpr double kFootShare = 0.12;
constexpr double kToesShare = 0.05;
constexpr double kLimit = 0.08;     // of all others
constexpr double kOfBone = 0.5;     // and of the bone before
constexpr double kShortest = 1e-4;  // metres; a shorter bone has no direction

bool is_foot(Role role) {
  return role == Role::left_foot || role == Role::right_foot;
}

bool is_toes(Role role) {
  return role == Role::left_toes || role == Role::right_toes;
}

bool is_limb(Role role) {
  return role != Role::none && role != Role::root && role != Role::end && role != Role::helper;
}

// Without known hips: below a root with one child that moves against it, that child.
int moving_child(const Children& children, std::span<const std::uint8_t> moves) {
  int at = 0;
  while (children[static_cast<std::size_t>(at)].size() == 1) {
    const int child = children[static_cast<std::size_t>(at)].front();
    if (moves[static_cast<std::size_t>(child)] == 0 ||
        children[static_cast<std::size_t>(child)].empty())
      break;
    at = child;
  }
  return at;
}

std::vector<int> joints_below(int joint, const Children& children) {
  std::vector<int> found;
  if (joint < 0) return found;
  found.push_back(joint);
  for (std::size_t i = 0; i < found.size(); ++i) {
    const auto& next = children[static_cast<std::size_t>(found[i])];
    found.insert(found.end(), next.begin(), next.end());
  }
  std::ranges::sort(found);
  return found;
}

// Joints at and above `hips`, without the root itself, and what else hangs on the joints above.
std::vector<int> loose_joints(const Skeleton& skeleton, const RoleMap& map, int hips,
                              const Children& children) {
  std::vector<std::uint8_t> above(skeleton.names.size(), 0);
  for (int at = skeleton.parents[static_cast<std::size_t>(hips)]; at >= 0;
       at = skeleton.parents[static_cast<std::size_t>(at)]) {
    above[static_cast<std::size_t>(at)] = 1;
  }
  std::vector<int> loose;
  for (int joint = 1; joint < skeleton.joint_count(); ++joint) {
    const auto at = static_cast<std::size_t>(joint);
    if (above[static_cast<std::size_t>(skeleton.parents[at])] == 0) continue;
    const auto below = joints_below(joint, children);
    const bool limb = std::ranges::any_of(
        below, [&](int each) { return is_limb(map.roles[static_cast<std::size_t>(each)]); });
    if (joint == hips || above[at] != 0 || !limb) loose.push_back(joint);
  }
  return loose;
}

// The largest extent of the joints from `hips` on.
double body_extent(const Skeleton& skeleton, int hips, const Children& children) {
  Vec3 low = skeleton.reference[static_cast<std::size_t>(hips)].position;
  Vec3 high = low;
  for (const int joint : joints_below(hips, children)) {
    const Vec3& place = skeleton.reference[static_cast<std::size_t>(joint)].position;
    low = low.cwiseMin(place);
    high = high.cwiseMax(place);
  }
  return (high - low).maxCoeff();
}

class StubFinder {
 public:
  StubFinder(const Skeleton& standing, const RoleMap& map, double extent)
      : standing_(standing), map_(map), extent_(extent) {}

  // Zero for none.
  Vec3 tip(int joint) const {
    const auto at = static_cast<std::size_t>(joint);
    const Role role = map_.roles[at];
    const int parent = standing_.parents[at];
    const Vec3 along = place(joint) - place(parent);
    const double bone = along.norm();
    if (role == Role::helper || bone < kShortest) return Vec3::Zero();
    Vec3 direction = along / bone;
    double length = std::min(kOfBone * bone, kLimit * extent_);
    if (role == Role::head) length = kHeadShare * extent_;
    if (is_foot(role) || is_toes(role)) {
      direction = along_sole(joint, role);
      length = (is_foot(role) ? kFootShare : kToesShare) * extent_;
    }
    return standing_.reference[at].orientation.conjugate() * (direction * length);
  }

 private:
  const Vec3& place(int joint) const {
    return standing_.reference[static_cast<std::size_t>(joint)].position;
  }

  // What the direction of a foot has across the shank; ahead of the body if that is nothing.
  Vec3 along_sole(int joint, Role role) const {
    const bool left = role == Role::left_foot || role == Role::left_toes;
    const int ankle = map_.joint(left ? Role::left_foot : Role::right_foot);
    const int knee = map_.joint(left ? Role::left_lower_leg : Role::right_lower_leg);
    const auto parent = standing_.parents[static_cast<std::size_t>(joint)];
    if (ankle < 0 || knee < 0) return (place(joint) - place(parent)).normalized();
    const Vec3 down = (place(ankle) - place(knee)).normalized();
    Vec3 foot = place(joint) - place(is_foot(role) ? knee : ankle);
    foot -= down * foot.dot(down);
    if (foot.norm() > 0.1 * extent_ * kToesShare) return foot.normalized();
    const int left_leg = map_.joint(Role::left_upper_leg);
    const int right_leg = map_.joint(Role::right_upper_leg);
    if (left_leg < 0 || right_leg < 0) return Vec3::UnitZ();
    const Vec3 ahead = (place(left_leg) - place(right_leg)).cross(-down);
    return ahead.norm() > 1e-9 ? Vec3(ahead.normalized()) : Vec3(Vec3::UnitZ());
  }

  const Skeleton& standing_;
  const RoleMap& map_;
  double extent_;
};

}  // namespace

DrawnBones find_drawn_bones(const Clip& clip, std::span<const std::uint8_t> moves) {
  const Skeleton& skeleton = clip.skeleton;
  const Children children = skeleton.children();
  const RoleMap map = find_roles(skeleton);
  DrawnBones bones;
  bones.hips = map.joint(Role::hips);
  if (bones.hips < 0) bones.hips = moving_child(children, moves);
  bones.loose = loose_joints(skeleton, map, bones.hips, children);
  bones.left = joints_below(map.joint(Role::left_foot), children);
  bones.right = joints_below(map.joint(Role::right_foot), children);

  const Skeleton standing = retarget::neutral_skeleton(clip, map);
  const StubFinder finder(standing, map, body_extent(standing, bones.hips, children));
  for (int joint = 1; joint < skeleton.joint_count(); ++joint) {
    const auto at = static_cast<std::size_t>(joint);
    if (!children[at].empty() || skeleton.end_sites[at] != 0) continue;
    if (std::ranges::binary_search(bones.loose, joint)) continue;
    const Vec3 tip = finder.tip(joint);
    if (tip.squaredNorm() > 0) bones.stubs.push_back({joint, tip});
  }
  return bones;
}

void pack_drawn_bones(const DrawnBones& bones, Json& item) {
  item["hips"] = bones.hips;
  item["loose"] = bones.loose;
  Json stubs = Json::array();
  for (const DrawnBones::Stub& stub : bones.stubs) {
    Json numbers = {stub.joint};
    for (const double x : stub.tip) numbers.push_back(std::round(x * 1e5) / 1e5);
    stubs.push_back(std::move(numbers));
  }
  item["stubs"] = std::move(stubs);
  item["left"] = bones.left;
  item["right"] = bones.right;
}

}  // namespace krok::draw
