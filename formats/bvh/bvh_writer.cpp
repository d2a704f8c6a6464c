#include "formats/bvh/bvh_writer.h"
#include "formats/bvh/motion_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <vector>

#include "capture/unique_names.h"
#include "core/numbers.h"
#include "formats/bvh/text_cursor.h"

namespace krok::bvh {

namespace {

constexpr std::array kAxisLetters = {'X', 'Y', 'Z'};

// A joint as written to the file.
struct WrittenJoint {
  int index = 0;  // in the clip
  int depth = 0;
  bool end_site = false;
  bool positions = false;
  Vec3 offset = Vec3::Zero();  // metres
  double movement = 0;         // metres: the largest distance from the offset in any frame
};

class Writer {
 public:
  Writer(const FrameSource& source, const WriteOptions& options, OutputFile& file)
      : source_(source),
        options_(options),
        file_(file),
        count_(source.skeleton.names.size()),
        scale_(1.0 / options.unit_metres) {
    // A coarser unit needs more decimals for the same length.
    const double shift = std::log10(options.unit_metres / 0.01);
    length_decimals_ = std::clamp(options.decimals + static_cast<int>(std::lround(shift)), 0, 15);
    for (const Transform& joint : source.skeleton.reference) {
      from_reference_.push_back(joint.orientation.normalized().conjugate());
    }
  }

  Status write() {
    order_joints();
    if (Status status = find_moving_translations(); !status) return status;
    write_hierarchy();
    write_motion_header();
    if (Status status = flush(); !status) return status;
    return write_frames();
  }

 private:
  const Skeleton& skeleton() const { return source_.skeleton; }
  int parent_of(std::size_t joint) const { return skeleton().parents[joint]; }

  // Depth first, children in the clip's order, without recursion.
  void order_joints() {
    const auto children = skeleton().children();
    std::vector<std::pair<int, int>> open = {{0, 0}};
    while (!open.empty()) {
      const auto [joint, depth] = open.back();
      open.pop_back();
      const auto j = static_cast<std::size_t>(joint);
      WrittenJoint written;
      written.index = joint;
      written.depth = depth;
      written.end_site = skeleton().end_sites[j] != 0 && depth > 0;
      written.positions = depth == 0;
      if (depth > 0 || options_.root_offset) {
        written.offset = skeleton().reference[j].position;
        if (depth > 0) {
          written.offset -= skeleton().reference[static_cast<std::size_t>(parent_of(j))].position;
        }
      }
      written_.push_back(written);
      for (auto child = children[j].rbegin(); child != children[j].rend(); ++child) {
        open.emplace_back(*child, depth + 1);
      }
    }
  }

  // joint_to_world of a frame relative to the reference orientations, so that zero rotations give
  // the reference pose.
  void folded_pose(const Clip& block, int frame, std::span<Transform> pose) const {
    block.get_pose(frame, pose);
    for (std::size_t j = 0; j < count_; ++j) {
      pose[j].orientation = pose[j].orientation * from_reference_[j];
    }
  }

  Vec3 translation_in_parent(std::span<const Transform> pose, const WrittenJoint& joint) const {
    const auto j = static_cast<std::size_t>(joint.index);
    if (joint.depth == 0) return pose[j].position;
    const Transform& parent = pose[static_cast<std::size_t>(parent_of(j))];
    return parent.orientation.conjugate() * (pose[j].position - parent.position);
  }

  Status find_moving_translations() {
    float farthest = 0;  // of the frames, metres
    std::vector<Transform> pose(count_);
    const Status status = for_each_block(source_, options_.jobs, [&](int, const Clip& block) {
      for (const Vec3f& position : block.positions) {
        farthest = std::max(farthest, position.cwiseAbs().maxCoeff());
      }
      for (int frame = 0; frame < block.frame_count(); ++frame) {
        folded_pose(block, frame, pose);
        for (WrittenJoint& joint : written_) {
          if (joint.positions) continue;
          joint.movement =
              std::max(joint.movement, (translation_in_parent(pose, joint) - joint.offset).norm());
        }
      }
      return Status();
    });
    if (!status) return status;
    // Stored positions are floats: differences below float precision are not movement.
    constexpr double kRounding = 16.0 * std::numeric_limits<float>::epsilon();
    const double allowed =
        std::max(options_.translation_tolerance, kRounding * static_cast<double>(farthest));
    for (WrittenJoint& joint : written_) {
      if (joint.movement <= allowed) continue;
      joint.positions = true;
      joint.end_site = false;
    }
    return check_far(farthest);
  }

  // Readers take numbers that floats hold; those of a joint are relative to its parent.
  Status check_far(double farthest) const {
    for (const Transform& joint : skeleton().reference) {
      farthest = std::max(farthest, joint.position.cwiseAbs().maxCoeff());
    }
    if (2 * farthest / options_.unit_metres <= std::numeric_limits<float>::max()) return {};
    return Error(
        "bvh-far",
        fmt::format("a joint is {} m from the origin, too far for numbers in units of {} m",
                    readable(farthest), readable(options_.unit_metres)),
        "scale the motion, or write it in a larger unit");
  }

  // A name on one line, printable and without braces, unique after the replacements.
  std::string written_name(const std::string& name) {
    std::string result;
    for (const char c : trimmed(name)) {
      if (c == ' ') {
        result += options_.space_in_names;
      } else {
        result += static_cast<unsigned char>(c) < 0x20 || c == '{' || c == '}' ? '_' : c;
      }
    }
    return names_.make(result.empty() ? "joint" : printable(result));
  }

  void length(double metres) { number(metres * scale_, length_decimals_); }

  void number(double value, int decimals) {
    const std::size_t begin = text_.size();
    std::array<char, std::numeric_limits<double>::max_exponent10 + 32>
        digits;  // 1e308 is written out
    text_.append(digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), value,
                                              std::chars_format::fixed, decimals)
                                    .ptr);
    // "-0.000000" is zero.
    if (text_[begin] == '-' && text_.find_first_not_of("0.", begin + 1) == std::string::npos) {
      text_.erase(begin, 1);
    }
  }

  void write_hierarchy() {
    text_ = "HIERARCHY\n";
    int open = 0;
    for (const WrittenJoint& joint : written_) {
      close_to(joint.depth, open);
      const std::string indent = indentation(joint.depth);
      const std::string& name = skeleton().names[static_cast<std::size_t>(joint.index)];
      if (joint.end_site) {
        text_ += fmt::format("{}End Site\n", indent);
      } else {
        text_ += fmt::format("{}{} {}\n", indent, joint.depth == 0 ? "ROOT" : "JOINT",
                             written_name(name));
      }
      text_ += fmt::format("{}{{\n{}\tOFFSET", indent, indent);
      for (const double component : joint.offset) {
        text_ += ' ';
        length(component);
      }
      text_ += '\n';
      if (!joint.end_site) {
        text_ += indent +
                 (joint.positions ? "\tCHANNELS 6 Xposition Yposition Zposition" : "\tCHANNELS 3");
        for (const Axis axis : options_.order) {
          text_ += ' ';
          text_ += kAxisLetters[static_cast<std::size_t>(axis)];
          text_ += "rotation";
        }
        text_ += '\n';
      }
      ++open;
    }
    close_to(0, open);
  }

  void close_to(int depth, int& open) {
    while (open > depth) text_ += indentation(--open) + "}\n";
  }

  // Limited: a chain of thousands of joints would be mostly tabs.
  static std::string indentation(int depth) {
    constexpr int kDeepest = 32;
    return std::string(static_cast<std::size_t>(std::min(depth, kDeepest)), '\t');
  }

  void write_motion_header() {
    text_ += fmt::format("MOTION\nFrames: {}\nFrame Time: {}{}\n", source_.frame_count,
                         frame_time_text(), unit_mark(options_.unit_metres));
  }

  // Enough digits that 1 / frame time gives the same rate; at least ten, for readers that snap.
  std::string frame_time_text() const {
    const double frame_time = 1.0 / source_.rate;
    return fmt::format("{:.{}g}", frame_time, 17);
  }

  Status flush() {
    const Status status = file_.write(text_);
    text_.clear();
    return status;
  }

  Status write_frames() {
    std::vector<Transform> pose(count_);
    std::vector<Vec3> previous(count_, Vec3::Zero());
    return for_each_block(source_, options_.jobs, [&](int, const Clip& block) {
      for (int frame = 0; frame < block.frame_count(); ++frame) {
        folded_pose(block, frame, pose);
        bool first = true;
        for (const WrittenJoint& joint : written_) {
          if (joint.end_site) continue;
          if (!first) text_ += ' ';
          first = false;
          write_joint(joint, pose, previous[static_cast<std::size_t>(joint.index)]);
        }
        text_ += '\n';
      }
      return flush();
    });
  }

  void write_joint(const WrittenJoint& joint, std::span<const Transform> pose, Vec3& previous) {
    if (joint.positions) {
      for (const double component : translation_in_parent(pose, joint)) {
        length(component);
        text_ += ' ';
      }
    }
    const auto j = static_cast<std::size_t>(joint.index);
    const Quat local = joint.depth == 0
                           ? pose[j].orientation
                           : pose[static_cast<std::size_t>(parent_of(j))].orientation.conjugate() *
                                 pose[j].orientation;
    previous = closest_euler(to_euler(local, options_.order, previous[2]), previous);
    for (int i = 0; i < 3; ++i) {
      if (i > 0) text_ += ' ';
      number(previous[i] / kRadiansPerDegree, options_.decimals);
    }
  }

  const FrameSource& source_;
  const WriteOptions& options_;
  OutputFile& file_;
  std::size_t count_;
  double scale_;
  int length_decimals_ = 6;
  std::vector<Quat> from_reference_;
  std::vector<WrittenJoint> written_;
  UniqueNames names_;
  std::string text_;
};

}  // namespace

Status write(const Clip& clip, const WriteOptions& options, OutputFile& file) {
  if (Status status = check(clip); !status) return status;
  return write(frames_of(clip), options, file);
}

Status write(const FrameSource& source, const WriteOptions& options, OutputFile& file) {
  if (options.decimals < 1 || options.decimals > 15) {
    return Error("bvh-options", fmt::format("{} decimals, expected 1 to 15", options.decimals));
  }
  if (!(options.unit_metres > 0) || !std::isfinite(options.unit_metres)) {
    return Error("bvh-options", fmt::format("invalid unit of {} m: must be positive and finite",
                                            options.unit_metres));
  }
  std::array<int, 3> axes{};
  for (const Axis axis : options.order) ++axes[static_cast<std::size_t>(axis)];
  if (axes != std::array{1, 1, 1}) {
    return Error("bvh-options", "the rotation order names an axis twice");
  }
  return Writer(source, options, file).write();
}

}  // namespace krok::bvh
