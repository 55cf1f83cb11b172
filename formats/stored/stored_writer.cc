#include "formats/stored/stored_writer.h"

namespace palpate {

bool StoredWriter::optional_group(const std::string& path, bool wanted) {
  if (wanted) {
    group(path);
  }
  return wanted;
}

void StoredWriter::attribute(const std::string& object, const char* name,
                             const std::string& value) {
  remark(object, name, value);
  digest_.add_text(object + "@" + name, value);
}

void StoredWriter::attribute(const std::string& object, const char* name,
                             double value) {
  sink_->number_attribute(object, name, StoredType::kFloat64, &value);
  digest_.add_number(object + "@" + name, StoredType::kFloat64, &value);
}

void StoredWriter::attribute(const std::string& object, const char* name,
                             std::int64_t value) {
  remark(object, name, value);
  digest_.add_number(object + "@" + name, StoredType::kInt64, &value);
}

void StoredWriter::remark(const std::string& object, const char* name,
                          const std::string& value) {
  sink_->text_attribute(object, name, value);
}

void StoredWriter::remark(const std::string& object, const char* name,
                          std::int64_t value) {
  sink_->number_attribute(object, name, StoredType::kInt64, &value);
}

void StoredWriter::flags(const std::string& dataset,
                         const std::vector<std::uint8_t>& values, const char* meanings,
                         bool masks) {
  sink_->bytes_attribute(dataset, "flag_values", values);
  if (masks) {
    sink_->bytes_attribute(dataset, "flag_masks", values);
  }
  sink_->text_attribute(dataset, "flag_meanings", meanings);
}

void StoredWriter::text(const std::string& path, const std::string& value) {
  sink_->text(path, value);
  digest_.add_text(path, value);
}

void StoredWriter::write(const std::string& path, const char* units, StoredType type,
                         const void* data, const StoredShape& shape, bool digested) {
  sink_->dataset(path, type, shape, data);
  sink_->text_attribute(path, "units", units);
  if (digested) {
    digest_.add_dataset(path, type, shape, data);
  }
}

}  // namespace palpate
