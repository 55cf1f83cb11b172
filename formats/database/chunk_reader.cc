#include "formats/database/chunk_reader.h"

#include <algorithm>
#include <mutex>
#include <optional>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/database/chunk_digest.h"
#include "formats/database/compliance_rules.h"
#include "formats/database/contact_rules.h"
#include "formats/database/database_check_optional.h"
#include "formats/database/database_layout.h"
#include "formats/database/database_rules.h"
#include "formats/database/index_layout.h"
#include "formats/database/puncture_layout.h"
#include "formats/database/puncture_rules.h"
#include "formats/database/viscoelasticity_reader.h"
#include "formats/database/viscoelasticity_rules.h"

namespace palpate {
namespace {

// A file of the kind that the templates of database_layout.h fill from, that gives
// the rows of one chunk.
class RowsOfChunk {
 public:
  static constexpr bool kWrites = false;

  RowsOfChunk(const StoredReader& file, std::int64_t node_begin, std::int64_t nodes,
              std::int64_t sample_begin, std::int64_t samples)
      : file_(file),
        node_begin_(node_begin),
        nodes_(nodes),
        sample_begin_(sample_begin),
        samples_(samples) {}

  template <typename T>
  void dataset(const std::string& path, const char* units, std::vector<T>& values) {
    values.resize(static_cast<std::size_t>(nodes_));
    file_.rows(path, units, stored_type<T>(), node_begin_, nodes_, 0, values.data());
  }
  template <typename T>
  void dataset(const std::string& path, const char* units, RowMajor3<T>& values) {
    values.resize(nodes_, 3);
    file_.rows(path, units, stored_type<T>(), node_begin_, nodes_, 3, values.data());
  }

  // Counted from the chunk's first sample.
  void begins(const std::string& path, std::vector<std::int64_t>& values) {
    values.resize(static_cast<std::size_t>(nodes_) + 1);
    file_.rows(path, "1", StoredType::kInt64, node_begin_, nodes_ + 1, 0,
               values.data());
    for (std::int64_t& value : values) {
      value -= sample_begin_;
    }
  }
  void samples(const std::string& path, const char* units,
               std::vector<double>& values) {
    values.resize(static_cast<std::size_t>(samples_));
    file_.rows(path, units, StoredType::kFloat64, sample_begin_, samples_, 0,
               values.data());
  }
  void reals(const std::string& path, const char* units, std::vector<double>& values,
             const std::vector<std::int64_t>& begin) {
    values.resize(static_cast<std::size_t>(samples_));
    file_.rows_as_reals(path, units, sample_begin_, node_begin_, begin, values);
  }
  [[nodiscard]] bool keeps_slopes(const std::string& path) const {
    return file_.has(path);
  }
  void flags(const std::string&, const std::vector<std::uint8_t>&, const char*,
             bool) const {}
  void digest_only(const std::string&, const std::vector<double>&) const {}

 private:
  const StoredReader& file_;
  std::int64_t node_begin_;
  std::int64_t nodes_;
  std::int64_t sample_begin_;
  std::int64_t samples_;
};

// Begins rise from 0; where the last is known, to it.
void check_begins(const StoredReader& file, const std::string& path,
                  const std::vector<std::int64_t>& begin, std::size_t chunks,
                  std::int64_t last = -1) {
  if (begin.size() != chunks + 1 || begin.front() != 0 ||
      !std::is_sorted(begin.begin(), begin.end()) ||
      (last >= 0 && begin.back() != last)) {
    file.fail(fmt::format("dataset {} must rise from 0 in {} rows", path, chunks + 1));
  }
}

// The begins end where the rows of a dataset do: memory is asked for by them.
void check_end(const StoredReader& file, const std::string& index,
               const std::vector<std::int64_t>& begin, const std::string& path,
               const char* units, const StoredShape& wanted) {
  const std::int64_t rows =
      file.shape_of(path, units, file.type_of(path), wanted).front();
  if (begin.back() != rows) {
    file.fail(fmt::format("dataset {} ends at {}, must end at the {} rows of {}", index,
                          begin.back(), rows, path));
  }
}

void expect_rows(const StoredReader& file, const std::string& path, std::int64_t rows,
                 std::int64_t wanted) {
  if (rows != wanted) {
    file.fail(fmt::format("dataset {} has {} rows, must have {}", path, rows, wanted));
  }
}

// Digests of a tool's optional parts, and bounds of their shares.
void check_optional_index(const StoredReader& file, const std::string& tool_group,
                          const ToolIndex& tool, std::int64_t chunks) {
  const std::string group = tool_group + "/index";
  const std::int64_t digests = chunks * std::int64_t{kSha256Bytes};
  const bool own_shares =
      !tool.viscoelasticity.empty() && tool.viscoelasticity.g.rows() == 0;
  const bool remembers = own_shares || tool.yielding_rows || tool.memory_sites > 0;
  expect_rows(file, group + "/memory_sha256", tool.memory_sha256.size(),
              remembers ? digests : 0);
  expect_rows(file, group + "/tilt_sha256", tool.tilt_sha256.size(),
              file.has(tool_group + "/tilt") ? digests : 0);
  expect_rows(file, group + "/compliance_sha256", tool.compliance_sha256.size(),
              tool.compliance.empty() ? 0 : digests);
  expect_rows(file, group + "/contact_sha256", tool.contact_sha256.size(),
              tool.has_pressure || tool.has_lateral ? digests : 0);
  for (const auto* values : {&tool.share_min, &tool.share_max}) {
    expect_rows(file, group + "/share_min, share_max", values->size(),
                own_shares ? chunks * (tool.viscoelasticity.terms() + 1) : 0);
  }
}

void check_index(const StoredReader& file, const DatabaseIndex& index) {
  const std::size_t chunks = index.node_begin.empty() ? 0 : index.node_begin.size() - 1;
  check_begins(file, "/index/node_begin", index.node_begin, chunks);
  check_begins(file, "/index/triangle_begin", index.triangle_begin, chunks);
  check_end(file, "/index/node_begin", index.node_begin, "/body/position_m", "m",
            {-1, 3});
  check_end(file, "/index/triangle_begin", index.triangle_begin, "/body/triangle", "1",
            {-1, 3});
  // Chunks but the last are full, so that a node's number gives its chunk.
  for (std::size_t k = 0; k < chunks; ++k) {
    const std::int64_t size = index.node_begin[k + 1] - index.node_begin[k];
    if (size < 1 || size > index.storage.chunk_nodes ||
        (k + 1 < chunks && size != index.storage.chunk_nodes)) {
      file.fail(
          fmt::format("dataset /index/node_begin: chunk {} has {} nodes, must have {}",
                      k, size, index.storage.chunk_nodes));
    }
  }
  const auto c = static_cast<std::int64_t>(chunks);
  expect_rows(file, "/index/box_min_m", index.box_min_m.rows(), c);
  expect_rows(file, "/index/box_max_m", index.box_max_m.rows(), c);
  expect_rows(file, "/index/sha256", index.sha256.size(),
              c * std::int64_t{kSha256Bytes});
  for (const ToolIndex& tool : index.tools) {
    const std::string tool_group = "/tools/" + tool.tool.name;
    const std::string group = tool_group + "/index";
    check_begins(file, group + "/sample_begin", tool.sample_begin, chunks);
    check_end(file, group + "/sample_begin", tool.sample_begin, tool_group + "/depth_m",
              "m", {-1});
    expect_rows(file, group + "/sha256", tool.sha256.size(),
                c * std::int64_t{kSha256Bytes});
    // Bounds of the samples, one a chunk.
    for (const auto* values :
         {&tool.depth_max_m, &tool.force_max_n, &tool.stiffness_max_n_per_m,
          &tool.error_relative_max, &tool.direction_spread_max_rad}) {
      expect_rows(file, group, static_cast<std::int64_t>(values->size()), c);
    }
    expect_rows(file, group + "/origin_count", std::ssize(tool.origin_count), 4);
    expect_rows(
        file, group + "/flag_count", std::ssize(tool.flag_count),
        tool.flag_count.size() == kResponseFlags ? kResponseFlags : kResponseFlags - 1);
    check_relaxation(tool_group + "/relaxation", tool.relaxation, index.nodes());
    check_optional_index(file, tool_group, tool, c);
  }
}

void read_compliance_head(StoredReader& file, const DatabaseIndex& index,
                          ToolIndex& tool) {
  const std::string group = content::compliance_group("/tools/" + tool.tool.name);
  if (!file.has(group)) {
    return;
  }
  content::exchange_compliance_head(file, group, tool.compliance);
  check_compliance_head("/tools/" + tool.tool.name, tool.compliance);
  const auto knots = static_cast<std::int64_t>(tool.compliance.knots());
  static_cast<void>(
      file.shape_of(group + "/value", content::kComplianceUnits, StoredType::kFloat32,
                    {index.node_begin.empty() ? 0 : index.nodes(), knots}));
  tool.compliance.value.resize(0, knots);
  if (file.has(group + "/mode")) {
    tool.compliance.mode.resize(
        0, file.shape_of(group + "/mode", content::kModeUnits, StoredType::kFloat32,
                         {index.node_begin.empty() ? 0 : index.nodes(), -1})
               .back());
  }
}

void verify(const StoredReader& file, const Sha256Rows& stored, std::int64_t chunk,
            const std::vector<std::uint8_t>& found, const std::string& what) {
  if (!std::equal(found.begin(), found.end(), stored.row(chunk).data())) {
    file.fail(fmt::format("{}: chunk {} is damaged: its SHA-256 is not the index's",
                          what, chunk));
  }
}

// Rules name a dataset and a row; who reads them must know the file, too.
template <typename Rules>
void by_the_rules(const StoredReader& file, const Rules& check_rules) {
  try {
    check_rules();
  } catch (const FormatError& error) {
    file.fail(error.what());
  }
}

void read_puncture(StoredReader& file, std::int64_t nodes, ToolIndex& tool) {
  const std::string group = "/tools/" + tool.tool.name;
  content::exchange_puncture(file, group, tool.puncture);
  by_the_rules(file, [&] {
    check_puncture(group, tool.puncture, nodes);
  });
  expect_rows(file, group + "/index/puncture_sha256", tool.puncture_sha256.size(),
              tool.puncture.empty() ? 0 : std::int64_t{kSha256Bytes});
  if (!tool.puncture.empty()) {
    verify(file, tool.puncture_sha256, 0, puncture_digest(tool.puncture),
           group + "/puncture");
  }
}

DatabaseIndex index_of(StoredReader& file) {
  DatabaseIndex index;
  content::read_version(file);
  file.attribute("/", "writer", index.provenance.writer);
  content::exchange_source(file, index.provenance);
  content::exchange_storage(file, index.storage);
  for (const std::string& tool : content::read_tool_names(file)) {
    ToolIndex& entry = index.tools.emplace_back();
    entry.tool.name = tool;
    content::exchange_shape(file, "/tools/" + tool, entry.tool);
    content::exchange_relaxation(file, "/tools/" + tool + "/relaxation",
                                 entry.relaxation);
    content::exchange_accuracy(file, "/tools/" + tool + "/accuracy", entry.accuracy);
  }
  content::ReadIndex access{file};
  content::exchange_index(access, index);
  const std::int64_t nodes = index.node_begin.empty() ? 0 : index.nodes();
  for (ToolIndex& entry : index.tools) {
    read_viscoelasticity_head(file, "/tools/" + entry.tool.name, nodes, entry);
    read_compliance_head(file, index, entry);
    read_puncture(file, nodes, entry);
    entry.has_pressure = file.has("/tools/" + entry.tool.name + "/pressure");
    entry.has_lateral = file.has("/tools/" + entry.tool.name + "/lateral");
  }
  check_index(file, index);
  if (file.remark("/index", "index_sha256") != index_digest(index)) {
    file.fail("the index is damaged: its SHA-256 is not the one it states");
  }
  if (file.has("/measurement")) {
    index.measured_samples =
        file.shape_of("/measurement/depth_m", "m", StoredType::kFloat64, {-1}).front();
  }
  index.bytes = file.file().bytes();
  return index;
}

}  // namespace

class ChunkReader::File {
 public:
  explicit File(const StoredSource& source) : reader(open_stored(source)) {}
  [[nodiscard]] std::recursive_mutex& mutex() const { return reader.file().mutex(); }
  StoredReader reader;
  std::optional<SourceNames> names;
};

ChunkReader::ChunkReader(const StoredSource& file)
    : file_(std::make_unique<File>(file)) {
  index_ = index_of(file_->reader);
  file_->names.emplace(index_);
}

ChunkReader::~ChunkReader() = default;

BodyChunk ChunkReader::body(std::int64_t chunk) const {
  const std::lock_guard lock(file_->mutex());
  const auto k = static_cast<std::size_t>(chunk);
  const StoredReader& file = file_->reader;
  const std::int64_t node = index_.node_begin.at(k);
  const std::int64_t triangle = index_.triangle_begin.at(k);
  RowsOfChunk nodes(file, node, index_.node_begin.at(k + 1) - node, 0, 0);
  RowsOfChunk triangles(file, triangle, index_.triangle_begin.at(k + 1) - triangle, 0,
                        0);
  BodyChunk part;
  part.node_begin = node;
  nodes.dataset("/body/position_m", "m", part.position_m);
  nodes.dataset("/body/normal", "1", part.normal);
  nodes.dataset("/body/source_node", "1", part.source_node);
  triangles.dataset("/body/triangle", "1", part.triangle);
  triangles.dataset("/body/source_triangle", "1", part.source_triangle);
  // Damage is found before the rules: a broken rule is then the writer's fault.
  verify(file, index_.sha256, chunk, chunk_digest(part), "/body");
  by_the_rules(file, [&] {
    check_nodes(part.position_m, part.normal, node);
    check_triangles(part.triangle, index_.nodes(), triangle);
    check_chunk(index_, chunk, part);
    file_->names->add(chunk, part);
  });
  return part;
}

ResponseTable ChunkReader::responses(std::size_t tool, std::int64_t chunk) const {
  const std::lock_guard lock(file_->mutex());
  const auto k = static_cast<std::size_t>(chunk);
  const ToolIndex& entry = index_.tools.at(tool);
  const std::int64_t node = index_.node_begin.at(k);
  const std::int64_t sample = entry.sample_begin.at(k);
  RowsOfChunk rows(file_->reader, node, index_.node_begin.at(k + 1) - node, sample,
                   entry.sample_begin.at(k + 1) - sample);
  const std::string group = "/tools/" + entry.tool.name;
  ResponseTable part;
  part.tool = entry.tool;
  part.viscoelasticity = entry.viscoelasticity;
  // A node's row says where its samples begin, counted from those of the chunk.
  content::exchange_nodes(rows, group, part);
  check_begins(file_->reader, group + "/sample_begin", part.sample_begin,
               static_cast<std::size_t>(part.nodes()),
               entry.sample_begin.at(k + 1) - sample);
  content::exchange_samples(rows, group, part);
  verify(file_->reader, entry.sha256, chunk, chunk_digest(part), group);
  by_the_rules(file_->reader, [&] {
    check_responses(group, part, node);
    check_chunk(entry, chunk, part);
  });
  // Optional parts have digests of their own.
  if (entry.tilt_sha256.rows() > 0) {
    content::exchange_tilts(rows, group, part);
    verify(file_->reader, entry.tilt_sha256, chunk, tilt_digest(part), group + "/tilt");
  }
  if (entry.memory_sha256.rows() > 0) {
    read_node_rows(file_->reader, group, entry, node, part.nodes(),
                   part.viscoelasticity);
    verify(file_->reader, entry.memory_sha256, chunk,
           memory_digest(part.viscoelasticity), group + "/memory");
    by_the_rules(file_->reader, [&] {
      check_node_rows(group, part.viscoelasticity, part.nodes(), entry.memory_sites,
                      node);
      check_yielding(group, part.viscoelasticity.yielding, part.nodes(), node);
      check_shares(entry, chunk, part.viscoelasticity);
    });
  }
  if (entry.contact_sha256.rows() > 0) {
    content::read_contact_rows(file_->reader, group, node, part.nodes(), part.contact);
    verify(file_->reader, entry.contact_sha256, chunk, contact_digest(part.contact),
           group + "/pressure, lateral");
    by_the_rules(file_->reader, [&] {
      check_contact(group, part.contact, part.nodes(), node);
    });
  }
  part.compliance = compliance(tool, chunk);
  part.puncture = rows_of(entry.puncture, node, part.nodes());
  return part;
}

ComplianceTable ChunkReader::compliance(std::size_t tool, std::int64_t chunk) const {
  const std::lock_guard lock(file_->mutex());
  const auto k = static_cast<std::size_t>(chunk);
  const ToolIndex& entry = index_.tools.at(tool);
  ComplianceTable part;
  if (entry.compliance.empty()) {
    return part;
  }
  const std::int64_t node = index_.node_begin.at(k);
  const std::int64_t nodes = index_.node_begin.at(k + 1) - node;
  const std::string group = "/tools/" + entry.tool.name;
  const std::string path = content::compliance_group(group);
  content::read_compliance_rows(file_->reader, path, node, nodes, entry.compliance,
                                part);
  verify(file_->reader, entry.compliance_sha256, chunk, compliance_digest(part), path);
  by_the_rules(file_->reader, [&] {
    check_compliance_rows(group, part, nodes, node);
  });
  return part;
}

DatabaseIndex read_index(const StoredSource& file) {
  StoredReader reader(open_stored(file));
  return index_of(reader);
}

}  // namespace palpate
