// What is rendered chunk by chunk is held to the rules of what is read whole. The bytes
// are a list of changes to a small database, which is written with digests that are
// right: both readers must agree on it.
#include "formats/base/error.h"
#include "formats/hdf5/hdf5_lock.h"
#include "tests/fuzz/input_file.h"
#include "tests/support/database_changes.h"
#include "tests/support/small_database.h"

namespace {

template <typename Read>
bool takes(const Read& read) {
  try {
    read();
    return true;
  } catch (const palpate::Error&) {
    return false;
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using palpate::DatabaseChange;
  static const bool quiet = (palpate::skip_hdf5_exit_cleanup(), true);
  static palpate::InputFile file(".h5");
  if (!quiet) {
    return 0;
  }
  palpate::ResponseDatabase database = palpate::small_database();
  database.storage.chunk_nodes = 2;
  constexpr std::size_t kMost = 8;
  for (std::size_t i = 0; i < kMost && (i + 1) * DatabaseChange::kBytes <= size; ++i) {
    palpate::apply(database, DatabaseChange(std::span<const std::uint8_t, 13>(
                                 data + i * DatabaseChange::kBytes, 13)));
  }
  const std::filesystem::path path = file.with(data, 0);
  if (!takes([&] {
        palpate::write_unchecked(path, database);
      })) {
    return 0;  // cannot be ordered: no file
  }
  const bool streamed = takes([&] {
    palpate::stream_all(path);
  });
  const bool read = takes([&] {
    (void)palpate::read_database(path);
  });
  if (streamed != read) {
    __builtin_trap();
  }
  return 0;
}
