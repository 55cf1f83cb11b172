// An output that is there: done already, or better than what would replace it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "formats/database/work_unit.h"
#include "formats/stored/storage_options.h"

namespace palpate {

[[nodiscard]] std::int64_t responses_of(const Shard& shard);

/// How many responses a database or a shard's file holds; none if it is not there, is
/// damaged, or is of another plan.
[[nodiscard]] std::optional<std::int64_t> responses_there(
    const std::filesystem::path& output, const std::string& plan_digest);

/// The database as a build of that plan would report it.
/// @param precision none: any.
/// @returns none if it is not there, damaged, of another plan or precision.
[[nodiscard]] std::optional<Assembly> assembled_already(
    const std::filesystem::path& output, const std::string& plan_digest,
    std::optional<Precision> precision);

/// Writes, unless the output holds more responses of the same plan. A disk that is full
/// is waited for. @throws NumericalError if the output stays as it is; as
/// with_patience().
void write_unless_worse(const std::filesystem::path& output,
                        const std::string& plan_digest, std::int64_t responses,
                        double patience_s, const std::function<void()>& write);

}  // namespace palpate
