// SHA-256 (FIPS 180-4) in plain C++, for platforms without OpenSSL.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace palpate {

/// A digest that grows piece by piece.
class PortableSha256 {
 public:
  void update(std::span<const std::byte> bytes);

  /// Of all bytes so far; more may follow.
  [[nodiscard]] std::array<std::uint8_t, 32> digest() const;

 private:
  static constexpr std::size_t kBlockBytes = 64;

  void take_block(std::span<const std::byte, kBlockBytes> block);

  std::array<std::uint32_t, 8> hash_{0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                                     0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
  std::array<std::byte, kBlockBytes> waiting_{};  // less than a block
  std::uint64_t bytes_ = 0;                       // so far
};

}  // namespace palpate
