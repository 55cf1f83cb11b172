#include "formats/base/man_page.h"

#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace palpate {
namespace {

/// Text as troff takes it: no escape, no request at the start of a line.
std::string roff(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\') {
      out += "\\e";
    } else if (c == '-') {
      out += "\\-";
    } else if ((c == '.' || c == '\'') && (out.empty() || out.back() == '\n')) {
      out += std::string("\\&") + c;
    } else {
      out += c;
    }
  }
  return out;
}

std::vector<const CLI::App*> commands(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App* /*any*/) {
    return true;
  });
}

std::vector<const CLI::Option*> options(const CLI::App& app) {
  return app.get_options([](const CLI::Option* option) {
    return !option->get_group().empty();
  });
}

/// "--depth-unit,-u TEXT" or "scene".
std::string option_head(const CLI::Option& option) {
  const std::string names = option.get_name(option.get_positional(), true);
  const bool takes_value =
      !option.get_positional() && option.get_items_expected_max() > 0;
  return takes_value && option.get_type_size_max() > 0
             ? names + " " + option.get_type_name()
             : names;
}

std::string option_list(const CLI::App& app) {
  std::string page;
  for (const CLI::Option* option : options(app)) {
    page += fmt::format(".TP\n.B {}\n{}{}\n", roff(option_head(*option)),
                        roff(option->get_description()),
                        option->get_required() ? " (required)" : "");
  }
  return page;
}

/// Words that may follow: subcommands and long options.
std::string completion_words(const CLI::App& app) {
  std::string words;
  for (const CLI::App* command : commands(app)) {
    words += command->get_name() + " ";
  }
  for (const CLI::Option* option : options(app)) {
    for (const std::string& name : option->get_lnames()) {
      words += "--" + name + " ";
    }
  }
  return words;
}

void command_sections(const CLI::App& app, const std::string& path, std::string& page) {
  for (const CLI::App* command : commands(app)) {
    const std::string name =
        path.empty() ? command->get_name() : path + " " + command->get_name();
    page += fmt::format(".SS {}\n{}\n{}", roff(name), roff(command->get_description()),
                        option_list(*command));
    command_sections(*command, name, page);
  }
}

void completion_cases(const CLI::App& app, const std::string& path,
                      std::string& cases) {
  cases += fmt::format("    '{}') words='{}' ;;\n", path, completion_words(app));
  for (const CLI::App* command : commands(app)) {
    completion_cases(*command, path + "/" + command->get_name(), cases);
  }
}

}  // namespace

std::string man_page(const CLI::App& app) {
  const std::string& name = app.get_name();
  std::string page = fmt::format(
      ".TH \"{0}\" 1 \"\" \"palpate {1}\" \"User Commands\"\n.SH NAME\n{0} \\- {2}\n"
      ".SH SYNOPSIS\n.B {0}\n.I command\n[options]\n.SH OPTIONS\n{3}.SH COMMANDS\n",
      roff(name), PALPATE_VERSION, roff(app.get_description()), option_list(app));
  command_sections(app, "", page);
  return page +
         ".SH EXIT STATUS\n0 success, 1 a bug, 2 wrong input, 3 a file is not what its "
         "format promises, 4 a computation did not reach its goal, 5 a device failed, "
         "6 what was compared differs, 75 try again (job scripts), 130 interrupted.\n";
}

std::string bash_completion(const CLI::App& app) {
  const std::string& name = app.get_name();
  std::string function = name;
  for (char& c : function) {
    c = c == '-' ? '_' : c;
  }
  std::string cases;
  completion_cases(app, "", cases);
  return fmt::format(
      "# bash completion of {0}, made by {0} --completion\n"
      "_{1}() {{\n"
      "  local path='' words='' word next i\n"
      "  for ((i = 1; i <= COMP_CWORD; ++i)); do\n"
      "    word=${{COMP_WORDS[i]}}\n"
      "    case \"$path\" in\n{2}    esac\n"
      "    next=\" $words\"\n"
      "    if ((i < COMP_CWORD)) && [[ $word != -* && $next == *\" $word \"* ]]; then\n"
      "      path=\"$path/$word\"\n"
      "    fi\n"
      "  done\n"
      "  COMPREPLY=($(compgen -W \"$words\" -- \"${{COMP_WORDS[COMP_CWORD]}}\"))\n"
      "}}\n"
      "complete -o default -F _{1} {0}\n",
      name, function, cases);
}

}  // namespace palpate
