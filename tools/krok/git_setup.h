#pragma once

#include <string>
#include <vector>

namespace krok::cli {

// `krok git-setup`: prepares the repository of the current folder for motions.
//
// - .gitattributes gets a line for each ending of a motion that it lacks: diff=krok, merge=krok.
// - diff.krok.textconv is `krok info --textconv`, with cachetextconv.
// - merge.krok.driver refuses: motions that both sides changed are a conflict, and the file stays
//   as it was; the message says how to choose a side.
// - With --hook, the hook pre-commit runs krok lint on the motions that are committed. A hook that
//   is there already stays.
//
// Returns an exit code.
int git_setup(const std::vector<std::string>& arguments);

}  // namespace krok::cli
