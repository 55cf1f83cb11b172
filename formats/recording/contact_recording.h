// Recordings of several contacts as programs of before wrote them: the pose of each
// hand at every tick, and what was rendered there. RECORDING.md describes the file.
#pragma once

#include <cstdint>
#include <filesystem>

#include "formats/recording/recording.h"

namespace palpate {

/// Readers take 1, too, and no other: without a model, which was "facets".
constexpr std::int64_t kContactRecordingVersion = 2;

/// Whether a file says that it is one; false for what cannot be opened.
[[nodiscard]] bool is_contact_recording(const std::filesystem::path& file);

/// Reads and checks; Recording::old says what it lacks. @throws InputError if it is
/// missing, FormatError if it is foreign, damaged, of another version, or its values
/// break the rules of the page.
[[nodiscard]] Recording read_contact_recording(const std::filesystem::path& file);

}  // namespace palpate
