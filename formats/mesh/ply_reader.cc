#include "formats/mesh/ply_reader.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/mesh/ply_header.h"

namespace palpate {
namespace {

static_assert(std::endian::native == std::endian::little);

// The numbers of the data one after the other. Every PLY type is exact in a double.
class Values {
 public:
  Values(std::string_view bytes, PlyEncoding encoding)
      : bytes_(bytes), encoding_(encoding) {}

  // False at the end of the file, and where a text is no number.
  [[nodiscard]] bool next(PlyType type, double& value) {
    return encoding_ == PlyEncoding::kText ? next_text(value) : next_raw(type, value);
  }
  [[nodiscard]] std::size_t bytes_left() const { return bytes_.size(); }

 private:
  bool next_text(double& value) {
    constexpr std::string_view kBlank = " \t\r\n";
    bytes_.remove_prefix(std::min(bytes_.find_first_not_of(kBlank), bytes_.size()));
    std::string_view word = bytes_.substr(0, bytes_.find_first_of(kBlank));
    bytes_.remove_prefix(word.size());
    word.remove_prefix(word.starts_with('+') ? 1 : 0);
    const char* end = word.data() + word.size();
    const auto [after, error] = std::from_chars(word.data(), end, value);
    return error == std::errc() && after == end;
  }

  template <typename T>
  static double as(const char* raw) {
    T value{};
    std::memcpy(&value, raw, sizeof value);
    return static_cast<double>(value);
  }

  bool next_raw(PlyType type, double& value) {
    const std::size_t size = bytes_of(type);
    if (bytes_.size() < size) {
      return false;
    }
    char raw[8];
    std::copy_n(bytes_.data(), size, raw);
    if (encoding_ == PlyEncoding::kBigEndian) {
      std::reverse(raw, raw + size);
    }
    bytes_.remove_prefix(size);
    value = number(type, raw);
    return true;
  }

  static double number(PlyType type, const char* raw) {
    switch (type) {
      case PlyType::kInt8:
        return as<std::int8_t>(raw);
      case PlyType::kUint8:
        return as<std::uint8_t>(raw);
      case PlyType::kInt16:
        return as<std::int16_t>(raw);
      case PlyType::kUint16:
        return as<std::uint16_t>(raw);
      case PlyType::kInt32:
        return as<std::int32_t>(raw);
      case PlyType::kUint32:
        return as<std::uint32_t>(raw);
      case PlyType::kFloat32:
        return as<float>(raw);
      case PlyType::kFloat64:
        break;
    }
    return as<double>(raw);
  }

  std::string_view bytes_;
  PlyEncoding encoding_;
};

// One element's rows, which a message can name.
struct Row {
  const PlyElement& element;
  std::uint64_t number;

  [[noreturn]] void fail(const std::string& what) const {
    throw FormatError(
        fmt::format("{} {} of {} {}", element.name, number + 1, element.count, what));
  }
};

double read_value(Values& values, PlyType type, const Row& row) {
  double value = 0.0;
  if (!values.next(type, value)) {
    row.fail(values.bytes_left() == 0 ? "is cut short" : "is cut short or no number");
  }
  return value;
}

std::uint64_t read_length(Values& values, const PlyProperty& property, const Row& row) {
  const double length = read_value(values, property.count_type, row);
  if (!(length >= 0.0 && length <= static_cast<double>(values.bytes_left()) &&
        length == std::floor(length))) {
    row.fail(fmt::format("has a list {} of {} values, more than are left or no count",
                         property.name, length));
  }
  return static_cast<std::uint64_t>(length);
}

std::size_t to_index(double value, const Row& row) {
  constexpr double kLargest = 0x1p53;
  if (!(value >= 0.0 && value < kLargest && value == std::floor(value))) {
    row.fail(fmt::format("has the corner {}, must be an index from 0", value));
  }
  return static_cast<std::size_t>(value);
}

bool is_corner_list(const PlyProperty& property) {
  return property.is_list && is_integer(property.type) &&
         (property.name == "vertex_indices" || property.name == "vertex_index");
}

// Calls use(property, value) with every value of a row.
template <typename Use>
void read_row(Values& values, const Row& row, const Use& use) {
  for (const PlyProperty& property : row.element.property) {
    const std::uint64_t length =
        property.is_list ? read_length(values, property, row) : 1;
    for (std::uint64_t i = 0; i < length; ++i) {
      use(property, read_value(values, property.type, row));
    }
  }
}

// 0, 1, 2 for x, y, z; -1 for others.
int axis_of(const PlyProperty& property) {
  const bool is_axis = !property.is_list && property.name.size() == 1 &&
                       property.name[0] >= 'x' && property.name[0] <= 'z';
  return is_axis ? property.name[0] - 'x' : -1;
}

Eigen::Vector3d read_vertex(Values& values, const Row& row) {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  read_row(values, row, [&](const PlyProperty& property, double value) {
    if (axis_of(property) >= 0) {
      point[axis_of(property)] = value;
    }
  });
  return point;
}

std::vector<std::size_t> read_ply_face(Values& values, const Row& row) {
  std::vector<std::size_t> corner;
  read_row(values, row, [&](const PlyProperty& property, double value) {
    if (is_corner_list(property)) {
      corner.push_back(to_index(value, row));
    }
  });
  return corner;
}

void require_body(const PlyHeader& header) {
  bool has_faces = false;
  std::ptrdiff_t coordinates = 0;
  for (const PlyElement& element : header.element) {
    for (const PlyProperty& property : element.property) {
      has_faces = has_faces || (element.name == "face" && is_corner_list(property));
      coordinates += element.name == "vertex" && axis_of(property) >= 0 ? 1 : 0;
    }
  }
  if (coordinates != 3) {
    throw FormatError(fmt::format(
        "{} of the vertex properties x, y and z, need each once", coordinates));
  }
  if (!has_faces) {
    throw FormatError(
        "no faces: they need a list vertex_indices of integers (triangle strips are "
        "not read)");
  }
}

}  // namespace

PolygonSoup read_ply(std::string_view bytes) {
  const PlyHeader header = read_ply_header(bytes);
  require_body(header);
  Values values(bytes.substr(header.bytes), header.encoding);
  PolygonSoup soup;
  for (const PlyElement& element : header.element) {
    for (std::uint64_t i = 0; i < element.count; ++i) {
      const Row row{element, i};
      if (element.name == "vertex") {
        soup.point.push_back(read_vertex(values, row));
      } else if (element.name == "face") {
        soup.face.push_back(read_ply_face(values, row));
      } else {
        read_row(values, row, [](const PlyProperty&, double) {});
      }
    }
  }
  return soup;
}

}  // namespace palpate
