#pragma once

#include <string>

#include "core/child_process.h"
#include "core/file.h"
#include "core/progress.h"
#include "core/result.h"

namespace krok::io {

class Takes;

// Where motions are read, FILE#ANIMATION is one animation of a scene: its name, the end of it
// behind a |, or its number (## where another is called so). A file of that whole name comes first.
struct Address {
  std::string file, animation;  // the path itself and nothing, unless it is such an address
};
Address address_of(const std::string& path);

// The file of an address, whose part() is the animation. Codes: those of InputFile::open().
Result<InputFile> open_address(const std::string& path);

// Where readers get their files from and report to. A reader may need more than the file it was
// given: the ASF of an AMC, the buffers of a glTF, the model of a character. It opens all of them
// here, so that a caller knows what a result depends on. A program that only wants the data uses
// PlainInputs.
class Inputs {
 public:
  virtual ~Inputs();

  // Opens a file that the result depends on; "-" is standard input.
  virtual Result<InputFile> open_input(const std::string& path) = 0;

  // The same for a long file that is read from front to back: its checksum, if one is kept, is only
  // taken by note_checksum(), once it was read.
  virtual Result<InputFile> open_long_input(const std::string& path) { return open_input(path); }
  virtual void note_checksum(const InputFile& /*input*/) {}

  // The result depends on which files with this ending (".asf") or this whole name
  // ("walk.keys.json") are in the folder of `path`.
  virtual void depends_on_neighbours(const std::string& /*path*/, const std::string& /*ending*/) {}

  // Takes warnings and notes of readers.
  virtual void diagnose(Diagnostic diagnostic) = 0;
  void diagnose(const Diagnostics& diagnostics);
  // The same of those of one file, whose name they may lack.
  void diagnose_in(const std::string& path, const Diagnostics& diagnostics);

  // Of readers that run in a process of their own: Assimp, Draco.
  GivenLimits limits;

  int jobs = 0;                  // threads; 0 is one per core
  Progress* progress = nullptr;  // may be null
  Takes* takes = nullptr;        // the other files of a batch (open_motion.h); null outside one
};

// Opens files as they are and keeps what readers report.
class PlainInputs : public Inputs {
 public:
  Diagnostics diagnostics;

  Result<InputFile> open_input(const std::string& path) override;
  void diagnose(Diagnostic diagnostic) override;
};

}  // namespace krok::io
