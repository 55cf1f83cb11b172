// Any bytes as a recording, of one contact or of several: read, or refused with an
// Error.
#include "formats/base/error.h"
#include "formats/hdf5/hdf5_lock.h"
#include "formats/recording/recording.h"
#include "tests/fuzz/input_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const bool quiet = (palpate::skip_hdf5_exit_cleanup(), true);
  static palpate::InputFile file(".h5");
  if (quiet) {
    try {
      (void)palpate::read_recording(file.with(data, size));
    } catch (const palpate::Error&) {
    }
  }
  return 0;
}
