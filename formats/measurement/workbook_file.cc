#include "formats/measurement/workbook_file.h"

#include <algorithm>
#include <charconv>
#include <cstring>

#include <fmt/format.h>
#include <pugixml.hpp>

#include "formats/base/error.h"
#include "formats/measurement/machine_table.h"
#include "formats/measurement/zip_archive.h"

namespace palpate {
namespace {

constexpr const char* kBook = "xl/workbook.xml";
constexpr std::size_t kColumnsMax = 16384;  // of a sheet, as ECMA-376 has it

// Elements may carry a prefix of their namespace: "x:row".
bool is(const pugi::xml_node& node, const char* name) {
  const char* colon = std::strchr(node.name(), ':');
  return std::strcmp(colon == nullptr ? node.name() : colon + 1, name) == 0;
}

pugi::xml_node child(const pugi::xml_node& parent, const char* name) {
  for (const pugi::xml_node& node : parent.children()) {
    if (is(node, name)) {
      return node;
    }
  }
  return {};
}

pugi::xml_document parse(const ZipArchive& zip, const std::string& entry) {
  const std::string text = zip.read(entry);
  pugi::xml_document document;
  const auto outcome = document.load_buffer(
      text.data(), text.size(), pugi::parse_default | pugi::parse_ws_pcdata);
  if (!outcome) {
    throw FormatError(fmt::format("{}: {} is not XML: {} at byte {}", zip.file(), entry,
                                  outcome.description(), outcome.offset));
  }
  return document;
}

// All text of a cell: in one element, or in runs of different type.
std::string text_of(const pugi::xml_node& item) {
  std::string text;
  for (const pugi::xml_node& node : item.children()) {
    if (is(node, "t")) {
      text += node.text().get();
    } else if (is(node, "r")) {
      text += child(node, "t").text().get();
    }
  }
  return text;
}

struct Sheet {
  std::string name, entry;
};

// The sheets in the book's order; the relation of each names its part.
std::vector<Sheet> sheets_of(const ZipArchive& zip) {
  const pugi::xml_document book = parse(zip, kBook);
  const pugi::xml_document relations = parse(zip, "xl/_rels/workbook.xml.rels");
  std::vector<Sheet> sheets;
  for (const pugi::xml_node& sheet :
       child(child(book, "workbook"), "sheets").children()) {
    for (const pugi::xml_node& relation :
         child(relations, "Relationships").children()) {
      const std::string_view id = relation.attribute("Id").value();
      if (!id.empty() && id == sheet.attribute("r:id").value()) {
        const std::string target = relation.attribute("Target").value();
        sheets.push_back({sheet.attribute("name").value(),
                          target.starts_with('/') ? target.substr(1) : "xl/" + target});
      }
    }
  }
  if (sheets.empty()) {
    throw FormatError(fmt::format("{}: {} names no sheet", zip.file(), kBook));
  }
  return sheets;
}

std::vector<std::string> shared_texts(const ZipArchive& zip) {
  constexpr const char* kEntry = "xl/sharedStrings.xml";
  std::vector<std::string> texts;
  if (zip.has(kEntry)) {
    const pugi::xml_document document = parse(zip, kEntry);
    for (const pugi::xml_node& item : child(document, "sst").children()) {
      if (is(item, "si")) {
        texts.push_back(text_of(item));
      }
    }
  }
  return texts;
}

// "C7" is in the third column; the next one where a cell states no place.
std::size_t column_of(std::string_view place, std::size_t next) {
  std::size_t column = 0;
  for (const char c : place) {
    if (c < 'A' || c > 'Z') {
      break;
    }
    column = 26 * column + static_cast<std::size_t>(c - 'A') + 1;
    if (column > kColumnsMax) {
      return kColumnsMax;
    }
  }
  return column == 0 ? next : column - 1;
}

std::string cell_text(const pugi::xml_node& cell,
                      const std::vector<std::string>& shared) {
  const std::string_view type = cell.attribute("t").value();
  if (type == "inlineStr") {
    return text_of(child(cell, "is"));
  }
  const std::string value = child(cell, "v").text().get();
  if (type != "s") {
    return value;
  }
  std::size_t index = 0;
  const auto [stop, error] =
      std::from_chars(value.data(), value.data() + value.size(), index);
  return error == std::errc() && index < shared.size() ? shared[index] : std::string();
}

// A row as a line: cells between tabs, quoted where they hold a quote or a tab.
TextLine line_of(const pugi::xml_node& row, std::size_t number,
                 const std::vector<std::string>& shared) {
  TextLine line{number, ""};
  std::size_t next = 0;
  for (const pugi::xml_node& cell : row.children()) {
    if (!is(cell, "c")) {
      continue;
    }
    const std::size_t column = column_of(cell.attribute("r").value(), next);
    for (; next < column; ++next) {
      line.text += '\t';
    }
    std::string text = cell_text(cell, shared);
    std::replace_if(
        text.begin(), text.end(),
        [](char c) {
          return c == '\t' || c == '\n' || c == '\r' || c == '"';
        },
        ' ');
    line.text += text;
  }
  return line;
}

// Rows end where the longest does: a table's cells are as many in each of its lines.
void pad(std::vector<TextLine>& lines) {
  const auto tabs = [](const TextLine& line) {
    return std::count(line.text.begin(), line.text.end(), '\t');
  };
  std::ptrdiff_t most = 0;
  for (const TextLine& line : lines) {
    most = std::max(most, tabs(line));
  }
  for (TextLine& line : lines) {
    line.text.append(static_cast<std::size_t>(most - tabs(line)), '\t');
  }
}

std::vector<TextLine> lines_of(const ZipArchive& zip, const Sheet& sheet,
                               const std::vector<std::string>& shared) {
  const pugi::xml_document document = parse(zip, sheet.entry);
  std::vector<TextLine> lines;
  std::size_t number = 0;
  for (const pugi::xml_node& row :
       child(child(document, "worksheet"), "sheetData").children()) {
    if (is(row, "row")) {
      number = static_cast<std::size_t>(row.attribute("r").as_ullong(number + 1));
      TextLine line = line_of(row, number, shared);
      if (line.text.find_first_not_of("\t ") != std::string::npos) {
        lines.push_back(std::move(line));
      }
    }
  }
  pad(lines);
  return lines;
}

}  // namespace

bool is_workbook(const std::filesystem::path& file, std::string_view head) {
  if (!is_zip(head)) {
    return false;
  }
  if (file.extension() == ".xlsx") {
    return true;  // its name says so, be it broken
  }
  try {
    return open_archive(file).has(kBook);
  } catch (const Error&) {
    return false;
  }
}

InstrumentFile list_workbook(const std::filesystem::path& file) {
  const ZipArchive& zip = open_archive(file);
  const auto shared = shared_texts(zip);
  InstrumentFile result;
  std::vector<InstrumentCurve> without_units;  // numbers without units: who asks tells
  std::string without;
  for (const Sheet& sheet : sheets_of(zip)) {
    const std::vector<TextLine> lines = lines_of(zip, sheet, shared);
    for (InstrumentCurve& curve : tables_in(lines)) {
      if (curve.line == 0) {
        without += fmt::format("{}\"{}\"", without.empty() ? "" : ", ", sheet.name);
        curve.kind = sheet.name;
        curve.number = static_cast<int>(without_units.size()) + 1;
        without_units.push_back(std::move(curve));
        continue;
      }
      curve.kind = sheet.name;
      curve.number = static_cast<int>(result.curve.size()) + 1;
      result.curve.push_back(std::move(curve));
    }
  }
  if (result.curve.empty()) {
    result.curve = std::move(without_units);
  } else if (!without.empty()) {
    result.left_out = "sheets without a length and a force: " + without;
  }
  return result;
}

MeasurementFile read_workbook(const std::filesystem::path& file,
                              const InstrumentCurve& curve,
                              const InstrumentRequest& request) {
  const ZipArchive& zip = open_archive(file);
  for (const Sheet& sheet : sheets_of(zip)) {
    if (sheet.name == curve.kind) {
      const auto lines = lines_of(zip, sheet, shared_texts(zip));
      InstrumentCurve inside = curve;
      inside.end = std::min(inside.end, lines.size());
      inside.begin = std::min(inside.begin, inside.end);
      return read_lines(fmt::format("{}, sheet {}", zip.file(), sheet.name), lines,
                        inside, request);
    }
  }
  throw FormatError(fmt::format("{}: has no sheet \"{}\"", zip.file(), curve.kind));
}

}  // namespace palpate
