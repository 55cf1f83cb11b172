#include <cstring>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "formats/flat/flat_directory.h"
#include "formats/flat/flat_file.h"

namespace palpate {
namespace {

class FlatSink final : public StoredSink {
 public:
  FlatSink() : image_(kFlatFirstOffset) { group("/"); }

  void group(const std::string& path) override { add(path, {}); }

  void text_attribute(const std::string& object, const char* name,
                      std::string_view value) override {
    attribute(object, name, FlatKind::kText, value);
  }
  void number_attribute(const std::string& object, const char* name, StoredType type,
                        const void* value) override {
    attribute(object, name, flat_kind(type),
              {static_cast<const char*>(value), bytes_of(type)});
  }
  void bytes_attribute(const std::string& object, const char* name,
                       std::span<const std::uint8_t> values) override {
    attribute(object, name, flat_kind(StoredType::kUint8),
              {reinterpret_cast<const char*>(values.data()), values.size()});
  }
  void text(const std::string& path, std::string_view value) override {
    add(path, {.kind = FlatKind::kText, .extent = {value.size()}},
        std::as_bytes(std::span(value)));
  }
  void dataset(const std::string& path, StoredType type, const StoredShape& shape,
               const void* data) override {
    add(path, {.kind = flat_kind(type), .extent = {shape.begin(), shape.end()}},
        {static_cast<const std::byte*>(data), values_in(shape) * bytes_of(type)});
  }

  [[nodiscard]] std::span<const std::byte> image() override;

 private:
  // Bytes follow those of the object before, at the next multiple of the alignment.
  void add(const std::string& path, FlatObject object,
           std::span<const std::byte> data = {}) {
    if (object.kind != FlatKind::kGroup) {
      image_.resize(flat_aligned(image_.size()));
      object.offset = image_.size();
      image_.insert(image_.end(), data.begin(), data.end());
    }
    objects_.emplace_back(path, std::move(object));
  }
  void attribute(const std::string& path, const char* name, FlatKind kind,
                 std::string_view value);

  std::vector<std::byte> image_;
  std::vector<std::pair<std::string, FlatObject>> objects_;  // as they were made
};

void FlatSink::attribute(const std::string& path, const char* name, FlatKind kind,
                         std::string_view value) {
  // Most attributes are of the latest object.
  for (auto object = objects_.rbegin(); object != objects_.rend(); ++object) {
    if (object->first == path) {
      object->second.attributes[name] = {kind, std::string(value)};
      return;
    }
  }
  throw std::logic_error(fmt::format("{} has no object for @{}", path, name));
}

std::span<const std::byte> FlatSink::image() {
  std::string directory;
  for (const auto& [path, object] : objects_) {
    directory += flat_entry(path, object);
  }
  const std::uint64_t begin = flat_aligned(image_.size());
  FlatHeader header{.objects = static_cast<std::uint32_t>(objects_.size()),
                    .bytes = begin + directory.size(),
                    .directory = begin};
  header.sha256 = flat_sha256(header, directory);
  image_.resize(header.bytes);
  std::memcpy(image_.data() + begin, directory.data(), directory.size());
  const std::string head = flat_header(header);
  std::memcpy(image_.data(), head.data(), head.size());
  return image_;
}

}  // namespace

std::unique_ptr<StoredSink> make_flat_sink() {
  return std::make_unique<FlatSink>();
}

}  // namespace palpate
