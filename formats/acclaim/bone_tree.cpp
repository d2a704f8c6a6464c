#include "formats/acclaim/files_internal.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <vector>

#include "capture/unique_names.h"
#include "core/file.h"
#include "core/text.h"
#include "formats/acclaim/acclaim_reader.h"

namespace krok::acclaim {

namespace {

constexpr int kRoot = 0;
constexpr std::string_view kRootName = "root";

class BoneTree {
 public:
  BoneTree(std::vector<LooseBone>& bones, SourceText& source, SkeletonFile& skeleton)
      : bones_(bones), source_(source), skeleton_(skeleton) {}

  Status hang(const std::vector<HierarchyLink>& links) {
    if (Status status = collect_names(); !status) return status;
    children_.resize(bones_.size() + 1);
    hangs_.assign(bones_.size() + 1, false);
    for (const HierarchyLink& link : links) {
      if (Status status = add(link); !status) return status;
    }
    place_bones();
    return report_loose_bones();
  }

 private:
  // Bone i has number i + 1 here, the root 0. The maps first refer to these numbers, and to joints
  // in the end.
  Status collect_names() {
    skeleton_.by_name.emplace(kRootName, kRoot);
    skeleton_.by_lower_name.emplace(kRootName, kRoot);
    for (std::size_t i = 0; i < bones_.size(); ++i) {
      const LooseBone& bone = bones_[i];
      const int number = static_cast<int>(i) + 1;
      if (same_word(bone.name, kRootName)) {
        return source_.error(bone.offset, "acclaim-bone", "a bone is named root",
                             "the name root is reserved for the root joint; rename the bone");
      }
      if (!skeleton_.by_name.emplace(bone.name, number).second) {
        return source_.error(bone.offset, "acclaim-bone",
                             fmt::format("a second bone is named {}", shown(bone.name)),
                             ":hierarchy and the motion refer to bones by name");
      }
      const auto [place, is_new] = skeleton_.by_lower_name.emplace(ascii_lower(bone.name), number);
      if (!is_new) place->second = SkeletonFile::kUnknown;
    }
    return {};
  }

  Status add(const HierarchyLink& link) {
    const int parent = skeleton_.find(link.parent);
    const int child = skeleton_.find(link.child);
    const bool no_parent = parent == SkeletonFile::kUnknown;
    if (no_parent || child == SkeletonFile::kUnknown) {
      return source_.error(no_parent ? link.parent_offset : link.child_offset, "acclaim-hierarchy",
                           fmt::format(":hierarchy names {}, which :bonedata does not have",
                                       shown(no_parent ? link.parent : link.child)));
    }
    if (child == kRoot) {
      return source_.error(link.child_offset, "acclaim-hierarchy", "root is the child of a bone");
    }
    if (hangs_[static_cast<std::size_t>(child)]) {
      return source_.error(link.child_offset, "acclaim-hierarchy",
                           fmt::format("{} has a second parent", shown(link.child)));
    }
    hangs_[static_cast<std::size_t>(child)] = true;
    children_[static_cast<std::size_t>(parent)].push_back(child);
    return {};
  }

  // Depth first from the root, children in the order of :hierarchy.
  void place_bones() {
    joint_of_.assign(bones_.size() + 1, SkeletonFile::kLeftOut);
    joint_of_[kRoot] = kRoot;
    names_.claim(std::string(kRootName));
    struct Visit {
      int bone, parent_joint;
    };
    std::vector<Visit> open;
    const auto open_children = [&](int bone, int joint) {
      const auto& below = children_[static_cast<std::size_t>(bone)];
      for (auto child = below.rbegin(); child != below.rend(); ++child) {
        open.push_back({*child, joint});
      }
      skeleton_.joints[static_cast<std::size_t>(joint)].has_children = !below.empty();
    };
    open_children(kRoot, kRoot);
    while (!open.empty()) {
      const Visit visit = open.back();
      open.pop_back();
      LooseBone& bone = bones_[static_cast<std::size_t>(visit.bone) - 1];
      const int joint = static_cast<int>(skeleton_.joints.size());
      joint_of_[static_cast<std::size_t>(visit.bone)] = joint;
      bone.joint.name = unique_name(bone);
      bone.joint.parent = visit.parent_joint;
      skeleton_.joints.push_back(std::move(bone.joint));
      open_children(visit.bone, joint);
    }
    for (auto* names : {&skeleton_.by_name, &skeleton_.by_lower_name}) {
      for (auto& [name, number] : *names) {
        if (number >= 0) number = joint_of_[static_cast<std::size_t>(number)];
      }
    }
  }

  // Names are unique as bytes, but may be the same as Latin-1 or without control characters.
  std::string unique_name(const LooseBone& bone) {
    std::string candidate = names_.make(readable_joint_name(bone.name));
    if (candidate != bone.name) {
      source_.warn(
          bone.offset, "acclaim-name",
          fmt::format("a bone name {}; renamed to {}",
                      is_utf8(bone.name) ? "has control characters" : "is not UTF-8", candidate),
          {}, candidate);
    }
    return candidate;
  }

  Status report_loose_bones() {
    std::size_t count = 0;
    const LooseBone* first = nullptr;
    for (std::size_t i = 0; i < bones_.size(); ++i) {
      if (joint_of_[i + 1] != SkeletonFile::kLeftOut) continue;
      if (count++ == 0) first = &bones_[i];
    }
    if (count == 0) return {};
    return source_.fault(
        first->offset, "acclaim-hierarchy",
        fmt::format("{} bone{} not connected to the root and {} dropped (the first: {})", count,
                    count == 1 ? " is" : "s are", count == 1 ? "is" : "are", shown(first->name)));
  }

  std::vector<LooseBone>& bones_;
  SourceText& source_;
  SkeletonFile& skeleton_;
  std::vector<std::vector<int>> children_;
  std::vector<bool> hangs_;
  std::vector<int> joint_of_;
  UniqueNames names_;
};

}  // namespace

int SkeletonFile::find(std::string_view searched) const {
  if (const auto found = by_name.find(std::string(searched)); found != by_name.end()) {
    return found->second;
  }
  const auto found = by_lower_name.find(ascii_lower(searched));
  return found == by_lower_name.end() ? kUnknown : found->second;
}

Status hang_bones(std::vector<LooseBone>& bones, const std::vector<HierarchyLink>& links,
                  SourceText& source, SkeletonFile& skeleton) {
  return BoneTree(bones, source, skeleton).hang(links);
}

namespace {

namespace fs = std::filesystem;

// Whether the motion's name begins with the skeleton's name as a complete word: not 1.asf for
// 11_01.amc.
bool begins_name(const std::string& skeleton, const std::string& motion) {
  if (skeleton.empty() || !same_word(motion.substr(0, skeleton.size()), skeleton)) return false;
  if (motion.size() == skeleton.size()) return true;
  const char next = motion[skeleton.size()];
  return next == '_' || next == '-' || next == '.' || next == ' ';
}

// Sorted, independent of the directory order.
std::vector<fs::path> skeletons_in(const fs::path& folder) {
  std::vector<fs::path> found;
  std::error_code ignored;
  for (fs::directory_iterator entry(folder, ignored), end; !ignored && entry != end;
       entry.increment(ignored)) {
    if (extension(entry->path().string()) == ".asf") found.push_back(entry->path());
  }
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace

Result<FoundSkeleton> find_skeleton(const std::string& amc_path) {
  const fs::path motion(amc_path);
  const fs::path folder = motion.has_parent_path() ? motion.parent_path() : fs::path(".");
  const std::vector<fs::path> skeletons = skeletons_in(folder);
  const std::string motion_stem = motion.stem().string();
  std::size_t longest = 0;
  std::vector<fs::path> named;
  for (const fs::path& skeleton : skeletons) {
    const std::string stem = skeleton.stem().string();
    if (!begins_name(stem, motion_stem) || stem.size() < longest) continue;
    if (stem.size() > longest) named.clear();
    longest = stem.size();
    named.push_back(skeleton);
  }
  // As on the command line: without "./".
  const auto beside = [&](const fs::path& skeleton) {
    return (motion.parent_path() / skeleton.filename()).string();
  };
  if (named.size() == 1)
    return FoundSkeleton{beside(named[0]), "the motion's name begins with its name", true};
  if (skeletons.size() == 1) {
    return FoundSkeleton{beside(skeletons[0]), "it is the only one in the motion's folder"};
  }
  return Error("acclaim-skeleton",
               skeletons.empty()
                   ? std::string("an AMC motion needs its skeleton, and there is no .asf file in "
                                 "its folder")
                   : fmt::format("an AMC motion needs its skeleton, and it is not clear which of "
                                 "the {} .asf files in its folder it is",
                                 skeletons.size()))
      .in_file(amc_path);
}

}  // namespace krok::acclaim
