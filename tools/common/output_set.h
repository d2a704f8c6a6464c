#pragma once

#include <functional>
#include <set>
#include <string>
#include <vector>

#include "core/file.h"
#include "core/result.h"
#include "tools/common/tool.h"

namespace krok {

// The files that one run writes: all of them appear or none. Each is checked by
// ToolContext::check_output before it is begun; an Error of writing gets the name of the file where
// it has none.
class OutputSet {
 public:
  explicit OutputSet(ToolContext& context) : context_(context) {}

  // Writes a file beside its place; nothing for an empty path.
  Status add(const std::string& path, const std::function<Status(OutputFile&)>& write);

  // The same for several files, by up to `jobs` threads at once; of several failures the one of the
  // first file is told. write(i, file) writes the ith.
  Status add_all(const std::vector<std::string>& paths, int jobs,
                 const std::function<Status(std::size_t, OutputFile&)>& write);

  // Puts all in place once each is safe on the disk, and notes them in the report. In a batch files
  // with names that the command line does not tell are handed over to it, which puts them in place
  // in the order of its list.
  Status finish();

  // The names so far, for people.
  std::string names() const;

 private:
  ToolContext& context_;
  std::vector<std::string> paths_;
  std::set<std::string> places_;
  std::vector<OutputFile> files_;
};

// Writes a result that is one file.
Status write_output(ToolContext& context, const std::string& path,
                    const std::function<Status(OutputFile&)>& write);

}  // namespace krok
