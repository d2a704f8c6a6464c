#include "guided/targets.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "formats/acclaim/acclaim_reader.h"
#include "formats/alignment/alignment_format.h"
#include "formats/anim/anim.h"
#include "formats/assimp/scene_transfer.h"
#include "formats/bvh/bvh_reader.h"
#include "formats/cam/cam.h"
#include "formats/camera_keys/camera_keys.h"
#include "formats/character/character_format.h"
#include "formats/correctives/correctives_format.h"
#include "formats/csv/table.h"
#include "formats/gltf/gltf_reader.h"
#include "formats/goals/goals.h"
#include "formats/height_field/height_image.h"
#include "formats/image/decode_image.h"
#include "formats/key_shapes/key_shapes.h"
#include "formats/keys/keys.h"
#include "formats/library/library_description.h"
#include "formats/limits/limits_format.h"
#include "formats/material/material_format.h"
#include "formats/model/model_format.h"
#include "formats/morph_exr/morph_exr.h"
#include "formats/npy/array_reader.h"
#include "formats/obj/obj_reader.h"
#include "formats/path/path_format.h"
#include "formats/pc2/pc2.h"
#include "formats/prints/prints.h"
#include "formats/ragdoll/ragdoll_format.h"
#include "formats/role_map/role_map.h"
#include "formats/sequences/sequences.h"
#include "formats/steps/steps.h"
#include "formats/textgrid/textgrid.h"
#include "formats/timeline/timeline_file.h"
#include "formats/weights/weights.h"
#include "formats/zip/zip_archive.h"
#include "golden/samples/samples.h"
#include "guided/mended_input.h"
#include "nodes/evaluate.h"
#include "support/human_skeleton.h"

namespace krok::guided {

namespace {

using Bytes = std::span<const std::byte>;

std::string_view text_of(Bytes bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

void judge_error(const Error& error) {
  if (error.code.empty()) fail("an error without a code");
  if (error.message.empty()) fail("an error without a message");
  if (error.message.size() > 5000) fail("an error that no one reads: " + error.message);
}

template <typename Value>
void judge(const Result<Value>& value) {
  if (!value) judge_error(value.error());
}

// The same for values that have a check().
template <typename Value>
void judge_checked(const Result<Value>& value) {
  if (!value) return judge_error(value.error());
  if (const Status status = check(*value); !status) {
    fail("a value that does not hold: " + status.error().message);
  }
}

const Skeleton& human() {
  static const Skeleton skeleton = test::human_skeleton();
  return skeleton;
}

const RoleMap& human_roles() {
  static const RoleMap roles = find_roles(human());
  return roles;
}

void read_bvh(Bytes input) {
  for (const Strictness strictness : {Strictness::normal, Strictness::strict, Strictness::repair}) {
    bvh::ReadOptions options;
    options.strictness = strictness;
    options.jobs = 1;
    const auto capture = bvh::read(text_of(input), "input.bvh", options);
    if (!capture) {
      judge_error(capture.error());
    } else if (const Status status = check(capture->clip); !status) {
      fail("a clip that does not hold: " + status.error().message);
    }
  }
}

constexpr const char* kAsf =
    ":version 1.10\n:name t\n:units\n mass 1\n length 0.45\n angle deg\n:root\n order TX TY TZ RX "
    "RY "
    "RZ\n axis XYZ\n position 0 0 0\n orientation 0 0 0\n:bonedata\nbegin\n id 1\n name a\n "
    "direction 0 1 0\n length 2\n axis 0 0 20 XYZ\n dof rx ry rz\n limits (-160 20)\n (-70 70)\n "
    "(-60 70)\nend\n:hierarchy\nbegin\n root a\nend\n";

void read_acclaim(std::string_view asf, std::string_view amc) {
  for (const Strictness strictness : {Strictness::normal, Strictness::strict, Strictness::repair}) {
    acclaim::ReadOptions options;
    options.strictness = strictness;
    options.jobs = 1;
    const auto capture =
        acclaim::read(asf, "input.asf", amc, amc.empty() ? "" : "input.amc", options);
    if (!capture) {
      judge_error(capture.error());
    } else if (const Status status = check(capture->clip); !status) {
      fail("a clip that does not hold: " + status.error().message);
    }
  }
}

void read_asf(Bytes input) {
  read_acclaim(text_of(input), {});
  read_acclaim(text_of(input),
               ":FULLY-SPECIFIED\n:DEGREES\n1\nroot 0 1 0 0 0 0\n2\nroot 0 1 0 9 0 0\n");
}

void read_amc(Bytes input) {
  if (!input.empty()) read_acclaim(kAsf, text_of(input));
}

Result<Clip> read_motion(Bytes input) {
  Stretches stretches;
  auto clip = anim::read(input, &stretches);
  if (!clip) return clip;
  if (Status status = check(stretches, *clip); !status) fail("stretches that do not hold");
  return clip;
}

// Calls `use` with a copy of exactly these bytes, so that the sanitizer detects reads past the end.
template <typename Use>
void with_exact(const std::vector<std::byte>& bytes, const Use& use) {
  const std::unique_ptr<std::byte[]> exact(new std::byte[bytes.size()]);
  std::ranges::copy(bytes, exact.get());
  use(Bytes(exact.get(), bytes.size()));
}

// A file as it is and with its checksum made right, without which the reader would not see what a
// fuzzer has changed. What is no file is a list of sections, of which the table is made: inserting
// a byte into a file breaks all offsets behind it.
template <auto read>
void read_binary(Bytes input, std::string_view magic) {
  const auto use = [](Bytes bytes) { judge_checked(read(bytes)); };
  if (text_of(input).starts_with("KROK")) {
    use(input);
    std::vector<std::byte> repaired(input.begin(), input.end());
    samples::repair_header(repaired);
    with_exact(repaired, use);
  } else {
    with_exact(assembled(input, magic), use);
  }
}

void read_anim(Bytes input) {
  read_binary<read_motion>(input, "KROKANIM");
}
void read_cam(Bytes input) {
  read_binary<cam::read>(input, "KROKCAMR");
}
void read_model(Bytes input) {
  read_binary<model::read>(input, "KROKMODL");
}
void read_steps(Bytes input) {
  read_binary<steps::read>(input, "KROKSTEP");
}

void read_csv(Bytes input) {
  const auto table = csv::Table::read(text_of(input), "input.csv");
  if (!table) return judge_error(table.error());
  for (std::size_t c = 0; c < std::min<std::size_t>(table->columns().size(), 16); ++c) {
    const std::size_t columns[] = {c};
    judge(table->numbers(columns));
    if (table->texts(c).size() != table->row_count()) fail("texts of other rows");
    (void)table->find(table->columns()[c].header);
  }
}

void read_gltf(Bytes input) {
  gltf::ReadOptions options;
  options.most_bytes = std::uint64_t{64} << 20;
  judge(gltf::read(input, options));
}

// What comes back from the process that Assimp runs in, which a file may have taken over.
void read_assimp_result(Bytes input) {
  const auto scene = assimp::unpack(input);
  if (!scene) return judge_error(scene.error());
  const auto evaluator = nodes::Evaluator::create(*scene);
  if (!evaluator) return judge_error(evaluator.error());
  nodes::Evaluation state;
  const int animations = std::min(static_cast<int>(scene->animations.size()), 4);
  for (int a = -1; a < animations; ++a) evaluator->evaluate(a, 0.2, state);
}

void read_pc2(Bytes input) {
  const auto cache = pc2::PointCache::read(input);
  if (!cache) return judge_error(cache.error());
  if (cache->samples() == 0) return;  // then nothing says that the number of points is true
  std::vector<Vec3f> positions(static_cast<std::size_t>(cache->points()));
  for (std::int64_t s = 0; s < std::min<std::int64_t>(cache->samples(), 4); ++s) {
    const Status status = cache->get(s, positions);
    if (!status) judge_error(status.error());
  }
}

void read_exr(Bytes input) {
  judge_checked(morph_exr::read(input));
  judge(morph_exr::image_size(input));
  auto heights = height_field::read(input);
  if (!heights) return judge_error(heights.error());
  judge(height_field::placed(std::move(*heights),
                             {.size = {{10, 10}}, .range = {{0, 1}}, .centre = {}}));
}

void read_image(Bytes input) {
  with_exact(with_png_checksums(input), [](Bytes mended) {
    judge(image::decode(mended, std::size_t{1} << 22));
    judge(image::decode_grey(mended, std::size_t{1} << 22));
  });
}

void read_obj(Bytes input) {
  const auto shape = obj::read(text_of(input), "input.obj");
  if (!shape) return judge_error(shape.error());
  if (const Status status = check(shape->model); !status) {
    fail("a model that does not hold: " + status.error().message);
  }
}

void read_path(Bytes input) {
  judge(path_file::read(text_of(input), "input"));
}

void read_zip(Bytes input) {
  const auto archive = zip::Archive::open(input);
  if (!archive) return judge_error(archive.error());
  for (std::size_t i = 0; i < std::min<std::size_t>(archive->names().size(), 16); ++i) {
    judge(archive->read(archive->names()[i], std::uint64_t{1} << 22));
  }
}

void read_arrays(Bytes input) {
  npy::ReadOptions options;
  options.jobs = 1;
  if (const auto opened = npy::open(input, "input.npz", options)) {
    judge(read_through(opened->frames, 1));
  }
  const auto capture = npy::read(input, "input.npz", options);
  if (!capture) return judge_error(capture.error());
  judge(check(capture->clip));
}

// JSON pages.

template <auto read>
void read_page(Bytes input) {
  judge(read(text_of(input)));
}

template <auto read>
void read_named_page(Bytes input) {
  judge(read(text_of(input), "input.json"));
}

void read_alignment(Bytes input) {
  judge(alignment::read(text_of(input), human(), human()));
}
void read_goals(Bytes input) {
  judge(goals::read(text_of(input), human(), human_roles()));
}
void read_keys(Bytes input) {
  const auto keys = keys::read(text_of(input), "input.json", human(), 2);
  if (!keys) return judge_error(keys.error());
  if (const Status status = check(*keys, human(), 2); !status) {
    fail("keys that do not hold: " + status.error().message);
  }
}
void read_limits(Bytes input) {
  judge(limits::read(text_of(input), human()));
}
void read_ragdoll(Bytes input) {
  judge(ragdoll_file::read(text_of(input), &human()));
  judge(ragdoll_file::read(text_of(input), nullptr));
}
void read_roles(Bytes input) {
  judge(role_map::read(text_of(input), "input.json", human()));
}
void read_textgrid(Bytes input) {
  judge(textgrid::read(text_of(input), "input"));
  judge(textgrid::read_intervals(text_of(input), "input", ""));
}
void read_weights(Bytes input) {
  static const std::vector<std::string> kTargets = {"smile", "blink, left", "time"};
  judge(weights::read(text_of(input), "input", kTargets));
}

constexpr Target kTargets[] = {
    {"acclaim_motion", read_amc},
    {"acclaim_skeleton", read_asf},
    {"alignment", read_alignment},
    {"anim", read_anim},
    {"assimp_result", read_assimp_result},
    {"bvh", read_bvh},
    {"cam", read_cam},
    {"camera_keys", read_page<camera_keys::read>},
    {"character", read_page<character_file::read>},
    {"corrective_poses", read_page<corrective_poses::read>},
    {"correctives", read_page<correctives_file::read>},
    {"csv", read_csv},
    {"exr", read_exr},
    {"gltf", read_gltf},
    {"goals", read_goals},
    {"ground", read_page<height_field::read_sidecar>},
    {"image", read_image},
    {"import_scene", import_scene, true},
    {"key_shapes", read_page<key_shapes::read>},
    {"keys", read_keys},
    {"library", read_named_page<library::read>},
    {"limits", read_limits},
    {"material", read_page<material::read>},
    {"model", read_model},
    {"obj", read_obj},
    {"operations", run_operations, true},
    {"path", read_path},
    {"pc2", read_pc2},
    {"prints", read_named_page<prints::read>},
    {"ragdoll", read_ragdoll},
    {"role_map", read_roles},
    {"sequences", read_page<sequences::read>},
    {"steps", read_steps},
    {"textgrid", read_textgrid},
    {"timeline", read_named_page<timeline_file::read>},
    {"weights", read_weights},
    {"zip", read_zip},
    {"arrays", read_arrays},
};

}  // namespace

std::span<const Target> targets() {
  return kTargets;
}

void fail(std::string_view what) {
  std::fprintf(stderr, "%.*s\n", static_cast<int>(what.size()), what.data());
  std::abort();
}

}  // namespace krok::guided
