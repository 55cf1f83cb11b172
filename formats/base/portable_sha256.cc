#include "formats/base/portable_sha256.h"

#include <algorithm>
#include <bit>

namespace palpate {
namespace {

using Word = std::uint32_t;

// FIPS 180-4, section 4.2.2: the first 32 bits of the fractional parts of the cube
// roots of the first 64 primes.
constexpr std::array<Word, 64> kRound{
    0x428a2f98, 0x71374491, 0xb5c0fbcf, 0xe9b5dba5, 0x3956c25b, 0x59f111f1, 0x923f82a4,
    0xab1c5ed5, 0xd807aa98, 0x12835b01, 0x243185be, 0x550c7dc3, 0x72be5d74, 0x80deb1fe,
    0x9bdc06a7, 0xc19bf174, 0xe49b69c1, 0xefbe4786, 0x0fc19dc6, 0x240ca1cc, 0x2de92c6f,
    0x4a7484aa, 0x5cb0a9dc, 0x76f988da, 0x983e5152, 0xa831c66d, 0xb00327c8, 0xbf597fc7,
    0xc6e00bf3, 0xd5a79147, 0x06ca6351, 0x14292967, 0x27b70a85, 0x2e1b2138, 0x4d2c6dfc,
    0x53380d13, 0x650a7354, 0x766a0abb, 0x81c2c92e, 0x92722c85, 0xa2bfe8a1, 0xa81a664b,
    0xc24b8b70, 0xc76c51a3, 0xd192e819, 0xd6990624, 0xf40e3585, 0x106aa070, 0x19a4c116,
    0x1e376c08, 0x2748774c, 0x34b0bcb5, 0x391c0cb3, 0x4ed8aa4a, 0x5b9cca4f, 0x682e6ff3,
    0x748f82ee, 0x78a5636f, 0x84c87814, 0x8cc70208, 0x90befffa, 0xa4506ceb, 0xbef9a3f7,
    0xc67178f2};

// Most significant byte first.
template <typename Integer>
void put_big_endian(Integer value, std::span<std::byte, sizeof(Integer)> to) {
  for (std::size_t i = 0; i < to.size(); ++i) {
    to[i] = static_cast<std::byte>(value >> (8 * (to.size() - 1 - i)));
  }
}

// W of section 6.2.2, step 1.
std::array<Word, 64> schedule(std::span<const std::byte, 64> block) {
  std::array<Word, 64> w{};
  for (std::size_t t = 0; t < 16; ++t) {
    for (std::size_t i = 0; i < 4; ++i) {
      w[t] = w[t] << 8 | std::to_integer<Word>(block[4 * t + i]);
    }
  }
  for (std::size_t t = 16; t < 64; ++t) {
    const Word x = w[t - 15];
    const Word y = w[t - 2];
    w[t] = w[t - 16] + (std::rotr(x, 7) ^ std::rotr(x, 18) ^ x >> 3) + w[t - 7] +
           (std::rotr(y, 17) ^ std::rotr(y, 19) ^ y >> 10);
  }
  return w;
}

}  // namespace

// Section 6.2.2, steps 2 to 4.
void PortableSha256::take_block(std::span<const std::byte, kBlockBytes> block) {
  const std::array<Word, 64> w = schedule(block);
  auto [a, b, c, d, e, f, g, h] = hash_;
  for (std::size_t t = 0; t < 64; ++t) {
    const Word sum_e = std::rotr(e, 6) ^ std::rotr(e, 11) ^ std::rotr(e, 25);
    const Word sum_a = std::rotr(a, 2) ^ std::rotr(a, 13) ^ std::rotr(a, 22);
    const Word t1 = h + sum_e + ((e & f) ^ (~e & g)) + kRound[t] + w[t];
    const Word t2 = sum_a + ((a & b) ^ (a & c) ^ (b & c));
    h = g;
    g = f;
    f = e;
    e = d + t1;
    d = c;
    c = b;
    b = a;
    a = t1 + t2;
  }
  const std::array<Word, 8> grown{a, b, c, d, e, f, g, h};
  for (std::size_t i = 0; i < hash_.size(); ++i) {
    hash_[i] += grown[i];
  }
}

void PortableSha256::update(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const std::size_t held = bytes_ % kBlockBytes;
    const std::size_t taken = std::min(kBlockBytes - held, bytes.size());
    std::copy_n(bytes.begin(), taken,
                waiting_.begin() + static_cast<std::ptrdiff_t>(held));
    bytes_ += taken;
    bytes = bytes.subspan(taken);
    if (held + taken == kBlockBytes) {
      take_block(waiting_);
    }
  }
}

// Section 5.1.1: a bit 1, zeros, and the number of bits in the last 64.
std::array<std::uint8_t, 32> PortableSha256::digest() const {
  PortableSha256 padded = *this;
  constexpr std::size_t kLengthAt = kBlockBytes - sizeof(std::uint64_t);
  std::array<std::byte, 2 * kBlockBytes> padding{std::byte{0x80}};
  const std::size_t held = bytes_ % kBlockBytes;
  const std::size_t zeros_end = held < kLengthAt ? kLengthAt : kBlockBytes + kLengthAt;
  const std::span<std::byte> all = std::span(padding).first(zeros_end - held + 8);
  put_big_endian(8 * bytes_, all.last<sizeof(std::uint64_t)>());
  padded.update(all);
  std::array<std::uint8_t, 32> result{};
  const auto bytes = std::as_writable_bytes(std::span(result));
  for (std::size_t i = 0; i < padded.hash_.size(); ++i) {
    put_big_endian(padded.hash_[i], bytes.subspan(4 * i).first<4>());
  }
  return result;
}

}  // namespace palpate
