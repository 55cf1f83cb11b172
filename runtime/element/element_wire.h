// Element messages on a wire, between a slow process on one processor and a fast one on
// another. Every frame has the same size. A frame that is lost, repeated, late or
// broken on the way is counted and does no harm. The fast step goes on with the
// elements it has.
//
// A frame, little-endian, floating point as IEEE 754 binary64 or, for a receiver whose
// Real is float, binary32; r is their size, 8 or 4:
//
//   bytes       what
//   0   4       magic "PLPE" (binary64) or "PLPS" (binary32)
//   4   2       version, 6
//   6   2       flags: 1 active, else a neighbour; 2 the body yields
//   8   4       session: drawn anew when the sender starts
//   12  4       triangle
//   16  8       sequence, counts up from 1 within a session
//   24  8       time of sending [ns]
//   32  3 x 4   neighbours across the edges
//   44  2       terms of the memory, 0: static
//   46  2       bundles
//   48  4 r     relaxation times; those past the terms are 0
//   48 + 4 r    r   height of the tool at touch
//   48 + 5 r    3 x (34 + 249 r)
//               nodes: index (4), samples (4), position, normal, direction, tilt, its
//               change with height (3 r each),
//               touch offset, friction, presliding (r each), lateral
//               stiffness (12 r), then depths, forces,
//               stiffnesses, energies (48 r each; those past `samples` are 0), then
//               memory: sites (4 x 4), weights, shares (4 r each), cuts (7 r),
//               yield depth, share that stays, onset, scale and most of softening
//               (r each), then what a needle meets: layers (4), first rupture (r),
//               depths (6 r), materials (6 x 1)
//   at the end 4  CRC-32 (IEEE 802.3) of all before
//
// CRC-32 finds every three wrong bits and every burst of 32 in a frame of this length.
// No allocation, no exception; one thread.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "runtime/element/element.h"

namespace palpate {

/// Bytes of a frame of this floating point.
template <typename Scalar>
constexpr std::size_t kFrameBytes = 52 + 5 * sizeof(Scalar) +
                                    3 * (34 + 249 * sizeof(Scalar));
using DoubleFrame = std::array<std::byte, kFrameBytes<double>>;  // 6170 bytes
using SingleFrame = std::array<std::byte, kFrameBytes<float>>;   // 3162 bytes

/// What this program's Real receives.
constexpr std::size_t kWireBytes = kFrameBytes<Real>;
using WireFrame = std::array<std::byte, kWireBytes>;
constexpr std::uint16_t kWireVersion = 6;

/// CRC-32 of IEEE 802.3 (reflected, 0xEDB88320): 0xCBF43926 of "123456789".
[[nodiscard]] std::uint32_t crc32(std::span<const std::byte> bytes) noexcept;

/// @param element with sequence >= 1 and well formed counts of samples.
void encode(const Element& element, std::uint32_t session, DoubleFrame& frame) noexcept;
void encode(const Element& element, std::uint32_t session, SingleFrame& frame) noexcept;

/// What came over a wire.
struct WireCounts {
  std::uint64_t accepted = 0;
  std::uint64_t lost = 0;      ///< sequence numbers passed over; late ones among them
  std::uint64_t late = 0;      ///< dropped: an element sent after it came before it
  std::uint64_t repeated = 0;  ///< dropped: it came before
  std::uint64_t broken = 0;    ///< dropped: checksum, version or values are wrong
  std::uint64_t skipped_bytes = 0;  ///< that belong to no whole frame
  std::uint64_t sessions = 0;       ///< times that a sender began
};

/// Frames out of a stream of bytes that may be cut and damaged anywhere. As large as a
/// frame.
struct ElementReceiver {
  WireFrame buffer;
  std::size_t filled = 0;
  std::uint32_t session = 0;
  std::uint64_t newest = 0;  ///< sequence; 0: none of this session
  std::uint64_t seen = 0;    ///< bit i: newest - i came
  WireCounts counts;
};

/// Takes bytes in until an element is complete; what it took is cut off the front of
/// `bytes`. @returns whether `element` was set; call again while bytes are left.
[[nodiscard]] bool receive(ElementReceiver& receiver, std::span<const std::byte>& bytes,
                           Element& element) noexcept;

}  // namespace palpate
