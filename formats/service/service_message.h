// What a service that computes a scene's responses and a runtime that renders them say
// to each other while the computation goes on (SERVICE.md).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include <Eigen/Core>

#include "formats/database/work_unit.h"

namespace palpate {

constexpr int kServiceVersion = 2;  ///< a peer of another version is refused
/// A frame that says it is longer is no frame.
constexpr std::size_t kServiceFrameMax = std::size_t{1} << 30;

/// How far a response can be relied on.
enum class AnswerQuality : std::uint8_t {
  kPreliminary = 0,  ///< linear, on a mesh half as fine; error estimated, 1: not known
  kFinal = 1,  ///< as it will stand in the finished database, but for its stated error
};

/// The service's first message to everybody who joins.
struct ServedScene {
  JobDescription plan;                  ///< body, normals, tools, budget
  std::vector<std::int32_t> reachable;  ///< vertices that get a response, ascending
  std::string output;      ///< absolute path of the database when all is done
  bool nonlinear = false;  ///< final answers are; preliminary ones are linear
  /// [Pa] >= 0 E / (1 - nu^2) of the body's own material at small strain; 0: not
  /// stated.
  double modulus_pa = 0.0;
};

/// Responses, of one tool or several. A later answer of the same or better quality for
/// a node replaces an earlier one; one of lower quality is old news.
struct ServedResponses {
  AnswerQuality quality = AnswerQuality::kPreliminary;
  std::vector<WorkUnitNode> node;
};

/// How far the service is; whenever something changed, and at least once a second.
struct ServedProgress {
  std::string stage =
      {};  ///< one or two words: "mesh", "preliminary answers", "final answers"
  std::int64_t nodes = 0;     ///< reachable vertices times tools
  std::int64_t answered = 0;  ///< of them with an answer
  std::int64_t finished = 0;  ///< of them with a final answer
};

/// The service's last message.
struct ServedEnd {
  std::string file = {};     ///< the database, complete; empty if there is none
  std::string failure = {};  ///< why there is none, one line; else empty
};

/// The runtime's only message: where its hand is. The service answers what is nearest
/// to the path ahead first. As often as the hand's place changes, at most 20 a second.
struct HandPlace {
  std::int32_t tool = 0;  ///< index
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_m_per_s = Eigen::Vector3d::Zero();
  bool touches = false;
};

using ServiceMessage =
    std::variant<ServedScene, ServedResponses, ServedProgress, ServedEnd, HandPlace>;

/// A message as the frame that goes over the socket. The frame has 4 bytes "PLPS", the
/// length of the rest as 4 bytes, little endian, then CBOR (RFC 8949).
[[nodiscard]] std::vector<std::byte> to_frame(const ServiceMessage& message);

/// The message of a frame's CBOR: without its head.
/// @throws FormatError if it is none, of another version, or breaks a rule. Rules are
/// broken by indices that the fields do not have, numbers that are not finite, and a
/// response that broken_rule() finds broken.
[[nodiscard]] ServiceMessage message_from_bytes(std::span<const std::byte> body);

/// Cuts what arrives into frames. Not thread-safe.
class FrameReader {
 public:
  /// Takes bytes as they come. @throws FormatError as soon as they can be no frame.
  void take(std::span<const std::byte> bytes);

  /// The next whole frame's CBOR, once; empty if there is none yet.
  [[nodiscard]] std::vector<std::byte> next();

 private:
  [[nodiscard]] std::size_t length() const;  // of the CBOR, once the head is there

  std::vector<std::byte> waiting_;
};

}  // namespace palpate
