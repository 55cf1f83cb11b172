// Databases as flat files, of bytes in memory or on disk: FLAT.md. No library is needed
// to read one.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include "formats/stored/stored_file.h"
#include "formats/stored/stored_sink.h"

namespace palpate {

/// Opens a file that begins with kFlatMagic (flat_directory.h), and reads its
/// directory. @throws FormatError if it is truncated, damaged or of another version.
[[nodiscard]] std::unique_ptr<const StoredFile> open_flat(
    const std::filesystem::path& file);

/// The same of bytes in memory, which must outlive what is returned.
[[nodiscard]] std::unique_ptr<const StoredFile> open_flat(
    std::span<const std::byte> bytes, const std::string& name);

/// A new file in memory.
[[nodiscard]] std::unique_ptr<StoredSink> make_flat_sink();

}  // namespace palpate
