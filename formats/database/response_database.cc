#include "formats/database/response_database.h"

#include <fmt/format.h>

#include "formats/base/atomic_file.h"
#include "formats/base/error.h"
#include "formats/database/database_index.h"
#include "formats/database/database_layout.h"
#include "formats/database/database_rules.h"
#include "formats/database/index_layout.h"
#include "formats/database/rounded_database.h"
#include "formats/database/select_nodes.h"

namespace palpate {
namespace {

// Tool names in the order of the database: groups themselves are not ordered.
std::string join_names(const std::vector<ResponseTable>& tools) {
  std::vector<std::string> names;
  names.reserve(tools.size());
  for (const ResponseTable& table : tools) {
    names.push_back(table.tool.name);
  }
  return join_lines(names);
}

// As a file of its storage.precision has it.
ResponseDatabase checked(const ResponseDatabase& database) {
  check(database);
  ResponseDatabase precise = rounded(database);
  check(precise);
  return precise;
}

void write_all(const ResponseDatabase& database, StoredWriter& out) {
  // Neighbours on the surface lie near one another in the file, so that a chunk is a
  // patch.
  const StorageOrder order = storage_order(database.body);
  const ResponseDatabase ordered = select_nodes(database, order.node, order.triangle);
  const DatabaseIndex index = make_index(ordered, order);
  out.attribute("/", "format", std::string(content::kFormatName));
  out.attribute("/", "format_version", std::int64_t{kDatabaseVersion});
  out.attribute("/", "format_version_minor", std::int64_t{kDatabaseVersionMinor});
  out.attribute("/", "writer", database.provenance.writer);
  content::exchange_rest(out, ordered, order);
  out.group("/tools");
  out.attribute("/tools", "names", join_names(ordered.tools));
  for (const ResponseTable& table : ordered.tools) {
    content::exchange_tool(out, "/tools/" + table.tool.name, table);
  }
  // The digest is of the content. What follows from the content is written after it.
  const std::string digest = out.digest();
  content::exchange_vtk(out, ordered);
  content::exchange_storage(out, database.storage);
  content::DerivedIndex<StoredWriter> derived{out};
  content::exchange_index(derived, index);
  out.remark("/index", "index_sha256", index_digest(index));
  out.remark("/", kDigestName, digest);
}

}  // namespace

void write_database(const std::filesystem::path& file, const ResponseDatabase& database,
                    std::optional<StoredForm> form) {
  write_unchecked(file, checked(database), form);
}

std::vector<std::byte> flat_bytes(const ResponseDatabase& database) {
  StoredWriter out = make_writer(StoredForm::kFlat, database.storage);
  write_all(checked(database), out);
  const std::span<const std::byte> image = out.image();
  return {image.begin(), image.end()};
}

void write_unchecked(const std::filesystem::path& file,
                     const ResponseDatabase& database, std::optional<StoredForm> form) {
  AtomicFile atomic(file);
  StoredWriter out = make_writer(form.value_or(form_of(file)), database.storage);
  write_all(database, out);
  atomic.write(out.image());
  atomic.commit();
}

namespace {

// What the file says of itself agrees with its content.
void check_derived(StoredReader& in, const ResponseDatabase& ordered,
                   const StorageOrder& order) {
  content::exchange_vtk(in, ordered);
  const DatabaseIndex index = make_index(ordered, order);
  content::DerivedIndex<StoredReader> derived{in};
  content::exchange_index(derived, index);
  if (in.remark("/index", "index_sha256") != index_digest(index)) {
    in.fail("attribute /index@index_sha256 is not the digest of the index");
  }
}

// Rows of the file are the source's nodes and triangles, each once.
void check_order(const StoredReader& in, const char* path,
                 const std::vector<std::int32_t>& order, std::int64_t rows) {
  std::vector<bool> seen(static_cast<std::size_t>(rows));
  for (const std::int32_t at : order) {
    if (at < 0 || at >= rows || seen[static_cast<std::size_t>(at)]) {
      in.fail(fmt::format("dataset {} holds {}, must hold each of 0 to {} once", path,
                          at, rows - 1));
    }
    seen[static_cast<std::size_t>(at)] = true;
  }
  if (std::ssize(order) != rows) {
    in.fail(
        fmt::format("dataset {} has {} rows, must have {}", path, order.size(), rows));
  }
}

ResponseDatabase read_ordered(StoredReader& in, StorageOrder& order) {
  content::read_version(in);
  ResponseDatabase database;
  in.attribute("/", "writer", database.provenance.writer);
  content::exchange_rest(in, database, order);
  for (const std::string& tool : content::read_tool_names(in)) {
    ResponseTable& table = database.tools.emplace_back();
    table.tool.name = tool;
    content::exchange_tool(in, "/tools/" + tool, table);
  }
  content::exchange_storage(in, database.storage);
  return database;
}

// The whole file, verified, in its own order. @param order filled.
ResponseDatabase read_verified(const StoredSource& file, StorageOrder& order) {
  StoredReader in(open_stored(file));
  ResponseDatabase ordered;
  // What breaks a rule says more than a digest that differs, so the rules come first.
  try {
    ordered = read_ordered(in, order);
    check(ordered);
  } catch (const FormatError& error) {
    const std::string prefix = in.file().name() + ": ";
    const std::string what = error.what();
    throw FormatError(what.rfind(prefix, 0) == 0 ? what : prefix + what);
  }
  check_order(in, "/body/source_node", order.node, ordered.body.position_m.rows());
  check_order(in, "/body/source_triangle", order.triangle,
              ordered.body.triangle.rows());
  const std::string stored = in.remark("/", kDigestName);
  if (stored != in.digest()) {
    in.fail(fmt::format(
        "content has SHA-256 {}, must be {:?} as /@{} says: the file was damaged or "
        "changed",
        in.digest(), stored.substr(0, 64), kDigestName));
  }
  check_derived(in, ordered, order);
  return ordered;
}

}  // namespace

ResponseDatabase read_in_file_order(const StoredSource& file) {
  StorageOrder order;
  return read_verified(file, order);
}

ResponseDatabase read_database(const StoredSource& file) {
  StorageOrder order;
  const ResponseDatabase ordered = read_verified(file, order);
  return select_nodes(ordered, places_of(order.node, order.node.size()),
                      places_of(order.triangle, order.triangle.size()));
}

const ResponseTable& find_tool(const ResponseDatabase& database,
                               const std::string& name) {
  std::string known;
  for (const ResponseTable& table : database.tools) {
    if (table.tool.name == name || (name.empty() && database.tools.size() == 1)) {
      return table;
    }
    known += (known.empty() ? "" : ", ") + table.tool.name;
  }
  throw InputError(name.empty()
                       ? fmt::format("a tool must be named; there are: {}", known)
                       : fmt::format("unknown tool {:?}; there are: {}", name, known));
}

std::vector<const ResponseTable*> find_tools(const ResponseDatabase& database,
                                             const std::vector<std::string>& names) {
  std::vector<const ResponseTable*> tables;
  for (const std::string& name : names) {
    tables.push_back(&find_tool(database, name));
  }
  if (tables.empty()) {
    tables.push_back(&find_tool(database, ""));
  }
  return tables;
}

}  // namespace palpate
