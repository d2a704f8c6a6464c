#include "tools/krok/krok.h"

#include <fmt/format.h>

#include <algorithm>

namespace krok::cli {

namespace {

std::string joined(const std::vector<std::string>& words) {
  return fmt::format("{}", fmt::join(words, " "));
}

struct CompletedOption {
  std::vector<std::string> names;
  bool takes_value = false;
  std::string words;
  std::string description;
};

// The options of a verb; positionals, which have no name, are left out.
std::vector<CompletedOption> options_of(const CompletedVerb& verb) {
  std::vector<CompletedOption> options;
  for (const OptionFacts& facts : verb.options) {
    if (facts.names.empty()) continue;
    CompletedOption option{facts.names, facts.takes_value, joined(facts.words), facts.description};
    std::ranges::replace(option.description, '\n', ' ');
    // The first sentence, as lists of completions are narrow.
    for (const char* end : {". ", ": ", "; "}) {
      option.description = option.description.substr(0, option.description.find(end));
    }
    options.push_back(std::move(option));
  }
  return options;
}

// In single quotes.
std::string in_quotes(std::string_view text) {
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return result + "'";
}

std::string tools_of(std::span<const CompletedVerb> verbs) {
  std::string names = "krok";
  for (const CompletedVerb& verb : verbs) names += " krok-" + verb.name;
  return names;
}

std::string verbs_of(std::span<const CompletedVerb> verbs) {
  std::string names;
  for (const CompletedVerb& verb : verbs) names += verb.name + " ";
  return names + "completion help";
}

// Cases for the words that options take: "krok-skin --as") words="...";;
std::string word_cases(std::span<const CompletedVerb> verbs, const char* assign) {
  std::string text;
  for (const CompletedVerb& verb : verbs) {
    for (const CompletedOption& option : options_of(verb)) {
      if (option.words.empty()) continue;
      std::string patterns;
      for (const std::string& name : option.names) {
        patterns += fmt::format("{}'krok-{} {}'", patterns.empty() ? "" : "|", verb.name, name);
      }
      text += fmt::format("    {}) {}({}) ;;\n", patterns, assign, option.words);
    }
  }
  return text;
}

std::string for_bash(std::span<const CompletedVerb> verbs) {
  std::string text =
      "# Completion of krok in bash: source <(krok completion bash)\n"
      "_krok() {\n"
      "  local tool=${COMP_WORDS[0]##*/} current=${COMP_WORDS[COMP_CWORD]}\n"
      "  local previous=${COMP_WORDS[COMP_CWORD-1]} options='' values=()\n"
      "  if [[ $tool == krok ]]; then\n"
      "    if ((COMP_CWORD == 1)); then\n";
  text += fmt::format("      COMPREPLY=($(compgen -W '{}' -- \"$current\"))\n", verbs_of(verbs));
  text +=
      "      return\n"
      "    fi\n"
      "    tool=krok-${COMP_WORDS[1]}\n"
      "  fi\n"
      "  if [[ $current == '=' ]]; then\n"
      "    current=''\n"
      "  elif [[ $previous == '=' ]]; then\n"
      "    previous=${COMP_WORDS[COMP_CWORD-2]}\n"
      "  fi\n"
      "  case \"$tool $previous\" in\n";
  text += word_cases(verbs, "values=");
  text += "    'krok-completion completion') values=(bash zsh fish) ;;\n  esac\n  case $tool in\n";
  for (const CompletedVerb& verb : verbs) {
    std::string names;
    for (const CompletedOption& option : options_of(verb)) {
      for (const std::string& name : option.names) names += (names.empty() ? "" : " ") + name;
    }
    text += fmt::format("    krok-{}) options='{}' ;;\n", verb.name, names);
  }
  text +=
      "  esac\n"
      "  if ((${#values[@]})); then\n"
      "    COMPREPLY=($(compgen -W \"${values[*]}\" -- \"$current\"))\n"
      "  elif [[ $current == -* ]]; then\n"
      "    COMPREPLY=($(compgen -W \"$options\" -- \"$current\"))\n"
      "  else\n"
      "    mapfile -t COMPREPLY < <(compgen -f -- \"$current\")\n"
      "  fi\n"
      "}\n";
  return text + fmt::format("complete -o filenames -F _krok {}\n", tools_of(verbs));
}

// name:description, with colons in both escaped.
std::string described(std::string name, const std::string& description) {
  std::string text = std::move(name) + ":";
  for (const char c : description) text += c == ':' ? std::string("\\:") : std::string(1, c);
  return in_quotes(text);
}

std::string for_zsh(std::span<const CompletedVerb> verbs) {
  std::string text = fmt::format("#compdef {}\n", tools_of(verbs));
  text +=
      "# Completion of krok in zsh: krok completion zsh > _krok, in a folder of $fpath\n"
      "_krok() {\n"
      "  local tool=${words[1]:t} previous=${words[CURRENT-1]}\n"
      "  local -a verbs options values\n"
      "  if [[ $tool == krok ]]; then\n"
      "    if ((CURRENT == 2)); then\n"
      "      verbs=(\n";
  for (const CompletedVerb& verb : verbs) {
    text += fmt::format("        {}\n", described(verb.name, verb.does));
  }
  text +=
      "        'completion:print completion for a shell'\n"
      "      )\n"
      "      _describe verb verbs\n"
      "      return\n"
      "    fi\n"
      "    tool=krok-${words[2]}\n"
      "  fi\n"
      "  case \"$tool $previous\" in\n";
  text += word_cases(verbs, "values=");
  text += "    'krok-completion completion') values=(bash zsh fish) ;;\n  esac\n  case $tool in\n";
  for (const CompletedVerb& verb : verbs) {
    text += fmt::format("    krok-{})\n      options=(\n", verb.name);
    for (const CompletedOption& option : options_of(verb)) {
      for (const std::string& name : option.names) {
        text += fmt::format("        {}\n", described(name, option.description));
      }
    }
    text += "      ) ;;\n";
  }
  text +=
      "  esac\n"
      "  if (($#values)); then\n"
      "    compadd -- $values\n"
      "  elif [[ ${words[CURRENT]} == -* ]]; then\n"
      "    _describe -o option options\n"
      "  else\n"
      "    _files\n"
      "  fi\n"
      "}\n"
      "if [[ $funcstack[1] == _krok ]]; then _krok \"$@\"; else compdef _krok ";
  return text + tools_of(verbs) + "; fi\n";
}

std::string for_fish(std::span<const CompletedVerb> verbs) {
  std::string text = "# Completion of krok in fish: krok completion fish | source\n";
  for (const CompletedVerb& verb : verbs) {
    text += fmt::format("complete -c krok -n __fish_use_subcommand -a {} -d {}\n", verb.name,
                        in_quotes(verb.does));
  }
  text +=
      "complete -c krok -n __fish_use_subcommand -a completion -d 'print completion for a shell'\n";
  text += "complete -c krok -n '__fish_seen_subcommand_from completion' -x -a 'bash zsh fish'\n";
  for (const CompletedVerb& verb : verbs) {
    for (const CompletedOption& option : options_of(verb)) {
      std::string rest;
      for (const std::string& name : option.names) {
        rest += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
      }
      if (!option.words.empty()) {
        rest += " -x -a " + in_quotes(option.words);
      } else if (option.takes_value) {
        rest += " -r";
      }
      rest += " -d " + in_quotes(option.description);
      text += fmt::format("complete -c krok-{}{}\n", verb.name, rest);
      text +=
          fmt::format("complete -c krok -n '__fish_seen_subcommand_from {}'{}\n", verb.name, rest);
    }
  }
  return text;
}

}  // namespace

std::string completion_script(Shell shell, std::span<const CompletedVerb> verbs) {
  switch (shell) {
    case Shell::zsh:
      return for_zsh(verbs);
    case Shell::fish:
      return for_fish(verbs);
    case Shell::bash:
      break;
  }
  return for_bash(verbs);
}

}  // namespace krok::cli
