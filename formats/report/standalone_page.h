// The live view's page as one file that needs no server and no network. It holds its
// scripts, the runtime as WebAssembly, and a database in flat form. It opens from a
// disk.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace palpate {

/// Of this machine's Inverse service (runtime/inverse/INVERSE.md), which a page may
/// reach where somebody wants it to.
struct InversePorts {
  std::uint16_t states = 10001;
  std::uint16_t events = 10020;
};

struct StandaloneBody {
  std::string name;                 ///< of the database, as the page shows it
  std::vector<std::string> tools;   ///< one, or two for two hands
  std::string left_out;             ///< what the page does not carry; one line
  std::span<const std::byte> flat;  ///< the database (FLAT.md)
  InversePorts device = {};
};

/// @param module palpate.wasm (runtime/view/page_module.cc)
/// The page's policy lets it load nothing, and reach those two ports alone. Its scripts
/// and data are packed (gzip, base64) and unpacked by the browser: DecompressionStream
/// and WebAssembly exceptions, which browsers have since 2023.
[[nodiscard]] std::string standalone_page(const StandaloneBody& body,
                                          std::span<const std::byte> module);

}  // namespace palpate
