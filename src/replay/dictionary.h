#pragma once

#include <string>
#include <vector>

namespace mrhi {

/// What a column of a table holds.
struct Column {
  std::string name, unit, meaning;
};

/// A table that replay writes.
struct Table {
  std::string file, rows;  ///< name, and what has a row
  std::vector<Column> columns;

  /// Names with commas between.
  std::string header() const;
};

/// All tables, in the order of schema.json.
const std::vector<Table>& tables();
/// Throws std::out_of_range for a name that is none of these.
const Table& table_of(const std::string& file);

/// schema.json: the tables' columns with unit and meaning.
std::string schema_json();

}  // namespace mrhi
