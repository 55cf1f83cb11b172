// Responses from a file a chunk at a time, for bodies larger than memory should hold.
#pragma once

#include <cstdint>
#include <memory>

#include "formats/database/database_index.h"

namespace palpate {

/// Opens a database, reads its index alone, and then chunks as they are asked for.
/// Checksums of the index and of every chunk that is read are verified. A chunk's node
/// indices and curves are those that check() accepts once its digest matches the
/// writer's. Any thread may call it. Calls exclude one another. Of an HDF5 file they
/// exclude all use of HDF5 in the process, because that library is not thread-safe.
class ChunkReader {
 public:
  /// @throws InputError, FormatError as read_database() does for what it reads.
  explicit ChunkReader(const StoredSource& file);
  ~ChunkReader();
  ChunkReader(const ChunkReader&) = delete;
  ChunkReader& operator=(const ChunkReader&) = delete;

  [[nodiscard]] const DatabaseIndex& index() const noexcept { return index_; }

  /// @param chunk in [0, index().chunks()). @throws FormatError if it is damaged.
  [[nodiscard]] BodyChunk body(std::int64_t chunk) const;

  /// The responses of a chunk's nodes. Of their optional parts, what is rendered:
  /// tilts, relaxation, yielding, compliance and puncture.
  /// @param tool position in index().tools. @throws FormatError if it is damaged.
  [[nodiscard]] ResponseTable responses(std::size_t tool, std::int64_t chunk) const;

  /// The rows of compliance of a chunk's nodes; empty of a tool without a table. As
  /// above.
  [[nodiscard]] ComplianceTable compliance(std::size_t tool, std::int64_t chunk) const;

 private:
  class File;
  std::unique_ptr<File> file_;
  DatabaseIndex index_;
};

/// Reads and verifies the index of a database. @throws as ChunkReader does.
[[nodiscard]] DatabaseIndex read_index(const StoredSource& file);

}  // namespace palpate
