// Any bytes as a scene file: read, or refused with an Error.
#include "formats/base/error.h"
#include "formats/scene/scene.h"
#include "tests/fuzz/input_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static palpate::InputFile file(".toml");
  try {
    (void)palpate::read_scene(file.with(data, size));
  } catch (const palpate::Error&) {
  }
  return 0;
}
