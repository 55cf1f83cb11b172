#include "formats/base/command_words.h"

#include <algorithm>
#include <filesystem>
#include <iterator>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/base/input_file.h"
#include "formats/base/nearest_name.h"
#include "formats/base/toml_text.h"

namespace palpate {
namespace {

constexpr std::string_view kConfig = "--config";
constexpr std::size_t kMostBytes = 1 << 20;

// "--depth" of "--depth=3".
std::string_view name_of(std::string_view word) {
  return word.substr(0, word.find('='));
}

// "-o", "-ofile" and "-o=file" for "--output".
bool has_letter(std::string_view word, std::string_view name) {
  return word.size() > 1 && word[0] == '-' &&
         std::any_of(std::begin(kLetteredOptions), std::end(kLetteredOptions),
                     [&](const LetteredOption& option) {
                       return option.name == name && option.letter == word[1];
                     });
}

bool is_given(std::span<const std::string> words, std::string_view name) {
  return std::any_of(words.begin(), words.end(), [&](const std::string& word) {
    return name_of(word) == name || has_letter(word, name);
  });
}

std::string text_of(const toml::node& value, const std::string& file,
                    std::string_view key) {
  if (const auto text = value.value_exact<std::string>()) {
    return *text;
  }
  if (const auto whole = value.value_exact<std::int64_t>()) {
    return fmt::format("{}", *whole);
  }
  if (const auto real = value.value_exact<double>()) {
    return fmt::format("{}", *real);
  }
  throw InputError(fmt::format(
      "{}: {} must be a text, a number, true, false or an array of these", file, key));
}

// Options of a table, but those that are given.
void add_options(const toml::table& table, const std::string& file,
                 std::span<const std::string> given, std::vector<std::string>& words) {
  for (const auto& [key, value] : table) {
    const std::string name = fmt::format("--{}", key.str());
    if (name == kConfig) {
      throw InputError(fmt::format("{}: config: presets name no other presets", file));
    }
    if (value.is_table()) {
      throw InputError(fmt::format(
          "{}: [{}] is a table in a table; options stand in the table of their verb",
          file, key.str()));
    }
    if (is_given(given, name) || is_given(words, name)) {
      continue;
    }
    if (const auto flag = value.value_exact<bool>()) {
      if (*flag) {
        words.push_back(name);
      }
    } else if (const toml::array* several = value.as_array()) {
      words.push_back(name);
      for (const toml::node& one : *several) {
        words.push_back(text_of(one, file, key.str()));
      }
    } else {
      words.push_back(fmt::format("{}={}", name, text_of(value, file, key.str())));
    }
  }
}

// A table of a verb that no tool has is a slip: its options would be left out.
void refuse_unknown_table(const toml::table& all, const std::string& file) {
  const std::vector<std::string_view> known(std::begin(kTablesOfOptions),
                                            std::end(kTablesOfOptions));
  for (const auto& [key, value] : all) {
    if (value.is_table() &&
        std::find(known.begin(), known.end(), key.str()) == known.end()) {
      throw InputError(fmt::format(
          "{}: [{}] is the table of no verb; the nearest is [{}], known are {}", file,
          key.str(), nearest_name(key.str(), known), fmt::join(known, ", ")));
    }
  }
}

std::vector<std::string> options_of(const std::string& file,
                                    std::span<const std::string> given) {
  toml::table all =
      parse_toml(read_file(file, kMostBytes, "a file of options (TOML)"), file);
  refuse_unknown_table(all, file);
  std::vector<std::string> words;
  if (!given.empty()) {
    if (const toml::table* of_verb = all[given.front()].as_table()) {
      add_options(*of_verb, file, given, words);
    }
  }
  for (const std::string_view table : kTablesOfOptions) {
    if (all[table].is_table()) {
      all.erase(table);
    }
  }
  add_options(all, file, given, words);
  return words;
}

void rename_options(std::vector<std::string>& words, std::vector<std::string>& notes) {
  for (std::string& word : words) {
    for (const RenamedOption& option : kRenamedOptions) {
      if (name_of(word) == option.before) {
        word = std::string(option.now) + word.substr(option.before.size());
        notes.push_back(
            fmt::format("{} is {} now; the old name ends with the next "
                        "version",
                        option.before, option.now));
        break;
      }
    }
  }
}

}  // namespace

CommandWords command_words(std::span<const std::string> given) {
  CommandWords line;
  std::string file;
  for (std::size_t i = 0; i < given.size(); ++i) {
    if (name_of(given[i]) != kConfig) {
      line.word.push_back(given[i]);
    } else if (given[i].size() > kConfig.size()) {
      file = given[i].substr(kConfig.size() + 1);
    } else if (i + 1 < given.size()) {
      file = given[++i];
    } else {
      throw InputError("--config needs a file of options (TOML)");
    }
  }
  rename_options(line.word, line.note);
  if (!file.empty()) {
    std::vector<std::string> more = options_of(file, line.word);
    rename_options(more, line.note);
    line.word.insert(line.word.end(), std::make_move_iterator(more.begin()),
                     std::make_move_iterator(more.end()));
  }
  return line;
}

}  // namespace palpate
