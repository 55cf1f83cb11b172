// What files that appear whole are made of: the operating system's part. Each system
// has a source of its own, durable_file_*.cc.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>

namespace palpate {

// 0, or errno's value.

/// An empty file with the permissions that the user grants. EEXIST if one is there.
[[nodiscard]] int create_file(const std::filesystem::path& file) noexcept;
/// Makes these bytes an existing file's content.
[[nodiscard]] int overwrite_file(const std::filesystem::path& file,
                                 std::span<const std::byte> bytes) noexcept;
/// Returns once the file's content is on the disk.
[[nodiscard]] int flush_file(const std::filesystem::path& file) noexcept;
/// Returns once the folder's names are on the disk; at once where the system keeps them
/// by itself.
[[nodiscard]] int flush_folder(const std::filesystem::path& folder) noexcept;

/// Whether what errno says passes by itself, or once somebody has made room.
[[nodiscard]] bool is_passing(int error) noexcept;

/// Tells processes apart that run at the same time.
[[nodiscard]] long process_id() noexcept;

}  // namespace palpate
