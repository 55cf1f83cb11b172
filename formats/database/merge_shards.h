// The shares of one computation, back in one database.
#pragma once

#include <filesystem>
#include <span>

#include "formats/database/work_unit.h"

namespace palpate {

/// What an undisturbed computation gives, to the bit, from files of write_shard; their
/// order does not matter. @throws InputError in one sentence for a file that is no
/// shard, shards of different computations, units that come twice or are missing.
/// FormatError for a damaged shard; NumericalError as require_responses().
/// @param stored as assemble()'s.
[[nodiscard]] Assembly merge_shards(std::span<const std::filesystem::path> files,
                                    const StoredForces& stored);

}  // namespace palpate
