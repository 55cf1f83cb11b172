// Databases as HDF5 files. Every call excludes other use of the HDF5 library
// (Hdf5Lock), so that no caller need do so. A build without HDF5 has the functions,
// which refuse.
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "formats/stored/stored_file.h"
#include "formats/stored/stored_sink.h"

namespace palpate {

/// Whether this build reads and writes HDF5.
[[nodiscard]] bool has_hdf5() noexcept;

/// The first bytes of an HDF5 file.
inline constexpr std::string_view kHdf5Magic{"\x89HDF\r\n\x1a\n", 8};

/// Opens a file that begins with the magic. @throws FormatError if it is truncated or
/// damaged, or if this build has no HDF5.
[[nodiscard]] std::unique_ptr<const StoredFile> open_hdf5(
    const std::filesystem::path& file);

/// The same of bytes in memory, of which HDF5 takes a copy.
[[nodiscard]] std::unique_ptr<const StoredFile> open_hdf5(
    std::span<const std::byte> bytes, const std::string& name);

/// A new file in memory: HDF5 1.10 can crash after a write that failed, for example on
/// a full disk. Its methods @throw std::runtime_error if HDF5 fails all the same.
/// @param compress larger datasets are shuffled and deflated
/// @throws InputError if this build has no HDF5.
[[nodiscard]] std::unique_ptr<StoredSink> make_hdf5_sink(bool compress);

}  // namespace palpate
