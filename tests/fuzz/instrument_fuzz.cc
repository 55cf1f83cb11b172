// Any bytes as a file of an instrument, the first naming a layout to try beside the one
// that is recognised: listed and read, or refused with an Error. Archives are built of
// the bytes, because no mutation keeps their checksums: entries parted by byte 0x1E,
// name and content by byte 0x1F.
#include <string>
#include <string_view>

#include <zip.h>

#include "formats/base/error.h"
#include "formats/measurement/instrument_file.h"
#include "formats/measurement/mach1_map.h"
#include "tests/fuzz/input_file.h"

namespace {

void read_all(const std::filesystem::path& file) {
  try {
    const palpate::InstrumentLayout& layout = palpate::layout_of(file);
    const palpate::InstrumentFile list = layout.list(file);
    if (list.curve.empty()) {
      __builtin_trap();
    }
    std::size_t tried = 0;
    for (const palpate::InstrumentCurve& curve : list.curve) {
      if (++tried > 4) {
        break;
      }
      try {
        const palpate::Measurement m = layout.read(file, curve, {}).samples;
        if (m.depth_m.empty() || m.depth_m.size() != m.force_n.size() ||
            (!m.time_s.empty() && m.time_s.size() != m.force_n.size())) {
          __builtin_trap();
        }
      } catch (const palpate::Error&) {
      }
    }
  } catch (const palpate::Error&) {
  }
}

void read_map(std::string_view text) {
  try {
    const auto lines = palpate::text_lines(text, "map");
    if (palpate::is_mach1_map(lines)) {
      (void)palpate::read_mach1_map("map", lines);
    }
  } catch (const palpate::Error&) {
  }
}

std::string archive_of(std::string_view bytes, const std::filesystem::path& file) {
  zip_t* zip = zip_open(file.c_str(), ZIP_CREATE | ZIP_TRUNCATE, nullptr);
  while (zip != nullptr && !bytes.empty()) {
    const std::size_t end = std::min(bytes.find('\x1e'), bytes.size());
    const std::string_view entry = bytes.substr(0, end);
    bytes.remove_prefix(std::min(end + 1, bytes.size()));
    const std::size_t colon = std::min(entry.find('\x1f'), entry.size());
    const std::string name(entry.substr(0, colon));
    const std::string_view content = entry.substr(std::min(colon + 1, entry.size()));
    zip_source_t* source = zip_source_buffer(zip, content.data(), content.size(), 0);
    if (zip_file_add(zip, name.c_str(), source, ZIP_FL_OVERWRITE) < 0) {
      zip_source_free(source);
    }
  }
  if (zip != nullptr && zip_close(zip) != 0) {
    zip_discard(zip);
  }
  return file.string();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static palpate::InputFile file(".dat");
  static palpate::InputFile archive(".zip");
  if (size == 0) {
    return 0;
  }
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  if (data[0] == 'Z') {
    read_all(archive_of(bytes.substr(1), archive.with(nullptr, 0)));
  } else {
    read_all(file.with(data, size));
    read_map(bytes);
  }
  return 0;
}
