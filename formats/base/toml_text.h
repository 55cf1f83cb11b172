// TOML from a file that nobody vouches for.
#pragma once

#include <string_view>

#include <toml++/toml.h>

namespace palpate {

/// The text's root table.
/// @param name of the file, for messages
/// @throws InputError "name:line: is not TOML: why", also for a key of more than 64
///   parts: the parser recurses over them.
toml::table parse_toml(std::string_view text, std::string_view name);

}  // namespace palpate
