#include "formats/stored/stored_reader.h"

#include <algorithm>
#include <optional>

#include <fmt/ranges.h>

namespace palpate {
namespace {

// Of a text that is padded with them.
std::string without_nulls(std::string text) {
  text.erase(text.find_last_not_of('\0') + 1);
  return text;
}

bool matches(const StoredShape& shape, const StoredShape& wanted) {
  return std::equal(shape.begin(), shape.end(), wanted.begin(), wanted.end(),
                    [](std::int64_t is, std::int64_t must) {
                      return is >= 0 && (must < 0 || is == must);
                    });
}

std::string claim_text(const StoredClaim& claim) {
  return claim.scalar   ? "a scalar"
         : !claim.array ? "no array"
                        : fmt::format("({})", fmt::join(claim.extent, " x "));
}

std::string shape_text(const StoredShape& wanted) {
  std::string text;
  for (const std::int64_t size : wanted) {
    text += text.empty() ? "rows" : size < 0 ? " x any" : fmt::format(" x {}", size);
  }
  return "(" + text + ")";
}

}  // namespace

void StoredReader::fail_of_memory(const std::string& path,
                                  const StoredShape& shape) const {
  fail(fmt::format("dataset {} of {} values is more than the memory holds", path,
                   fmt::join(shape, " x ")));
}

bool StoredReader::has(const std::string& path) const {
  if (kept_.contains(path)) {
    return true;
  }
  const StoredLink link = file_->link_at(path);
  if (link == StoredLink::kElsewhere) {
    fail(fmt::format("{} is behind a soft or external link, must be in the file itself",
                     path));
  }
  return link == StoredLink::kObject;
}

bool StoredReader::has_attribute(const std::string& object, const char* name) const {
  return has(object) && file_->has_attribute(object, name);
}

void StoredReader::group(const std::string& path) const {
  if (!has(path)) {
    fail(fmt::format("group {} is missing", path));
  }
  file_->require_group(path);
}

void StoredReader::require_attribute(const std::string& object,
                                     const char* name) const {
  if (!has_attribute(object, name)) {
    fail(fmt::format("attribute {}@{} is missing", object, name));
  }
}

void StoredReader::require_dataset(const std::string& path) const {
  if (!has(path)) {
    fail(fmt::format("dataset {} is missing", path));
  }
}

std::string StoredReader::remark(const std::string& object, const char* name) const {
  require_attribute(object, name);
  std::optional<std::string> value = file_->text_attribute(object, name);
  if (!value) {
    fail(fmt::format("attribute {}@{} is not a fixed-length text", object, name));
  }
  return without_nulls(std::move(*value));
}

void StoredReader::attribute(const std::string& object, const char* name,
                             std::string& value) {
  value = remark(object, name);
  digest_.add_text(object + "@" + name, value);
}

template <typename T>
void StoredReader::read_number(const std::string& object, const char* name,
                               T& value) const {
  require_attribute(object, name);
  if (!file_->number_attribute(object, name, stored_type<T>(), &value)) {
    fail(fmt::format("attribute {}@{} has the wrong type, must be one {}", object, name,
                     name_of(stored_type<T>())));
  }
}

void StoredReader::attribute(const std::string& object, const char* name,
                             double& value) {
  read_number(object, name, value);
  digest_.add_number(object + "@" + name, StoredType::kFloat64, &value);
}

void StoredReader::attribute(const std::string& object, const char* name,
                             std::int64_t& value) {
  read_number(object, name, value);
  digest_.add_number(object + "@" + name, StoredType::kInt64, &value);
}

std::int64_t StoredReader::remark_number(const std::string& object,
                                         const char* name) const {
  std::int64_t value = 0;
  read_number(object, name, value);
  return value;
}

void StoredReader::text(const std::string& path, std::string& value) {
  require_dataset(path);
  std::optional<std::string> found = file_->text(path);
  if (!found) {
    fail(fmt::format("dataset {} is not one fixed-length text", path));
  }
  value = without_nulls(std::move(*found));
  digest_.add_text(path, value);
}

StoredReader::Kept& StoredReader::kept(const std::string& path) const {
  if (const auto known = kept_.find(path); known != kept_.end()) {
    return known->second;
  }
  require_dataset(path);
  return kept_.emplace(path, Kept{.dataset = file_->dataset(path)}).first->second;
}

StoredReader::Checked StoredReader::checked(const std::string& path, const char* units,
                                            StoredType type,
                                            const StoredShape& wanted) const {
  Kept& opened = kept(path);
  const StoredClaim& claim = opened.dataset->claim();
  if (claim.type != type) {
    fail(fmt::format("dataset {} has the wrong element type, must be {}", path,
                     name_of(type)));
  }
  const StoredShape shape(claim.extent.begin(), claim.extent.end());
  if (!claim.array || !matches(shape, wanted)) {
    fail(fmt::format("dataset {} has the shape {}, must be {}", path, claim_text(claim),
                     shape_text(wanted)));
  }
  if (!opened.whole) {
    opened.dataset->require_bytes();
    opened.whole = true;
  }
  if (opened.units != units) {
    const std::string found = remark(path, "units");
    if (found != units) {
      fail(fmt::format("dataset {} has the units \"{}\", must be \"{}\"", path, found,
                       units));
    }
    opened.units = found;
  }
  return {*opened.dataset, type, shape};
}

void StoredReader::read(const std::string& path, const Checked& found, void* to,
                        bool digested) {
  if (values_in(found.shape) > 0) {
    found.dataset.read(0, found.shape.front(), to);
  }
  if (digested) {
    digest_.add_dataset(path, found.type, found.shape, to);
  }
}

void StoredReader::rows(const std::string& path, const char* units, StoredType type,
                        std::int64_t begin, std::int64_t count, std::int64_t columns,
                        void* to) const {
  const Checked found = checked(
      path, units, type, columns == 0 ? StoredShape{-1} : StoredShape{-1, columns});
  if (begin < 0 || count < 0 || begin > found.shape.front() - count) {
    fail(fmt::format("dataset {} has {} rows, the index asks for {} from {}", path,
                     found.shape.front(), count, begin));
  }
  if (count > 0) {
    found.dataset.read(begin, count, to);
  }
}

StoredType StoredReader::type_of(const std::string& path) const {
  const StoredClaim& claim = kept(path).dataset->claim();
  if (!claim.type) {
    fail(fmt::format("dataset {} has an unknown element type", path));
  }
  return *claim.type;
}

void StoredReader::link(const std::string& path, const std::string& object) const {
  if (!has(path) || !file_->same_object(path, object)) {
    fail(fmt::format("{} is not a link to {}", path, object));
  }
}

void StoredReader::vtk_header(const std::string& group) const {
  if (!file_->has_vtk_header(group)) {
    fail(fmt::format("{} has not the type UnstructuredGrid and the version 1.0 of VTK",
                     group));
  }
}

}  // namespace palpate
