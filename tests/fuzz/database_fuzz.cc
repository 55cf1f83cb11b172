// Any bytes as a database: read whole, by its index and chunk by chunk, or refused with
// an Error. What is read passes check().
#include "formats/base/error.h"
#include "formats/database/chunk_reader.h"
#include "formats/database/response_database.h"
#include "formats/hdf5/hdf5_lock.h"
#include "tests/fuzz/input_file.h"

namespace {

void read_whole(const std::filesystem::path& path) {
  try {
    const palpate::ResponseDatabase database = palpate::read_database(path);
    try {
      palpate::check(database);
    } catch (const palpate::Error&) {
      __builtin_trap();
    }
  } catch (const palpate::Error&) {
  }
}

void read_chunks(const std::filesystem::path& path) {
  try {
    const palpate::ChunkReader reader(path);
    for (std::int64_t k = 0; k < reader.index().chunks(); ++k) {
      (void)reader.body(k);
      for (std::size_t tool = 0; tool < reader.index().tools.size(); ++tool) {
        const palpate::ResponseTable part = reader.responses(tool, k);
        for (std::int64_t i = 0; i < part.nodes(); ++i) {
          (void)part.curve(i).at(0.001);
        }
      }
    }
  } catch (const palpate::Error&) {
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const bool quiet = (palpate::skip_hdf5_exit_cleanup(), true);
  static palpate::InputFile file(".h5");
  if (quiet) {
    read_whole(file.with(data, size));
    read_chunks(file.with(data, size));
  }
  return 0;
}
