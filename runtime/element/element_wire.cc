#include "runtime/element/element_wire.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <type_traits>

#include "runtime/element/element_cache.h"

namespace palpate {
namespace {

static_assert(std::endian::native == std::endian::little, "frames are little-endian");

using Magic = std::array<std::byte, 4>;

template <typename Scalar>
constexpr Magic kMagicOf{std::byte{'P'}, std::byte{'L'}, std::byte{'P'},
                         std::byte{sizeof(Scalar) == 8 ? 'E' : 'S'}};
constexpr Magic kMagic = kMagicOf<Real>;
constexpr std::size_t kBodyBytes = kWireBytes - sizeof(std::uint32_t);

constexpr std::array<std::uint32_t, 256> kCrcTable = [] {
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t i = 0; i < 256; ++i) {
    std::uint32_t value = i;
    for (int bit = 0; bit < 8; ++bit) {
      value = (value >> 1) ^ ((value & 1U) != 0 ? 0xEDB88320U : 0U);
    }
    table[i] = value;
  }
  return table;
}();

// Values one after another, into a frame or out of it.
template <typename Scalar>
struct Writer {
  std::byte* at;
  template <typename T>
  void operator()(const T& value) noexcept {
    std::memcpy(at, &value, sizeof value);
    at += sizeof value;
  }
  void operator()(const Real& value) noexcept requires(!std::is_same_v<Scalar, Real>) {
    (*this)(static_cast<Scalar>(value));
  }
  template <std::size_t kCount>
  void operator()(const std::array<Real, kCount>& values) noexcept {
    for (const Real& value : values) {
      (*this)(value);
    }
  }
};

struct Reader {
  const std::byte* at;
  template <typename T>
  void operator()(T& value) noexcept {
    std::memcpy(&value, at, sizeof value);
    at += sizeof value;
  }
};

// The order of a node's values, for both.
template <typename Pass, typename Node, typename Memory, typename Below>
void pass_node(Pass& pass, Node& node, Memory& memory, Below& below) noexcept {
  // Bytes of a node, r of each Real:
  //   0            8        index, samples (int32)
  //   8            15 r     position, normal, direction, tilt, its change with height
  //   8 + 15 r     3 r      touch offset, friction, presliding
  //   8 + 18 r     12 r     lateral stiffness
  //   8 + 30 r     192 r    depths, forces, stiffnesses, energies, 48 of each
  pass(node.node);
  pass(node.samples);
  pass(node.position_m);
  pass(node.normal);
  pass(node.direction);
  pass(node.tilt);
  pass(node.tilt_by_height_per_m);
  pass(node.touch_offset_m);
  pass(node.friction);
  pass(node.presliding_m);
  pass(node.lateral);
  pass(node.depth_m);
  pass(node.force_n);
  pass(node.stiffness_n_per_m);
  pass(node.energy_j);
  //   8 + 222 r    16       four sites (int32)
  //   24 + 222 r   15 r     weights (4), shares that relax (4), cuts (7)
  //   24 + 237 r   5 r      yield depth, share that stays; softening: onset, scale,
  //   most
  pass(memory.site);
  pass(memory.weight);
  pass(memory.relaxing);
  pass(memory.cut_m);
  pass(memory.yield_depth_m);
  pass(memory.dent_share);
  pass(memory.onset_m);
  pass(memory.soft_scale_m);
  pass(memory.soft_most);
  //   24 + 242 r   10 + 7 r layers (int32), rupture, depths (6), materials (int8)
  pass(below.layers);
  pass(below.rupture);
  pass(below.depth_m);
  pass(below.material);
}

constexpr unsigned kActive = 1;
constexpr unsigned kYields = 2;

struct Head {
  std::uint16_t version = kWireVersion;
  std::uint16_t flags = 0;
  std::uint32_t session = 0;
  std::uint16_t terms = 0;
  std::uint16_t bundles = 1;
};

template <typename Pass, typename Message, typename HeadType>
void pass_frame(Pass& pass, Message& element, HeadType& head) noexcept {
  pass(head.version);
  pass(head.flags);
  pass(head.session);
  pass(element.triangle);
  pass(element.sequence);
  pass(element.sent_ns);
  pass(element.neighbour);
  pass(head.terms);
  pass(head.bundles);
  pass(element.memory.relaxation_s);
  pass(element.touch_height_m);
  for (std::size_t j = 0; j < 3; ++j) {
    pass_node(pass, element.node[j], element.memory.node[j], element.puncture[j]);
  }
}

void clear_unused(std::array<Real, kElementSamples>& values, std::int32_t samples) {
  std::fill(values.begin() + samples, values.end(), 0.0);
}

bool all_finite(std::span<const Real> values) {
  return std::all_of(values.begin(), values.end(), [](Real value) {
    return std::isfinite(value);
  });
}

// A frame whose checksum holds still comes from somebody else's program.
bool well_sent(const ElementNode& node) {
  const auto most = static_cast<std::int32_t>(kElementSamples);
  return node.samples >= 0 && node.samples != 1 && node.samples <= most &&
         all_finite(node.position_m) && all_finite(node.normal) &&
         all_finite(node.direction) && all_finite(node.tilt) &&
         all_finite(node.tilt_by_height_per_m) && std::isfinite(node.touch_offset_m) &&
         std::isfinite(node.friction) && std::isfinite(node.presliding_m) &&
         all_finite(node.lateral) && all_finite(node.depth_m) &&
         all_finite(node.force_n) && all_finite(node.stiffness_n_per_m) &&
         all_finite(node.energy_j);
}

bool well_sent(const Element& element, const Head& head) {
  return head.version == kWireVersion && head.flags <= (kActive | kYields) &&
         element.sequence > 0 && element.triangle >= 0 &&
         std::isfinite(element.touch_height_m) && well_formed(element.memory) &&
         std::all_of(element.node.begin(), element.node.end(),
                     [](const ElementNode& node) {
                       return well_sent(node);
                     }) &&
         std::all_of(element.puncture.begin(), element.puncture.end(),
                     [](const NodePuncture& node) {
                       return well_formed(node);
                     });
}

// Drops bytes of the buffer up to the next that a frame may begin with, at least one.
void skip(ElementReceiver& receiver) {
  std::byte* const begin = receiver.buffer.data();
  std::byte* const end = begin + receiver.filled;
  std::byte* next = begin + 1;
  while (next != end) {
    const auto compared =
        std::min(static_cast<std::ptrdiff_t>(kMagic.size()), end - next);
    if (std::equal(next, next + compared, kMagic.begin())) {
      break;
    }
    ++next;
  }
  receiver.counts.skipped_bytes += static_cast<std::uint64_t>(next - begin);
  receiver.filled = static_cast<std::size_t>(end - next);
  std::memmove(begin, next, receiver.filled);
}

// Whether the buffer begins as a frame does, as far as it goes.
bool begins_well(const ElementReceiver& receiver) {
  const std::size_t compared = std::min(receiver.filled, kMagic.size());
  return std::equal(kMagic.begin(),
                    kMagic.begin() + static_cast<std::ptrdiff_t>(compared),
                    receiver.buffer.begin());
}

// Reads the full buffer. False: broken.
bool decode(const WireFrame& frame, Element& element, Head& head) {
  std::uint32_t checksum = 0;
  std::memcpy(&checksum, frame.data() + kBodyBytes, sizeof checksum);
  if (crc32(std::span(frame).first(kBodyBytes)) != checksum) {
    return false;
  }
  Reader read{frame.data() + kMagic.size()};
  pass_frame(read, element, head);
  element.active = (head.flags & kActive) != 0;
  element.memory.yields = (head.flags & kYields) != 0;
  element.memory.terms = head.terms;
  element.memory.bundles = head.bundles;
  return well_sent(element, head);
}

// Whether an element is newer than all before; counts what it says of the wire.
bool is_news(ElementReceiver& receiver, std::uint64_t sequence, std::uint32_t session) {
  WireCounts& counts = receiver.counts;
  if (counts.sessions == 0 || session != receiver.session) {
    receiver.session = session;
    receiver.newest = 0;
    receiver.seen = 0;
    ++counts.sessions;
  }
  if (sequence > receiver.newest) {
    const std::uint64_t step = sequence - receiver.newest;
    counts.lost += step - 1;
    receiver.seen = step < 64 ? (receiver.seen << step) | 1U : 1U;
    receiver.newest = sequence;
    ++counts.accepted;
    return true;
  }
  const std::uint64_t back = receiver.newest - sequence;
  const std::uint64_t bit = back < 64 ? std::uint64_t{1} << back : 0;
  ++((receiver.seen & bit) != 0 ? counts.repeated : counts.late);
  receiver.seen |= bit;
  return false;
}

template <typename Scalar>
void write_frame(const Element& element, std::uint32_t session,
                 std::array<std::byte, kFrameBytes<Scalar>>& frame) {
  std::copy(kMagicOf<Scalar>.begin(), kMagicOf<Scalar>.end(), frame.begin());
  Element sent = element;
  for (ElementNode& node : sent.node) {
    clear_unused(node.depth_m, node.samples);
    clear_unused(node.force_n, node.samples);
    clear_unused(node.stiffness_n_per_m, node.samples);
    clear_unused(node.energy_j, node.samples);
  }
  Head head{.flags = static_cast<std::uint16_t>((element.active ? kActive : 0U) |
                                                (element.memory.yields ? kYields : 0U)),
            .session = session,
            .terms = static_cast<std::uint16_t>(element.memory.terms),
            .bundles = static_cast<std::uint16_t>(element.memory.bundles)};
  Writer<Scalar> write{frame.data() + kMagic.size()};
  pass_frame(write, sent, head);
  write(crc32(std::span(frame).first(frame.size() - sizeof(std::uint32_t))));
}

}  // namespace

std::uint32_t crc32(std::span<const std::byte> bytes) noexcept {
  std::uint32_t value = 0xFFFFFFFFU;
  for (const std::byte byte : bytes) {
    value = kCrcTable[(value ^ std::to_integer<std::uint32_t>(byte)) & 0xFFU] ^
            (value >> 8);
  }
  return ~value;
}

void encode(const Element& element, std::uint32_t session,
            DoubleFrame& frame) noexcept {
  write_frame<double>(element, session, frame);
}

void encode(const Element& element, std::uint32_t session,
            SingleFrame& frame) noexcept {
  write_frame<float>(element, session, frame);
}

bool receive(ElementReceiver& receiver, std::span<const std::byte>& bytes,
             Element& element) noexcept {
  while (true) {
    // 1. As many bytes as the frame still lacks.
    const std::size_t taken = std::min(bytes.size(), kWireBytes - receiver.filled);
    std::copy_n(bytes.begin(), taken,
                receiver.buffer.begin() + static_cast<std::ptrdiff_t>(receiver.filled));
    receiver.filled += taken;
    bytes = bytes.subspan(taken);
    // 2. Not a frame's beginning: on to the next place where the magic, or what has
    // come of it, stands.
    if (!begins_well(receiver)) {
      skip(receiver);
      continue;
    }
    if (receiver.filled < kWireBytes) {
      return false;
    }
    // 3. A whole frame. A broken one is not dropped whole, because the next may begin
    // within its bytes.
    Head head;
    if (!decode(receiver.buffer, element, head)) {
      ++receiver.counts.broken;
      skip(receiver);
      continue;
    }
    // 4. Late and repeated elements are counted and dropped.
    receiver.filled = 0;
    if (is_news(receiver, element.sequence, head.session)) {
      return true;
    }
  }
}

}  // namespace palpate
