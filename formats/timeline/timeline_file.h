#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/result.h"
#include "face/visemes.h"
#include "timeline/timeline.h"

// Reader for timeline files (JSON, hand-written); see SPEC.md.

namespace krok::timeline_file {

struct SourceFile {
  std::string name;       // used by items
  std::string path;       // of the motion, as written: relative to the timeline's folder
  std::string sequences;  // path of a sequences file; may be empty
  Location where;
};

// One of what moves the face.
struct FaceItem {
  enum class Kind : unsigned char { weights, expression, phonemes, blinks };
  Kind kind = Kind::weights;
  std::string file;    // of weights or phonemes, relative to the timeline's folder
  std::string target;  // the expression, or what blinks close the lids by
  face::BlinkOptions blinks;

  std::string tier;  // of phonemes; empty: the usual one
  face::Alphabet alphabet = face::Alphabet::automatic;
  std::vector<std::pair<std::string, std::string>> symbols;  // label -> symbol of the alphabet
  struct Shape {
    std::string viseme;
    std::vector<std::pair<std::string, double>> weights;  // by target
  };
  std::vector<Shape> shapes;

  ClipTime at;
  std::optional<ClipTime> until;
  timeline::Fade fade_in, fade_out;
  blend::WeightCurve weight = blend::WeightCurve::constant(1);
  bool additive = false;
  Location where;
};

struct GazeKey {
  ClipTime at;
  std::optional<Vec3> target;  // metres, in the world; none: straight ahead
};

struct Document {
  std::vector<SourceFile> sources;  // in file order; items refer to them by index
  timeline::Timeline timeline;      // sequences by name, not resolved
  std::string character;            // the file with expressions and eyes; may be empty
  std::vector<FaceItem> face;
  std::vector<GazeKey> gaze;  // by time
};

// `path` is for messages and for the locations stored in the timeline. Nothing is checked against
// the motions. Codes, each with line and column: json-syntax, json-limit, timeline-structure (a
// missing or unknown key), timeline-value.
Result<Document> read(std::string_view text, const std::string& path);

// The JSON Schema of such files.
std::string schema();

}  // namespace krok::timeline_file
