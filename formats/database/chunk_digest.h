// Digests of what a chunk of nodes holds: how damage in a file is found.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "formats/base/sha256.h"
#include "formats/database/database_index.h"

namespace palpate {

/// Adds all values of an array, in their order in memory.
template <typename Values>
void add_values(Sha256& digest, const Values& values) {
  digest.update(
      std::as_bytes(std::span(values.data(), static_cast<std::size_t>(values.size()))));
}

/// SHA-256 of what a chunk holds, as FORMAT.md lists it.
[[nodiscard]] std::vector<std::uint8_t> chunk_digest(const BodyChunk& chunk);
[[nodiscard]] std::vector<std::uint8_t> chunk_digest(const ResponseTable& chunk);

/// The same of the rows that a chunk's nodes have of shares and sites.
[[nodiscard]] std::vector<std::uint8_t> memory_digest(const Viscoelasticity& chunk);

/// The same of the rows of its tilts.
[[nodiscard]] std::vector<std::uint8_t> tilt_digest(const ResponseTable& chunk);

/// The same of the rows of its compliance table.
[[nodiscard]] std::vector<std::uint8_t> compliance_digest(const ComplianceTable& chunk);

/// The same of the rows of its pressures and lateral stiffnesses.
[[nodiscard]] std::vector<std::uint8_t> contact_digest(const ContactTable& chunk);

/// The same of all that a file says of a tool's puncture, rows of all nodes too.
[[nodiscard]] std::vector<std::uint8_t> puncture_digest(const Puncture& puncture);

}  // namespace palpate
