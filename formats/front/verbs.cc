#include "formats/front/verbs.h"

#include <algorithm>

#include <fmt/format.h>

namespace palpate {
namespace {

constexpr std::string_view kUsage = "palpate VERB [ARGUMENT..]";

// Called with each heading once, and with each verb below it.
template <typename Heading, typename Line>
void list_verbs(Heading&& heading, Line&& line) {
  std::string_view group;
  for (const Verb& verb : kVerbs) {
    if (verb.group.empty()) {
      continue;
    }
    if (verb.group != group) {
      group = verb.group;
      heading(group);
    }
    line(verb);
  }
}

}  // namespace

const Verb* find_verb(std::string_view name) {
  const auto found = std::find_if(kVerbs.begin(), kVerbs.end(), [&](const Verb& verb) {
    return verb.name == name;
  });
  return found == kVerbs.end() ? nullptr : found;
}

std::string_view tool_for(const Verb& verb, std::span<const char* const> arguments) {
  const bool database =
      std::any_of(arguments.begin(), arguments.end(), [](std::string_view word) {
        return word.ends_with(".h5") || word.ends_with(".hdf5") ||
               word.ends_with(".palpate");
      });
  return verb.name == "check" && database ? "palpate-db" : verb.tool;
}

std::string front_help() {
  std::string text = fmt::format(
      "Responses of soft bodies: computed, measured, stored, rendered.\nUsage: {}\n",
      kUsage);
  list_verbs(
      [&](std::string_view group) {
        text += fmt::format("\n{}:\n", group);
      },
      [&](const Verb& verb) {
        text += fmt::format("  {:<10} {}\n", verb.name, verb.what);
      });
  return text + "\npalpate VERB --help says more of one. --version: which this is.\n";
}

std::string front_man_page() {
  std::string page = fmt::format(
      ".TH \"palpate\" 1 \"\" \"palpate {}\" \"User Commands\"\n.SH NAME\npalpate \\- "
      "computes, measures, stores and renders how soft bodies push back\n"
      ".SH SYNOPSIS\n.B palpate\n.I VERB\n[ARGUMENT..]\n",
      PALPATE_VERSION);
  list_verbs(
      [&](std::string_view group) {
        page += fmt::format(".SH {}\n", group);
      },
      [&](const Verb& verb) {
        page += fmt::format(".TP\n.B {}\n{} ({})\n", verb.name, verb.what, verb.tool);
      });
  return page +
         ".SH SEE ALSO\npalpate-precompute(1), palpate-fit(1), palpate-db(1), "
         "palpate-run(1)\n";
}

std::string front_completion() {
  std::string verbs;
  std::string cases;
  for (const Verb& verb : kVerbs) {
    verbs += verb.group.empty() ? "" : fmt::format("{} ", verb.name);
    cases += fmt::format("    {}) tool={} ;;\n", verb.name, verb.tool);
  }
  return fmt::format(
      "# bash completion of palpate, made by palpate --completion\n"
      "_palpate() {{\n"
      "  if ((COMP_CWORD == 1)); then\n"
      "    COMPREPLY=($(compgen -W '{}--help --version' -- \"${{COMP_WORDS[1]}}\"))\n"
      "    return\n"
      "  fi\n"
      "  local tool\n"
      "  case ${{COMP_WORDS[1]}} in\n"
      "{}"
      "    *) return ;;\n"
      "  esac\n"
      "  case ${{COMP_WORDS[1]}} in\n"
      "    fit | db) COMP_WORDS=(\"$tool\" \"${{COMP_WORDS[@]:2}}\")\n"
      "      COMP_CWORD=$((COMP_CWORD - 1)) ;;\n"
      "    *) COMP_WORDS[0]=$tool ;;\n"
      "  esac\n"
      "  typeset -f _${{tool//-/_}} > /dev/null || source <(\"$tool\" --completion)\n"
      "  _${{tool//-/_}}\n"
      "}}\n"
      "complete -o default -F _palpate palpate\n",
      verbs, cases);
}

}  // namespace palpate
